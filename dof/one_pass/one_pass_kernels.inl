// The one-pass filter over a tile, vectors at a time.

namespace {

#include "dof/repeating_texels.inl"
#include "dof/weights.inl"

/// Extends the windows of a row from `step` places to twice that many.
template <bool largest>
SOFTFOCUS_INLINE void double_windows(float* row, int count, int step) {
  for (int x = 0; x < count; x += kLanes) {
    const Floats a = load(row + x), b = load(row + x + step);
    store(row + x, largest ? larger(a, b) : smaller(a, b));
  }
}

/// Adds the tap at a place.
template <bool leaking>
SOFTFOCUS_INLINE void add_tap(const TilePlanes& planes, std::ptrdiff_t at, float distance_px,
                              Floats receiver_leakage, Sums& sums) {
  const auto length = static_cast<std::ptrdiff_t>(planes.length);
  const float least = (leaking ? planes.least_all : planes.least)[at];
  if (least - distance_px >= 1.0f) {
    add_whole(sums, planes.whole + at, length);
  } else if (planes.most[at] > distance_px) {
    add_part<leaking>(sums, load(planes.part + at), load(planes.whole + at),
                      planes.part + at + length, length, splat(distance_px), receiver_leakage);
  }
}

/// Two receivers at a time, one below the other, so that additions need not wait.
template <bool leaking>
void gather_rings(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                  const Floats (&leakages)[2], Sums (&sums)[2]) {
  Sums upper = sums[0], lower = sums[1];
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t tap = at + taps[i].offset;
    add_tap<leaking>(planes, tap, taps[i].distance_px, leakages[0], upper);
    add_tap<leaking>(planes, tap + planes.stride, taps[i].distance_px, leakages[1], lower);
  }
  sums[0] = upper;
  sums[1] = lower;
}

template <HalfRounding rounding>
void store_filtered(const Sums& sums, const std::uint16_t* from, std::uint16_t* to, int x,
                    int width) {
  const HalfColour colour = resolve<rounding>(sums);
  const HalfTexels texels{colour.r, colour.g, colour.b,
                          stored_depth(load_repeating(from, x, width).a)};
  if (x + kLanes <= width) return store_half_texels(to + 4 * x, texels);
  std::uint16_t last[4 * kLanes];
  store_half_texels(last, texels);
  std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
}

template <HalfRounding rounding>
void filter_rows(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                 float leak, const TileRows& rows) {
  for (int x = rows.x_begin; x < rows.x_end; x += kLanes, at += kLanes) {
    Sums sums[2];
    Floats leakages[2];
    Mask leaks = splat(0);
    for (int i = 0; i < 2; ++i) {
      const std::ptrdiff_t centre = at + i * planes.stride;
      sums[i] = load_sums(planes.whole + centre, static_cast<std::ptrdiff_t>(planes.length));
      leakages[i] = leakage(absolute(load(planes.part + centre)), leak);
      leaks = leaks | (leakages[i] < 1.0f);
    }
    if (any(leaks)) {
      gather_rings<true>(planes, at, taps, count, leakages, sums);
    } else {
      gather_rings<false>(planes, at, taps, count, leakages, sums);
    }
    for (int i = 0; i < 2; ++i) {
      if (rows.to[i] != nullptr) {
        store_filtered<rounding>(sums[i], rows.from[i], rows.to[i], x, rows.width);
      }
    }
  }
}

}  // namespace

/// Fills a row of the planes with pixels x to x + count - 1, a multiple of the lanes. Its
/// windows are not yet right near its end, past which kLanes places are read.
void fill_tile_row(const TilePlanes& planes, const DofSettings& settings, const std::uint16_t* row,
                   int width, int x, int count, std::ptrdiff_t at) {
  const auto length = static_cast<std::ptrdiff_t>(planes.length);
  for (int i = 0; i < count; i += kLanes) {
    const HalfTexels texels = load_repeating(row, x + i, width);
    const Floats radius = signed_radius(settings, half_to_float(texels.a));
    const Floats light = intensity(absolute(radius));
    const Floats r = half_to_float(texels.r), g = half_to_float(texels.g),
                 b = half_to_float(texels.b);
    float* part = planes.part + at + i;
    store(part, radius);
    store(part + length, r);
    store(part + 2 * length, g);
    store(part + 3 * length, b);
    float* whole = planes.whole + at + i;
    store(whole, light);
    store(whole + length, r * light);
    store(whole + 2 * length, g * light);
    store(whole + 3 * length, b * light);
    store(planes.least + at + i, absolute(radius));
    store(planes.least_all + at + i, select(as_ints(radius) < 0, splat(0.0f), radius));
    store(planes.most + at + i, absolute(radius));
  }
  for (int step = 1; step < kLanes; step *= 2) {
    double_windows<false>(planes.least + at, count, step);
    double_windows<false>(planes.least_all + at, count, step);
    double_windows<true>(planes.most + at, count, step);
  }
}

/// Filters two rows, of which the upper begins at `at` of the planes.
void filter_tile_rows(const TilePlanes& planes, std::ptrdiff_t at, const TileTap* taps, int count,
                      const DofSettings& settings, HalfRounding rounding, const TileRows& rows) {
  if (rounding == HalfRounding::nearest_even) {
    filter_rows<HalfRounding::nearest_even>(planes, at, taps, count, settings.leak, rows);
  } else {
    filter_rows<HalfRounding::toward_zero>(planes, at, taps, count, settings.leak, rows);
  }
}
