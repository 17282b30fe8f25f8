#pragma once
// The two-pass filter in other arithmetic than binary32, for pictures as every method takes
// them (docs/fixed-point.md).

#include <cstdint>
#include <span>
#include <vector>

#include "dof/fixed/fixed.h"
#include "dof/fixed_pictures/fixed_two_pass.h"
#include "dof/dof.h"

namespace softfocus {

enum class Arithmetic : std::uint8_t {
  floats,   ///< binary32
  fixed,    ///< integers, on the picture's own halves
  fixed_8,  ///< integers, on bytes: colours cut to 0..1 and rounded to 8 bits
};

/// "float", "fixed", "fixed-8".
std::string_view arithmetic_name(Arithmetic arithmetic);
std::span<const Arithmetic> arithmetics();

/// The largest radius that integers have.
inline constexpr float kLargestFixedRadiusPx = SOFTFOCUS_FIXED_LARGEST_REACH + 1;

/// What settings integers cannot have, as a sentence, or nullptr: circles are at most 64
/// pixels, the leak factor is 0 or 1/16 and more, the focus lies nearer than 4294 m, the
/// horizon's circle is below 65536 pixels.
const char* fixed_settings_error(const DofSettings& settings);

/// The settings in integers, each rounded to nearest. Needs settings without error.
fixed::Lens fixed_lens(const DofSettings& settings);

/// Weights of all halves under a lens.
std::vector<fixed::Weights> half_table(const fixed::Lens& lens);

/// A picture for the filter on bytes: colours in linear light, and depths as halves.
struct BytePicture {
  Image colours;  ///< RGBA8, alpha 255
  std::vector<std::uint16_t> depths;
};
BytePicture byte_picture(const ConstImageView& picture, ThreadPool& pool);

/// The two-pass filter of `input` in that arithmetic. Needs settings without error.
void two_pass_in(Arithmetic arithmetic, const DofInput& input, const ImageView& result, ThreadPool& pool);

/// The same with Arithmetic::fixed_8 and a table from fixed_table(half_table(...)), which is made
/// once a lens.
void two_pass_bytes(const ConstImageView& scene, const FixedTable& table, const ImageView& result, ThreadPool& pool);

}  // namespace softfocus
