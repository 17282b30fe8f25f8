#include "raster/shaders/shader.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <mutex>
#include <utility>

#include "raster/shaders/simplify_tree.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

/// Lanes that run together: as many as keep registers in a core's second cache, and as a row has
/// pixels.
int lanes_for(const ShaderProgram& program, int width) {
  constexpr std::size_t kBytes = std::size_t{96} << 10;
  int lanes = 256;
  while (lanes > 32 && lanes / 2 >= width * (program.has_derivatives ? 2 : 1)) lanes /= 2;
  while (lanes > 32 &&
         program.varying_count * std::size_t{4} * static_cast<unsigned>(lanes) > kBytes) {
    lanes /= 2;
  }
  return lanes;
}

/// Pixels of a batch: a run of a row, or with differences two rows of half as many.
struct Batch {
  int x = 0, y = 0, lanes = 0;
  bool quads = false;

  int column(int lane) const { return x + (quads ? lane / 4 * 2 + (lane & 1) : lane); }
  int row(int lane) const { return y + (quads ? lane >> 1 & 1 : 0); }
};

struct PassFrame {
  RowMemory<float> memory{};
};

class Run {
 public:
  Run(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool)
      : program_(program), pass_(pass), pool_(pool) {
    for (const ImageView& target : pass.targets) {
      if (target.texels == nullptr) continue;
      width_ = target.width;
      height_ = target.height;
    }
    decode_textures();
    lanes_ = pass.lanes != 0 ? pass.lanes : lanes_for(program, width_);
    lane_program_ = lane_program(program, lanes_, pool.isa());
    for (const auto& output : program.outputs) {
      if (output.output.builtin >= 0) continue;
      const auto location = static_cast<std::size_t>(output.output.location);
      const auto component = static_cast<std::size_t>(output.output.component);
      if (location >= outputs_.size() || component >= 4) continue;
      outputs_[location][component] = &output.from;
    }
  }

  void run() {
    const int rows = program_.has_derivatives ? 2 : 1;
    const int columns = lanes_ / rows;
    const int across = (width_ + columns - 1) / columns, down = (height_ + rows - 1) / rows;
    for_each_band_with<PassFrame>(pool_, down, 4, [&](int first, int end, PassFrame& frame) {
      if (!frame.memory) begin(frame);
      for (int j = first; j < end; ++j) {
        for (int i = 0; i < across && !stopped_; ++i) {
          run_batch({i * columns, j * rows, lanes_, rows == 2}, frame);
        }
      }
    });
    if (stopped_) throw ShaderError(why_);
  }

 private:
  static constexpr std::size_t kMostTargets = 8;
  const ShaderProgram& program_;
  const ShaderPass& pass_;
  ThreadPool& pool_;
  LaneProgram lane_program_{};
  int width_ = 0, height_ = 0, lanes_ = 0;
  std::array<std::array<const ShaderRegister*, 4>, kMostTargets> outputs_{};
  std::atomic<bool> stopped_{false};
  std::mutex mutex_{};
  std::string why_{};

  std::vector<DecodedTexture> decoded_{};
  std::vector<ShaderTexture> textures_{};

  /// For what filters texels, or fetches others than halves: it reads them as floats.
  void decode_textures() {
    textures_.assign(pass_.textures.begin(), pass_.textures.end());
    bool filters = false, fetches = false;
    for (const ShaderSampleRegisters& of : program_.samples) {
      const SampleKind kind = of.sample.kind;
      filters = filters || kind == SampleKind::implicit || kind == SampleKind::level ||
                kind == SampleKind::gradient;
      fetches = fetches || kind == SampleKind::fetch;
    }
    decoded_.reserve(textures_.size());
    for (ShaderTexture& of : textures_) {
      if (of.texture == nullptr || of.decoded != nullptr) continue;
      const bool is_half = of.texture->levels[0].format == Format::rgba16f;
      if (!filters && (!fetches || is_half)) continue;
      const auto same =
          std::find_if(decoded_.begin(), decoded_.end(),
                       [&](const DecodedTexture& made) { return made.source == of.texture; });
      if (same != decoded_.end()) {
        of.decoded = &*same;
      } else {
        decoded_.push_back(decode_texture(*of.texture, pass_.profile));
        of.decoded = &decoded_.back();
      }
    }
  }

  std::byte* memory_of(PassFrame& frame) const {
    return reinterpret_cast<std::byte*>(frame.memory.get());
  }
  std::byte* place(PassFrame& frame, const ShaderRegister& of) const {
    return memory_of(frame) +
           (of.varies ? of.number * lane_program_.register_bytes
                      : lane_program_.uniform_at + of.number * lane_program_.uniform_bytes);
  }

  void begin(PassFrame& frame) const {
    frame.memory = make_row_memory<float>(lane_program_.bytes / sizeof(float));
    std::memset(frame.memory.get(), 0, lane_program_.bytes);
    for (const auto& constant : program_.constants) {
      for (int i = 0; i < lane_program_.unit_lanes; ++i) {
        std::memcpy(place(frame, {constant.number, false, true}) + 4 * i, &constant.bits, 4);
      }
    }
  }

