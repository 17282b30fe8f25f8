#include "raster/shaders/shader_batches.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace softfocus {
namespace {

/// Lanes that run together: as many as keep registers in a core's second cache.
int lanes_for(const ShaderProgram& program) {
  constexpr std::size_t kBytes = std::size_t{96} << 10;
  int lanes = 256;
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
      isa_(isa),
      lane_program_(
          lane_program(program, settings.lanes != 0 ? settings.lanes : lanes_for(program), isa)),
      textures_(settings.textures.begin(), settings.textures.end()) {
  decode_textures();
}

/// For what filters texels, which reads them as floats.
void ShaderBatches::decode_textures() {
  const bool filters = std::any_of(
      program_.samples.begin(), program_.samples.end(), [](const ShaderSampleRegisters& of) {
        const SampleKind kind = of.sample.kind;
        return kind == SampleKind::implicit || kind == SampleKind::level ||
               kind == SampleKind::gradient;
      });
  if (!filters) return;
  decoded_.reserve(textures_.size());
  for (ShaderTexture& of : textures_) {
    if (of.texture == nullptr || of.decoded != nullptr) continue;
    const auto same =
        std::find_if(decoded_.begin(), decoded_.end(),
                     [&](const DecodedTexture& made) { return made.source == of.texture; });
    if (same != decoded_.end()) {
      of.decoded = &*same;
    } else {
      decoded_.push_back(decode_texture(*of.texture, profile_));
      of.decoded = &decoded_.back();
    }
  }
}

void ShaderBatches::begin(BatchMemory& memory) const {
  memory = make_row_memory<float>(lane_program_.bytes / sizeof(float));
  std::memset(memory.get(), 0, lane_program_.bytes);
  for (const ShaderProgram::Constant& constant : program_.constants) {
    for (int i = 0; i < lane_program_.unit_lanes; ++i) {
      std::memcpy(place(memory, {constant.number, false, true}) + 4 * i, &constant.bits, 4);
    }
  }
}

void ShaderBatches::run_steps(BatchMemory& memory) const {
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
