#ifndef SOFTFOCUS_ISA
// The kernels, below #else, are compiled once for each vector unit (for_each_isa.inl).

#include "dof/disc_layers/disc_slopes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/numbers/half.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr float kLeastRadius = 1.0f, kOutline = 0.5f, kLeastShift = 1.0f / 64.0f, kMostShift = 0.5f;
constexpr int kBaseline = 4;  // of slopes, in pixels to either side

/// A row's texels, and those above and below it; its radii, and those of rows around it, from
/// kBaseline above to kBaseline below. The picture's first and last rows repeat, and kBaseline
/// radii more at either end.
struct SlopeRows {
  const std::uint16_t* texels[3];
  const float* radii[2 * kBaseline + 1];
  int width;
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/disc_layers/disc_slopes.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Radii along an axis: kBaseline before, one before, at the pixel, one behind, kBaseline behind.
float shift_along(const float (&radii)[5]) {
  const float own = radii[2];
  const float first = (own - radii[0]) / kBaseline, second = (radii[4] - own) / kBaseline;
  const bool is_first = std::fabs(first) < kOutline, is_second = std::fabs(second) < kOutline;
  const float lesser = !(first * second > 0.0f)               ? 0.0f
                       : std::fabs(first) < std::fabs(second) ? first
                                                              : second;
  const float slope = is_first && is_second ? lesser : is_first ? first : is_second ? second : 0.0f;
  const float shift = 0.25f * (own * slope);
  const float beside = shift > 0.0f ? radii[1] : radii[3];
  if (!(std::fabs(shift) >= kLeastShift && std::fabs(beside - own) < kOutline)) return 0.0f;
  return std::clamp(shift, -kMostShift, kMostShift);
}

void centre_row_scalar(const DofInput& input, int y, std::uint16_t* to) {
  const int right = input.scene.width - 1, bottom = input.scene.height - 1;
  const auto at = [&](int x, int row) {
    return split_texel(input, std::clamp(x, 0, right), std::clamp(row, 0, bottom));
  };
  const std::uint16_t* from = row<std::uint16_t>(input.scene, y).data();
  for (int x = 0; x <= right; ++x) {
    std::uint16_t* texel = to + 4 * x;
    std::copy_n(from + 4 * x, 4, texel);
    const float radius = at(x, y).radius_px;
    if (!(std::fabs(radius) > kLeastRadius)) continue;
    const auto shift = [&](int along_x, int along_y) {
      const auto radius_at = [&](int steps) {
        return at(x + steps * along_x, y + steps * along_y).radius_px;
      };
      return shift_along(
          {radius_at(-kBaseline), radius_at(-1), radius, radius_at(1), radius_at(kBaseline)});
    };
    const float shift_x = shift(1, 0), shift_y = shift(0, 1);
    if (shift_x == 0.0f && shift_y == 0.0f) continue;
    const SplitTexel own = at(x, y);
    const SplitTexel across = at(shift_x > 0.0f ? x - 1 : x + 1, y);
    const SplitTexel down = at(x, shift_y > 0.0f ? y - 1 : y + 1);
    const auto channel = [&](float SplitTexel::*c) {
      return float_to_half(own.*c + std::fabs(shift_x) * (across.*c - own.*c) +
                               std::fabs(shift_y) * (down.*c - own.*c),
                           HalfRounding::nearest_even);
    };
    texel[0] = channel(&SplitTexel::r);
    texel[1] = channel(&SplitTexel::g);
    texel[2] = channel(&SplitTexel::b);
  }
}

// Rows `begin` to `end` - 1.
void centre_rows(const DofInput& input, int begin, int end, const ImageView& moved, Isa isa) {
  const ConstImageView& scene = input.scene;
  const auto inside = [&](int y) { return std::clamp(y, 0, scene.height - 1); };
  const auto texels = [&](int y) { return row<std::uint16_t>(scene, inside(y)).data(); };
  constexpr int kRows = 2 * kBaseline + 1;
  const std::size_t room = static_cast<std::size_t>(scene.width) + 3 * kMostLanes;
  static_assert(kBaseline <= kMostLanes);
  std::vector<float> radii(kRows * room);
  const auto radii_of = [&](int y) {
    return radii.data() + static_cast<std::size_t>(inside(y) % kRows) * room + kMostLanes;
  };
  const auto find_radii = [&](int y) {
    float* to = radii_of(y);
    SOFTFOCUS_KERNEL(isa, find_radii)(input.settings, texels(y), scene.width, to);
    std::fill_n(to - kBaseline, kBaseline, to[0]);
    std::fill_n(to + scene.width, kBaseline, to[scene.width - 1]);
  };
  for (int y = begin - kBaseline; y < begin + kBaseline; ++y) find_radii(y);
  for (int y = begin; y < end; ++y) {
    find_radii(y + kBaseline);
    SlopeRows rows{{texels(y - 1), texels(y), texels(y + 1)}, {}, scene.width};
    for (int i = 0; i < kRows; ++i) rows.radii[i] = radii_of(y - kBaseline + i);
    SOFTFOCUS_KERNEL(isa, centre_row)(rows, row<std::uint16_t>(moved, y).data());
  }
}

}  // namespace