  std::uint32_t input(const ShaderInput& of, const Batch& batch, int lane) const {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    const auto x = static_cast<float>(batch.column(lane)) + 0.5f;
    const auto y = static_cast<float>(batch.row(lane)) + 0.5f;
    switch (static_cast<SpirvBuiltin>(of.builtin)) {
      case SpirvBuiltin::frag_coord:
        return bits(of.part == 0 ? x : of.part == 1 ? y : of.part == 2 ? 0.5f : 1.0f);
      case SpirvBuiltin::point_coord: return bits(0.5f);
      case SpirvBuiltin::front_facing: return ~0u;
      default: break;
    }
    if (of.builtin >= 0) return 0;
    for (const PassVarying& varying : pass_.varyings) {
      if (varying.location == of.location && varying.component == of.component) {
        return bits(varying.value);
      }
    }
    // The place in the picture.
    if (of.component == 0) return bits(x / static_cast<float>(width_));
    if (of.component == 1) return bits(y / static_cast<float>(height_));
    return bits(of.component == 3 ? 1.0f : 0.0f);
  }

  void run_batch(const Batch& batch, PassFrame& frame) {
    for (const auto& of : program_.inputs) {
      auto* to = reinterpret_cast<std::uint32_t*>(place(frame, of.to));
      for (int lane = 0; lane < lanes_; ++lane) to[lane] = input(of.input, batch, lane);
    }
    if (program_.killed.is_there) {
      std::memset(place(frame, program_.killed), 0, lane_program_.register_bytes);
    }
    LaneFrame lanes{.memory = memory_of(frame),
                    .textures = textures_,
                    .samples = lane_program_.samples,
                    .tables = lane_program_.tables,
                    .profile = &pass_.profile,
                    .budget = pass_.budget};
    std::size_t step = 0;
    if (!run_lanes(lane_program_, lanes, pool_.isa(), step)) {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
      why_ = place_of(program_.files, program_.steps[step].line) +
             "a loop takes more turns than the budget of " + std::to_string(pass_.budget);
      return;
    }
    for (std::size_t i = 0; i < std::min(pass_.targets.size(), kMostTargets); ++i) {
      if (pass_.targets[i].texels != nullptr) store(i, batch, frame);
    }
  }

  void store(std::size_t target, const Batch& batch, PassFrame& frame) const {
    const ImageView& to = pass_.targets[target];
    constexpr int kMostLanes = 1024;
    alignas(64) std::array<std::array<float, kMostLanes>, 4> values;
    alignas(64) std::array<std::int32_t, kMostLanes> killed;
    const int rows = batch.quads ? 2 : 1, columns = lanes_ / rows;
    for (int row = 0; row < rows && batch.y + row < to.height; ++row) {
      const int count = std::min(columns, to.width - batch.x);
      std::array<const float*, 4> channels{};
      for (std::size_t c = 0; c < 4; ++c) {
        const ShaderRegister* from = outputs_[target][c];
        if (from != nullptr && from->varies && rows == 1) {
          channels[c] = reinterpret_cast<const float*>(place(frame, *from));
          continue;
        }
        for (int i = 0; i < columns; ++i) {
          const int lane = rows == 1 ? i : i / 2 * 4 + row * 2 + (i & 1);
          values[c][static_cast<std::size_t>(i)] =
              from == nullptr
                  ? 0.0f
                  : reinterpret_cast<const float*>(place(frame, *from))[from->varies ? lane : 0];
        }
        channels[c] = values[c].data();
      }
      const std::int32_t* dead = nullptr;
      if (program_.killed.is_there) {
        const auto* all = reinterpret_cast<const std::int32_t*>(place(frame, program_.killed));
        for (int i = 0; i < columns; ++i) {
          killed[static_cast<std::size_t>(i)] = all[rows == 1 ? i : i / 2 * 4 + row * 2 + (i & 1)];
        }
        dead = killed.data();
      }
      store_lanes(pool_.isa(), channels.data(), dead, count, to.format, pass_.profile,
                  to.texels + (batch.y + row) * to.stride_bytes +
                      static_cast<std::ptrdiff_t>(batch.x) *
                          static_cast<std::ptrdiff_t>(bytes_per_texel(to.format)));
    }
  }
};

}  // namespace

UserShader make_shader(std::vector<std::uint32_t> words) {
  UserShader made;
  made.module = std::make_unique<const SpirvModule>(read_spirv(std::move(words)));
  made.uniforms = uniforms_of(*made.module);
  return made;
}

const ShaderUniform* find_uniform(const UserShader& shader, std::string_view name) {
  for (const ShaderUniform& uniform : shader.uniforms.all) {
    if (uniform.name == name) return &uniform;
  }
  return nullptr;
}

std::optional<std::uint32_t> uniform_word(const ShaderUniform& of, double value) {
  if (of.kind == SpirvKind::floating) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  if (of.kind == SpirvKind::boolean) return value != 0.0 ? ~0u : 0u;
  const double least = of.is_signed ? -0x1p31 : 0.0, most = of.is_signed ? 0x1p31 : 0x1p32;
  if (!(value >= least && value < most) || value != std::floor(value)) return {};
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
}

ShaderProgram compile_shader(const UserShader& shader, std::span<const std::uint32_t> words) {
  ShaderTree tree = lower_spirv(*shader.module, words);
  simplify(tree);
  ShaderProgram program = emit_program(tree);
  program.files = shader.module->strings;
  return program;
}

void run_shader(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool) {
  Run{program, pass, pool}.run();
}

}  // namespace softfocus
