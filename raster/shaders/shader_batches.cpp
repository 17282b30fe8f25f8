#include "raster/shaders/shader_batches.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>

#include "raster/images/sliced_texture.h"

namespace softfocus {
namespace {

/// Lanes that run together: as many as keep registers in a core's second cache, and as a row has.
int lanes_for(const ShaderProgram& program, const BatchSettings& settings) {
  if (settings.lanes != 0) return settings.lanes;
  constexpr std::size_t kBytes = std::size_t{96} << 10;
  int lanes = 256;
  while (lanes > 32 && settings.row_lanes > 0 && lanes / 2 >= settings.row_lanes) lanes /= 2;
  while (lanes > 32 &&
         program.varying_count * std::size_t{4} * static_cast<unsigned>(lanes) > kBytes) {
    lanes /= 2;
  }
  return lanes;
}

}  // namespace

ShaderBatches::ShaderBatches(const ShaderProgram& program, const BatchSettings& settings, Isa isa)
    : program_(program),
      profile_(settings.profile),
      budget_(settings.budget),
      y_is_up_(settings.y_is_up),
      uniforms_(settings.uniforms.begin(), settings.uniforms.end()),
      isa_(isa),
      lane_program_(lane_program(program, lanes_for(program, settings), isa)),
      textures_(settings.textures.begin(), settings.textures.end()) {
  check_shapes();
  decode_textures();
}

/// Throws ShaderError for a texture that is not of the shape that the program reads.
void ShaderBatches::check_shapes() const {
  for (const ShaderSampleRegisters& of : program_.samples) {
    if (of.texture.varies) continue;
    for (const ShaderProgram::Constant& constant : program_.constants) {
      if (constant.number != of.texture.number || constant.bits >= textures_.size()) continue;
      const Texture* texture = textures_[constant.bits].texture;
      if (texture == nullptr || texture->shape == of.sample.shape) continue;
      throw ShaderError("texture " + std::to_string(constant.bits) + " is one of a " +
                        std::string{sampler_name(texture->shape)} + ", and the shader reads a " +
                        std::string{sampler_name(of.sample.shape)});
    }
  }
}

/// For what filters or gathers texels, or fetches others than flat textures' halves: it reads them
/// as floats.
void ShaderBatches::decode_textures() {
  bool filters = false, fetches = false;
  for (const ShaderSampleRegisters& of : program_.samples) {
    const SampleKind kind = of.sample.kind;
    filters = filters || kind == SampleKind::implicit || kind == SampleKind::level ||
              kind == SampleKind::gradient || kind == SampleKind::gather;
    fetches = fetches || kind == SampleKind::fetch;
  }
  decoded_.reserve(textures_.size());
  for (ShaderTexture& of : textures_) {
    if (of.texture == nullptr || of.decoded != nullptr) continue;
    const bool is_half =
        of.texture->levels[0].format == Format::rgba16f && of.texture->shape == TextureShape::flat;
    if (!filters && (!fetches || is_half)) continue;
    const auto same =
        std::find_if(decoded_.begin(), decoded_.end(),
                     [&](const DecodedTexture& made) { return made.source == of.texture; });
    if (same != decoded_.end()) {
      of.decoded = &*same;
    } else {
      decoded_.push_back(decode_texture(*of.texture, profile_, isa_));
      of.decoded = &decoded_.back();
    }
  }
}

void ShaderBatches::begin(BatchMemory& memory) const {
  memory = make_row_memory<float>(lane_program_.bytes / sizeof(float));
  std::memset(memory.get(), 0, lane_program_.bytes);
  for (const ShaderProgram::Constant& constant : program_.constants) {
    set(memory, {constant.number, false, true}, constant.bits);
  }
}

void ShaderBatches::set(const BatchMemory& memory, const ShaderRegister& of,
                        std::uint32_t bits) const {
  for (int i = 0; i < lane_program_.unit_lanes; ++i) {
    std::memcpy(place(memory, of) + 4 * i, &bits, 4);
  }
}

void ShaderBatches::run_steps(BatchMemory& memory) const {
  for (const ShaderProgram::Input& of : program_.inputs) {
    if (of.input.uniform < 0) continue;
    assert(static_cast<std::size_t>(of.input.uniform) < uniforms_.size());
    set(memory, of.to, uniforms_[static_cast<std::size_t>(of.input.uniform)]);
  }
  if (program_.killed.is_there) {
    std::memset(place(memory, program_.killed), 0, lane_program_.register_bytes);
  }
  LaneFrame frame{.memory = reinterpret_cast<std::byte*>(memory.get()),
                  .textures = textures_,
                  .samples = lane_program_.samples,
                  .tables = lane_program_.tables,
                  .profile = &profile_,
                  .budget = budget_,
                  .y_is_up = y_is_up_};
  std::size_t step = 0;
  if (run_lanes(lane_program_, frame, isa_, step)) return;
  throw ShaderError(place_of(program_.files, program_.steps[step].line) +
                    "a loop takes more turns than the budget of " + std::to_string(budget_));
}

}  // namespace softfocus
