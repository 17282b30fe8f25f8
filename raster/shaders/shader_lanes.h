#pragma once
// The steps of a program as functions over lanes, for one vector unit.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "raster/images/decoded_texture.h"
#include "raster/images/sampler.h"
#include "raster/lanes/isa.h"
#include "raster/pipeline/state.h"
#include "raster/shaders/shader_program.h"

namespace softfocus {

/// A texture as a shader finds it: its levels, and how they are sampled.
struct ShaderTexture {
  const Texture* texture = nullptr;
  Sampler sampler{};
  const DecodedTexture* decoded = nullptr;  ///< of the pass's profile; made there if it is null
  Compare compare = Compare::less_equal;    ///< of what is given with what is sampled
};

struct LaneFrame;
struct LaneStep;
using LaneFunction = void (*)(const LaneStep&, LaneFrame&);

/// A step with the places of its registers in memory.
struct LaneStep {
  LaneFunction run = nullptr;                        ///< null of a step that steers
  std::uint32_t to = 0, a = 0, b = 0, c = 0, d = 0;  ///< bytes into memory
  /// Bytes to the next vector, or 0.
  std::uint16_t a_next = 0, b_next = 0, c_next = 0, d_next = 0;
  std::uint16_t vectors = 0;
  std::uint32_t place = 0, count = 0, stride = 0;
  std::uint8_t op = 0;
};

struct LaneSample {
  ShaderSample sample{};
  struct At {
    std::uint32_t place = 0;
    std::uint16_t next = 0;
    bool is_there = false;
  };
  At texture{}, sampler{}, compared{};
  std::array<At, 4> at{};
  std::array<At, 6> more{};
  std::array<At, 3> offset{};
  std::array<At, 4> to{};
  std::uint32_t vectors = 0;
};

/// Vectors of lanes.
struct LaneRange {
  std::uint32_t first_bytes = 0;  ///< where the first lies in a register
  std::uint32_t count = 0;
};

/// What the steps of one thread work on.
struct LaneFrame {
  std::byte* memory = nullptr;
  std::span<const ShaderTexture> textures{};
  std::span<const LaneSample> samples{};
  std::span<const std::uint32_t> tables{};
  const Profile* profile = nullptr;
  std::uint64_t budget = 0;  ///< turns of loops that are left
  bool y_is_up = false;      ///< dFdy is towards the upper row of a block
  LaneRange range{0, 1};     ///< that steps run over; others have left or wait
};

/// The vectors that a step runs over, of so many: one if it makes what does not vary.
inline LaneRange range_of(std::uint32_t vectors, const LaneFrame& frame) {
  return vectors == 1 ? LaneRange{0, 1} : frame.range;
}

/// The texture that a sample reads, of its first lane; null if there is none of its shape.
const ShaderTexture* texture_of(const LaneSample& sample, const LaneFrame& frame);

/// Any sample, a lane after the other.
void sample_by_lane(const LaneSample& sample, LaneFrame& frame, int unit_lanes);

/// A program for one vector unit and a number of lanes.
struct LaneProgram {
  std::vector<LaneStep> steps{};
  std::vector<LaneSample> samples{};
  std::vector<std::uint32_t> tables{};
  std::size_t bytes = 0;         ///< of memory
  std::uint32_t uniform_at = 0;  ///< where registers that do not vary begin
  int lanes = 0, unit_lanes = 0;
  std::uint32_t register_bytes = 0, uniform_bytes = 0;
};

LaneProgram lane_program(const ShaderProgram& program, int lanes, Isa isa);

/// Runs the steps. False if the budget is spent: `stopped` is the step.
bool run_lanes(const LaneProgram& program, LaneFrame& frame, Isa isa, std::size_t& stopped);

/// Stores `count` lanes of four registers as texels of a row. A texel whose lane is set in `killed`
/// stays as it is; if `killed` is null, none does. `are_bits`: in rgba32f the numbers are whole
/// ones, stored bit by bit.
void store_lanes(Isa isa, const float* const* channels, const std::int32_t* killed, int count,
                 Format format, const Profile& profile, std::byte* to, bool are_bits = false);

}  // namespace softfocus
