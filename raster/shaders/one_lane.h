#pragma once
// One lane of a sample: what shader_textures.cpp and sliced_samples.cpp read and write.

#include <bit>
#include <cstring>

#include "raster/shaders/shader_lanes.h"

namespace softfocus {

/// The registers of one lane.
struct Lane {
  const LaneFrame& frame;
  int unit_lanes, lane;  ///< the first a power of two

  std::byte* place(const LaneSample::At& at, int of) const {
    // A division would take longer than all else here.
    const int shift = std::countr_zero(static_cast<unsigned>(unit_lanes));
    const auto vector = static_cast<std::size_t>(of >> shift);
    return frame.memory + at.place + vector * at.next +
           static_cast<std::size_t>(of & (unit_lanes - 1)) * 4;
  }
  std::uint32_t bits(const LaneSample::At& at) const { return bits_of(at, lane); }
  std::uint32_t bits_of(const LaneSample::At& at, int of) const {
    std::uint32_t value = 0;
    if (at.is_there) std::memcpy(&value, place(at, of), sizeof value);
    return value;
  }
  float number(const LaneSample::At& at) const { return std::bit_cast<float>(bits(at)); }
  float number_of(const LaneSample::At& at, int of) const {
    return std::bit_cast<float>(bits_of(at, of));
  }
  std::int32_t whole(const LaneSample::At& at) const { return static_cast<std::int32_t>(bits(at)); }
  void put(const LaneSample::At& at, std::uint32_t value) const {
    if (at.is_there) std::memcpy(place(at, lane), &value, sizeof value);
  }
  void put(const LaneSample::At& at, float value) const {
    put(at, std::bit_cast<std::uint32_t>(value));
  }
};

/// A sample of a texture that is not flat. Needs a texture of the sample's shape.
void sample_sliced_lane(const LaneSample& sample, const Lane& lane, const ShaderTexture& from);

/// One channel of the four texels round a place of an image, or whether they pass.
void gather_texels(const LaneSample& sample, const Lane& lane, const ShaderTexture& from,
                   const Image& image, glm::vec2 at);
/// The same of the four round a direction, on level 0 of a cube.
void gather_cube_texels(const LaneSample& sample, const Lane& lane, const ShaderTexture& from,
                        glm::vec3 direction);

}  // namespace softfocus
