#include "dof/arithmetic.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "dof/fixed_rows.h"
#include "dof/fixed_two_pass.h"
#include "dof/two_pass.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

constexpr std::array kArithmetics{Arithmetic::floats, Arithmetic::fixed, Arithmetic::fixed_8};

constexpr double kUnit = SOFTFOCUS_FIXED_ONE_PIXEL;
constexpr float kLargestRadiusPx = SOFTFOCUS_FIXED_LARGEST_REACH + 1;
constexpr float kLeastLeak = 1.0f / 16.0f;

std::uint32_t rounded(double value) { return static_cast<std::uint32_t>(value + 0.5); }

void filter_bytes(const DofInput& input, Image& result, ThreadPool& pool) {
  const Image& scene = input.scene;
  const BytePicture picture = byte_picture(scene);
  const FixedTable table = fixed_table(half_table(fixed_lens(input.settings)));
  Image filtered = make_image(Format::rgba8, scene.width, scene.height);
  fixed_two_pass(picture.colours, picture.depths, table, filtered, pool);
  for (int y = 0; y < scene.height; ++y) {
    const auto from = row<std::uint8_t>(filtered, y);
    const auto to = row<std::uint16_t>(result, y);
    const auto drawn = row<std::uint16_t>(scene, y);
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] = i % 4 == 3 ? drawn[i]
                         : float_to_half(unorm8_to_linear(from[i]), HalfRounding::nearest_even);
    }
  }
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
  if (!(settings.max_coc_px <= kLargestRadiusPx)) {
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

BytePicture byte_picture(const Image& picture) {
  BytePicture bytes{make_image(Format::rgba8, picture.width, picture.height), {}};
  bytes.depths.reserve(static_cast<std::size_t>(picture.width) *
                       static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y);
    const auto to = row<std::uint8_t>(bytes.colours, y);
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (i % 4 == 3) {
        to[i] = 255;
        bytes.depths.push_back(from[i]);
      } else {
        to[i] = linear_to_unorm8(half_to_float(from[i]), UnormRounding::half_up);
      }
    }
  }
  return bytes;
}

void two_pass_in(Arithmetic arithmetic, const DofInput& input, Image& result, ThreadPool& pool) {
  switch (arithmetic) {
    case Arithmetic::floats: two_pass(input, result, pool); return;
    case Arithmetic::fixed:
      fixed_two_pass_rows(input.scene, SOFTFOCUS_FIXED_DEPTH_IN_ALPHA, nullptr,
                          half_table(fixed_lens(input.settings)), result, pool);
      return;
    case Arithmetic::fixed_8: filter_bytes(input, result, pool); return;
  }
}

}  // namespace softfocus
