#include "dof/fixed_pictures/arithmetic.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "dof/fixed_pictures/fixed_two_pass.h"
#include "dof/two_pass/two_pass.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

constexpr std::array kArithmetics{Arithmetic::floats, Arithmetic::fixed, Arithmetic::fixed_8};

constexpr double kUnit = SOFTFOCUS_FIXED_ONE_PIXEL;
constexpr float kLeastLeak = 1.0f / 16.0f;

std::uint32_t rounded(double value) { return static_cast<std::uint32_t>(value + 0.5); }

// The byte of each half, colours cut to 0..1.
std::vector<std::uint8_t> bytes_of_halves(ThreadPool& pool) {
  std::vector<std::uint8_t> bytes(65536);
  pool.for_each(256, [&](int upper) {
    for (std::uint32_t half = 256u * static_cast<std::uint32_t>(upper), end = half + 256;
         half < end; ++half) {
      bytes[half] =
          linear_to_unorm8(half_to_float(static_cast<std::uint16_t>(half)), UnormRounding::half_up);
    }
  });
  return bytes;
}

std::array<std::uint16_t, 256> halves_of_bytes() {
  std::array<std::uint16_t, 256> halves{};
  for (std::size_t byte = 0; byte < halves.size(); ++byte) {
    halves[byte] = float_to_half(unorm8_to_linear(static_cast<std::uint8_t>(byte)),
                                 HalfRounding::nearest_even);
  }
  return halves;
}

}  // namespace

std::string_view arithmetic_name(Arithmetic arithmetic) {
  switch (arithmetic) {
    case Arithmetic::floats: return "float";
    case Arithmetic::fixed: return "fixed";
    case Arithmetic::fixed_8: return "fixed-8";
  }
  return {};
}

std::span<const Arithmetic> arithmetics() { return kArithmetics; }

const char* fixed_settings_error(const DofSettings& settings) {
  if (!(settings.max_coc_px <= kLargestFixedRadiusPx)) {
    return "circles have a radius of 64 pixels at most; give --max-coc 64 or less";
  }
  if (!(settings.leak == 0.0f || settings.leak >= kLeastLeak)) {
    return "the leak factor must be 0, or 1/16 or more";
  }
  if (!(settings.leak < 65535.0f)) return "the leak factor must be below 65535";
  if (!(settings.coc.focus_m < 4294.0f)) return "the focus must lie nearer than 4294 m";
  if (!(settings.coc.radius_at_infinity_px < 65535.0f)) {
    return "the horizon's circle must be below 65535 pixels; give a smaller --coc-scale";
  }
  return nullptr;
}

fixed::Lens fixed_lens(const DofSettings& settings) {
  assert(fixed_settings_error(settings) == nullptr);
  return {rounded(settings.coc.radius_at_infinity_px * kUnit),
          std::max(rounded(settings.coc.focus_m * 1e6), 1u), rounded(settings.max_coc_px * kUnit),
          rounded(settings.leak * kUnit)};
}

std::vector<fixed::Weights> half_table(const fixed::Lens& lens) {
  std::vector<fixed::Weights> table(65536);
  [[maybe_unused]] const int error = softfocus_fixed_table_half(&lens, table.data());
  assert(error == 0);
  return table;
}

BytePicture byte_picture(const ConstImageView& picture, ThreadPool& pool) {
  const auto width = static_cast<std::size_t>(picture.width);
  BytePicture bytes{make_image(Format::rgba8, picture.width, picture.height),
                    std::vector<std::uint16_t>(width * static_cast<std::size_t>(picture.height))};
  const std::vector<std::uint8_t> of_half = bytes_of_halves(pool);
  pool.for_each(picture.height, [&](int y) {
    const auto from = row<std::uint16_t>(picture, y);
    const auto to = row<std::uint8_t>(bytes.colours, y);
    std::uint16_t* depths = bytes.depths.data() + width * static_cast<std::size_t>(y);
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t i = 4 * x; i < 4 * x + 3; ++i) to[i] = of_half[from[i]];
      to[4 * x + 3] = 255;
      depths[x] = from[4 * x + 3];
    }
  });
  return bytes;
}

void two_pass_bytes(const ConstImageView& scene, const FixedTable& table, const ImageView& result,
                    ThreadPool& pool) {
  const BytePicture picture = byte_picture(scene, pool);
  Image filtered = make_image(Format::rgba8, scene.width, scene.height);
  fixed_two_pass(picture.colours, picture.depths, table, filtered, pool);
  const std::array<std::uint16_t, 256> of_byte = halves_of_bytes();
  pool.for_each(scene.height, [&](int y) {
    const auto from = row<std::uint8_t>(filtered, y);
    const auto drawn = row<std::uint16_t>(scene, y);
    const auto to = row<std::uint16_t>(result, y);
    for (std::size_t alpha = 3; alpha < to.size(); alpha += 4) {
      for (std::size_t i = alpha - 3; i < alpha; ++i) to[i] = of_byte[from[i]];
      to[alpha] = drawn[alpha];
    }
  });
}

void two_pass_in(Arithmetic arithmetic, const DofInput& input, const ImageView& result,
                 ThreadPool& pool) {
  switch (arithmetic) {
    case Arithmetic::floats: two_pass(input, result, pool); return;
    case Arithmetic::fixed:
      fixed_two_pass(input.scene, fixed_table(half_table(fixed_lens(input.settings))), result,
                     pool);
      return;
    case Arithmetic::fixed_8:
      two_pass_bytes(input.scene, fixed_table(half_table(fixed_lens(input.settings))), result,
                     pool);
      return;
  }
}

}  // namespace softfocus
