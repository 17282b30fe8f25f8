// Between rows of RGBA16F and rows of planes.

namespace {

#include "dof/repeating_texels.inl"
#include "dof/weights.inl"

SOFTFOCUS_INLINE Floats finite_colour(Bits half) {
  const Floats value = clamp_to_half(half_to_float(half));
  return select(value == value, value, splat(0.0f));
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void merge_rows(const std::uint16_t* scene, const float* r, const float* g,
                                 const float* b, int width, std::uint16_t* to) {
  for (int x = 0; x < width; x += kLanes) {
    const HalfTexels texels{float_to_half<rounding>(clamp_to_half(load(r + x))),
                            float_to_half<rounding>(clamp_to_half(load(g + x))),
                            float_to_half<rounding>(clamp_to_half(load(b + x))),
                            stored_depth(load_repeating(scene, x, width).a)};
    if (x + kLanes <= width) {
      store_half_texels(to + 4 * x, texels);
    } else {
      std::uint16_t last[4 * kLanes];
      store_half_texels(last, texels);
      std::memcpy(to + 4 * x, last, 4 * sizeof *last * static_cast<std::size_t>(width - x));
    }
  }
}

}  // namespace

void split_row(const DofSettings& settings, const std::uint16_t* from, int width, int padded,
               float* to, std::ptrdiff_t plane) {
  for (int x = 0; x < padded; x += kLanes) {
    const HalfTexels texels = load_repeating(from, x, width);
    store(to + x, finite_colour(texels.r));
    store(to + plane + x, finite_colour(texels.g));
    store(to + 2 * plane + x, finite_colour(texels.b));
    const Floats depth_m = half_to_float(texels.a);
    const Floats radius =
        settings.coc.radius_at_infinity_px * (depth_m - settings.coc.focus_m) / depth_m;
    const Floats magnitude = smaller(absolute(radius), splat(settings.max_coc_px));
    store(to + 3 * plane + x, select(radius < 0.0f, -magnitude, magnitude));
  }
}

void merge_row(const std::uint16_t* scene, const float* r, const float* g, const float* b,
               int width, HalfRounding rounding, std::uint16_t* to) {
  if (rounding == HalfRounding::nearest_even) {
    merge_rows<HalfRounding::nearest_even>(scene, r, g, b, width, to);
  } else {
    merge_rows<HalfRounding::toward_zero>(scene, r, g, b, width, to);
  }
}