CentredDiscs centre_discs(const DofInput& input, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const std::size_t stride =
      bytes_per_texel(Format::rgba16f) * static_cast<std::size_t>(scene.width);
  CentredDiscs centred{
      {},
      make_row_memory<std::byte>(stride * static_cast<std::size_t>(scene.height), &pool.memory())};
  const ImageView moved{Format::rgba16f, scene.width, scene.height,
                        static_cast<std::ptrdiff_t>(stride), centred.memory.get()};
  centred.picture = moved;
  constexpr int kRows = 16;
  pool.for_each((scene.height + kRows - 1) / kRows, [&](int task) {
    const int begin = kRows * task, end = std::min(begin + kRows, scene.height);
    if (pool.isa() != Isa::scalar) return centre_rows(input, begin, end, moved, pool.isa());
    for (int y = begin; y < end; ++y) {
      centre_row_scalar(input, y, row<std::uint16_t>(moved, y).data());
    }
  });
  return centred;
}

}  // namespace softfocus

#else  // kernels

namespace {

#include "dof/picture_lanes.inl"

SOFTFOCUS_INLINE Floats shift_along(Floats long_before, Floats before, Floats own, Floats behind,
                                    Floats long_behind) {
  const Floats first = (own - long_before) / kBaseline, second = (long_behind - own) / kBaseline;
  const Mask is_first = absolute(first) < kOutline, is_second = absolute(second) < kOutline;
  const Floats none = splat(0.0f);
  const Floats lesser = select(first * second > 0.0f,
                               select(absolute(first) < absolute(second), first, second), none);
  const Floats slope =
      select(is_first, select(is_second, lesser, first), select(is_second, second, none));
  const Floats shift = 0.25f * (own * slope);
  const Floats beside = select(shift > 0.0f, before, behind);
  const Mask is_moved = (absolute(shift) >= kLeastShift) & (absolute(beside - own) < kOutline);
  return select(is_moved, larger(smaller(shift, splat(kMostShift)), splat(-kMostShift)), none);
}

using SlopeColours = std::array<Floats, 3>;

SOFTFOCUS_INLINE SlopeColours load_finite(const std::uint16_t* texels, int x, int width) {
  const HalfTexels loaded = load_repeating(texels, x, width);
  return {finite_colour(loaded.r), finite_colour(loaded.g), finite_colour(loaded.b)};
}

// Adds to what lanes see of their own pixels what they see of those at x.
SOFTFOCUS_INLINE void add_beside(const std::uint16_t* texels, int x, int width, Mask lanes,
                                 Floats share, const SlopeColours& own, SlopeColours& sum) {
  if (!any(lanes)) return;
  const SlopeColours beside = load_finite(texels, x, width);
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] = select(lanes, sum[c] + share * (beside[c] - own[c]), sum[c]);
  }
}

SOFTFOCUS_INLINE Bits moved_half(Mask moved, Floats colour, Bits own) {
  return select(moved, float_to_half<HalfRounding::nearest_even>(colour), own);
}

}  // namespace

void find_radii(const DofSettings& settings, const std::uint16_t* texels, int width, float* to) {
  for (int x = 0; x < width; x += kLanes) {
    store(to + x, split_radius(settings, half_to_float(load_repeating(texels, x, width).a)));
  }
}

void centre_row(const SlopeRows& rows, std::uint16_t* to) {
  const int width = rows.width;
  for (int x = 0; x < width; x += kLanes) {
    const float* const* lines = rows.radii;
    const float* radii = lines[kBaseline] + x;
    const Floats radius = load(radii);
    const Floats shift_x = shift_along(load(radii - kBaseline), load(radii - 1), radius,
                                       load(radii + 1), load(radii + kBaseline));
    const Floats shift_y =
        shift_along(load(lines[0] + x), load(lines[kBaseline - 1] + x), radius,
                    load(lines[kBaseline + 1] + x), load(lines[2 * kBaseline] + x));
    const Mask is_moved =
        (absolute(radius) > kLeastRadius) & ~((shift_x == 0.0f) & (shift_y == 0.0f));
    if (!any(is_moved)) {
      std::memcpy(to + 4 * x, rows.texels[1] + 4 * x,
                  4 * sizeof *to * static_cast<std::size_t>(std::min(kLanes, width - x)));
      continue;
    }
    const HalfTexels texels = load_repeating(rows.texels[1], x, width);
    const SlopeColours own{finite_colour(texels.r), finite_colour(texels.g),
                           finite_colour(texels.b)};
    const Floats share_x = absolute(shift_x), share_y = absolute(shift_y);
    SlopeColours sum = own;
    add_beside(rows.texels[1], x - 1, width, is_moved & (shift_x > 0.0f), share_x, own, sum);
    add_beside(rows.texels[1], x + 1, width, is_moved & (shift_x < 0.0f), share_x, own, sum);
    add_beside(rows.texels[0], x, width, is_moved & (shift_y > 0.0f), share_y, own, sum);
    add_beside(rows.texels[2], x, width, is_moved & (shift_y < 0.0f), share_y, own, sum);
    store_within(to, x, width,
                 {moved_half(is_moved, sum[0], texels.r), moved_half(is_moved, sum[1], texels.g),
                  moved_half(is_moved, sum[2], texels.b), texels.a});
  }
}

#endif
