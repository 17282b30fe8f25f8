// sample() and level_of_detail() for vectors of pixels, to the bit. Kernels that sample include
// this, after raster/images/decoded_texture.h. sample_lanes.cpp has what reads the texels.

struct RgbaLanes {
  Floats r, g, b, a;
};

inline constexpr int kMostSampled = 8;  // vectors at once

/// The larger squared length of two differences, in texels.
SOFTFOCUS_INLINE Floats largest_square(const DecodedTexture& texture, Floats du_dx, Floats dv_dx,
                                       Floats du_dy, Floats dv_dy) {
  const float width = texture.u.sizes[0], height = texture.v.sizes[0];
  const Floats s_x = du_dx * width;
  const Floats t_x = dv_dx * height;
  const Floats s_y = du_dy * width;
  const Floats t_y = dv_dy * height;
  return larger(s_x * s_x + t_x * t_x, s_y * s_y + t_y * t_y);
}

SOFTFOCUS_INLINE Floats log2_linear(Floats x) {
  // Shifts instead of masks, which would have to be loaded.
  const Bits bits = as_bits(x) << 1;
  const Floats mantissa = as_floats(bits << 8 >> 9 | as_bits(splat(1.0f)));
  return (to_floats(as_ints(bits >> 24)) - 128.0f) + mantissa;
}

SOFTFOCUS_INLINE Floats log2_of_root_by_bits(Floats x) {
  return (to_floats(as_ints(as_bits(x * x))) - 0x1.FCp+29f) * 0x1p-25f;
}

/// level_of_detail() of the standard unit and llvmpipe.
SOFTFOCUS_INLINE Floats level_of_detail_lanes(const DecodedTexture& texture, Floats du_dx,
                                              Floats dv_dx, Floats du_dy, Floats dv_dy) {
  return 0.5f * log2_linear(largest_square(texture, du_dx, dv_dx, du_dy, dv_dy));
}

/// level_of_detail() itself, lane by lane.
[[gnu::noinline]] inline void level_of_detail_by_lane(const DecodedTexture& texture,
                                                      const Profile& profile, Floats du_dx,
                                                      Floats dv_dx, Floats du_dy, Floats dv_dy,
                                                      Floats& lod) {
  for (int i = 0; i < kLanes; ++i) {
    lod[i] = level_of_detail(*texture.source, {du_dx[i], dv_dx[i]}, {du_dy[i], dv_dy[i]}, profile);
  }
}

/// level_of_detail() of any profile.
SOFTFOCUS_INLINE Floats level_of_detail_lanes(const DecodedTexture& texture, const Profile& profile,
                                              Floats du_dx, Floats dv_dx, Floats du_dy,
                                              Floats dv_dy) {
  if (profile.texture_unit == TextureUnit::swiftshader) {
    return log2_of_root_by_bits(largest_square(texture, du_dx, dv_dx, du_dy, dv_dy));
  }
  if (profile.texture_unit != TextureUnit::softpipe) {
    return level_of_detail_lanes(texture, du_dx, dv_dx, du_dy, dv_dy);
  }
  Floats lod;
  level_of_detail_by_lane(texture, profile, du_dx, dv_dx, du_dy, dv_dy, lod);
  return lod;
}

/// largest_square() of quads of 2x2 pixels at these places, in each quad's first lane; the others
/// mean nothing. All differences lie in one vector, as they are the same for a quad's pixels.
SOFTFOCUS_INLINE Floats largest_square_of_quads(const DecodedTexture& texture, Floats u, Floats v) {
  std::array<const float*, kLanes / 4> sizes;
  sizes.fill(texture.quad_sizes.data());
  // To the right and down, first of u, then of v.
  const Floats steps = fours_of<1, 2, 5, 6>(u, v) - fours_of<0, 0, 4, 4>(u, v);
  const Floats texels = steps * load_fours(sizes.data(), 0);
  const Floats squares = texels * texels;
  const Floats sums = squares + fours_of<2, 3, 0, 1>(squares, squares);
  return larger(sums, spread<1>(sums));
}

/// level_of_detail_lanes() of quads of 2x2 pixels at these places: by the differences along the
/// upper row and the left column.
SOFTFOCUS_INLINE Floats level_of_detail_of_quads(const DecodedTexture& texture,
                                                 const Profile& profile, Floats u, Floats v) {
  if (profile.texture_unit == TextureUnit::softpipe) {
    return level_of_detail_lanes(texture, profile, spread<1>(u) - spread<0>(u),
                                 spread<1>(v) - spread<0>(v), spread<2>(u) - spread<0>(u),
                                 spread<2>(v) - spread<0>(v));
  }
  const Floats square = spread<0>(largest_square_of_quads(texture, u, v));
  return profile.texture_unit == TextureUnit::swiftshader ? log2_of_root_by_bits(square)
                                                          : 0.5f * log2_linear(square);
}

/// sample() of `count` vectors, kMostSampled at most.
SOFTFOCUS_INLINE void sample_lanes(const DecodedTexture& texture, const Sampler& sampler,
                                   const Profile& profile, const SamplePoints& points, int count,
                                   RgbaLanes* colours) {
  sample_vectors(Isa::SOFTFOCUS_ISA, texture, sampler, profile, points, count, colours);
}
