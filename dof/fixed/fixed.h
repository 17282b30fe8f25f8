#pragma once
// softfocus_fixed.h for C++: its types in a namespace, and memory as a constant.
//
//   constexpr Settings settings{160, 120, 7, SOFTFOCUS_FIXED_RGB565, SOFTFOCUS_FIXED_DEPTH8};
//   alignas(4) uint8_t memory[memory_bytes(settings)];

#include <stddef.h>

#include "dof/fixed/softfocus_fixed.h"

namespace softfocus::fixed {

using Lens = softfocus_fixed_lens;
using Camera = softfocus_fixed_camera;
using Weights = softfocus_fixed_weights;
using Settings = softfocus_fixed_settings;
using Stream = softfocus_fixed_stream;

/// Bytes of memory that a stream needs. Needs settings within the limits.
constexpr size_t memory_bytes(const Settings& settings) {
  if (settings.colour == SOFTFOCUS_FIXED_RGBA16F) {
    return SOFTFOCUS_FIXED_MEMORY_HALF(settings.width, settings.reach);
  }
  return SOFTFOCUS_FIXED_MEMORY(settings.width, settings.reach,
                                settings.colour == SOFTFOCUS_FIXED_RGBA8 ? 1u : 0u,
                                settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? 1u : 2u);
}

/// Settings::reach for circles up to a radius, Q16.16 pixels: ceil(radius) - 1, or 0.
constexpr uint8_t reach_of(uint32_t largest_radius) {
  return static_cast<uint8_t>(largest_radius > 0 ? (largest_radius - 1) >> 16 : 0);
}

}  // namespace softfocus::fixed
