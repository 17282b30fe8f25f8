#pragma once
// The two-pass filter in binary32 or in integers, for pictures as every method takes them
// (docs/fixed-point.md).

#include <cstdint>
#include <span>
#include <vector>

#include "dof/dof.h"
#include "dof/fixed/fixed.h"
#include "dof/fixed_pictures/fixed_two_pass.h"

namespace softfocus {

enum class Arithmetic : std::uint8_t {
  floats,   ///< binary32: two_pass()
  fixed,    ///< integers, on the picture's own halves
  fixed_8,  ///< integers, on bytes: colours cut to 0..1 and rounded to 8 bits
};

/// "float", "fixed", "fixed-8".
std::string_view arithmetic_name(Arithmetic arithmetic);
std::span<const Arithmetic> arithmetics();

/// The largest radius that integers have.
inline constexpr float kLargestFixedRadiusPx = SOFTFOCUS_FIXED_LARGEST_REACH + 1;

/// Why the integer filter cannot have these settings, as a sentence; nullptr if it can. Circles
/// have a radius of at most 64 pixels; the leak factor is 0, or from 1/16 to below 65535; the
/// focus is nearer than 4294 m; the horizon's circle is below 65535 pixels.
const char* fixed_settings_error(const DofSettings& settings);

/// The settings in integers, each rounded to nearest. Needs settings without error.
fixed::Lens fixed_lens(const DofSettings& settings);

/// The weights of all 65536 halves as depths in metres.
std::vector<fixed::Weights> half_table(const fixed::Lens& lens);

/// A picture for the filter on bytes: colours in linear light, and depths as halves.
struct BytePicture {
  Image colours;  ///< RGBA8, alpha 255
  std::vector<std::uint16_t> depths;
};
BytePicture byte_picture(const ConstImageView& picture, ThreadPool& pool);

/// The two-pass filter of `input` in that arithmetic. Needs settings without error.
void two_pass_in(Arithmetic arithmetic, const DofInput& input, const ImageView& result,
                 ThreadPool& pool);

/// Arithmetic::fixed_8 with a table that fixed_table(half_table(...)) made, once a lens.
void two_pass_bytes(const ConstImageView& scene, const FixedTable& table, const ImageView& result,
                    ThreadPool& pool);

}  // namespace softfocus
