// Tables from depth codes to weights. Radii are in Q16.16 pixels here.

#include "dof/fixed/softfocus_fixed.h"
#include "dof/fixed/weights.h"
#include "dof/fixed/wide.h"

namespace softfocus::fixed {
namespace {

using Lens = softfocus_fixed_lens;
using Camera = softfocus_fixed_camera;

bool usable(const Lens& lens) {
  return lens.focus_um > 0 && lens.largest_radius <= kLargestRadius &&
         (lens.leak == 0 || lens.leak >= kLeastLeak);
}

/// `depth` and `focus` are in the same unit, any unit, and below 2^63.
Weights weights_at(const Lens& lens, uint64_t depth, uint64_t focus) {
  const uint64_t away = depth > focus ? depth - focus : focus - depth;
  const uint64_t radius = multiply_divide(lens.radius_at_infinity, away, depth);
  return make_weights(smaller(radius, lens.largest_radius), lens.leak, depth > focus);
}

int make_table(const Lens* lens, uint32_t near_um, uint32_t far_um, uint32_t largest_code,
               Weights* table) {
  if (lens == nullptr || table == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (!usable(*lens)) return SOFTFOCUS_FIXED_BAD_LENS;
  const bool rising = far_um >= near_um;
  const uint32_t range = rising ? far_um - near_um : near_um - far_um;
  for (uint32_t code = 0; code <= largest_code; ++code) {
    const auto step = static_cast<uint32_t>(divide(multiply(range, code), largest_code));
    const uint32_t depth = rising ? near_um + step : near_um - step;
    table[code] = weights_at(*lens, depth, lens->focus_um);
  }
  return 0;
}

// A half is an integer in units of 2^-24 m. Times 10^6 that is the depth in units of 2^-24 um,
// below 2^40 10^6 < 2^60.
constexpr int kHalfBits = 24;
constexpr uint64_t kMicrometres = 1000000;

Weights weights_at_half(const Lens& lens, uint32_t half) {
  const uint32_t magnitude = half & 0x7FFFu;
  const bool negative = (half & 0x8000u) != 0;
  if (magnitude >= kHalfInfinity) {
    return make_weights(lens.largest_radius, lens.leak, half == kHalfInfinity);
  }
  const uint64_t depth = half_magnitude(magnitude) * kMicrometres;
  const uint64_t focus = static_cast<uint64_t>(lens.focus_um) << kHalfBits;
  if (!negative) return weights_at(lens, depth, focus);
  const uint64_t radius = multiply_divide(lens.radius_at_infinity, depth + focus, depth);
  return make_weights(smaller(radius, lens.largest_radius), lens.leak, false);
}

}  // namespace
}  // namespace softfocus::fixed

using namespace softfocus::fixed;

int softfocus_fixed_table8(const Lens* lens, uint32_t near_um, uint32_t far_um, Weights* table) {
  return make_table(lens, near_um, far_um, 0xFF, table);
}

int softfocus_fixed_table16(const Lens* lens, uint32_t near_um, uint32_t far_um, Weights* table) {
  return make_table(lens, near_um, far_um, 0xFFFF, table);
}

int softfocus_fixed_table_half(const Lens* lens, Weights* table) {
  if (lens == nullptr || table == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (!usable(*lens)) return SOFTFOCUS_FIXED_BAD_LENS;
  for (uint32_t half = 0; half <= 0xFFFF; ++half) table[half] = weights_at_half(*lens, half);
  return 0;
}

int softfocus_fixed_radius_at_infinity(const Camera* camera, uint32_t* radius) {
  if (camera == nullptr || radius == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  const uint64_t focal_length = camera->focal_length_um;
  if (focal_length < 1 || focal_length > 1u << 20 || camera->f_number < 1 ||
      camera->f_number >= 1u << 15 || camera->focus_um <= focal_length ||
      camera->film_height_um < 1 || camera->film_height_um > 1u << 17 || camera->height_px < 1 ||
      camera->height_px > SOFTFOCUS_FIXED_LARGEST_SIZE) {
    return SOFTFOCUS_FIXED_BAD_LENS;
  }
  // f^2 height is at most 2^54, the divisor below 2^64. The factor 2^(16 + 8 - 1): 16 bits of the
  // result, 8 bits of N, and the 2 of 2 N.
  const uint64_t divisor = uint64_t{camera->f_number} * camera->film_height_um *
                           (camera->focus_um - camera->focal_length_um);
  const uint64_t at_infinity =
      multiply_divide(focal_length * focal_length * camera->height_px, 1u << (16 + 8 - 1), divisor);
  if (at_infinity > UINT32_MAX) return SOFTFOCUS_FIXED_BAD_LENS;
  *radius = static_cast<uint32_t>(at_infinity);
  return 0;
}
