// What sliced_texture.cpp computes of places and levels, in lanes, to the bit. Included after
// raster/images/sample_lanes.inl and raster/lanes/vector_math_lanes.inl.

/// The main axis of directions: at most one of both masks is set, and z's is else.
struct MainAxisLanes {
  Mask is_x, is_y;
};

SOFTFOCUS_INLINE MainAxisLanes main_axis(Floats x, Floats y, Floats z) {
  const Floats along_x = absolute(x), along_y = absolute(y), along_z = absolute(z);
  const Mask is_z = ~((along_z < along_x) | (along_z < along_y));
  const Mask is_y = ~is_z & (along_x <= along_y);
  return {~is_z & ~is_y, is_y};
}

SOFTFOCUS_INLINE Floats choose(const MainAxisLanes& axis, Floats x, Floats y, Floats z) {
  return select(axis.is_x, x, select(axis.is_y, y, z));
}

struct CubePlaceLanes {
  Ints face;
  Floats u, v;
};

/// cube_place().
SOFTFOCUS_INLINE CubePlaceLanes cube_place(Floats x, Floats y, Floats z) {
  const MainAxisLanes axis = main_axis(x, y, z);
  const Floats main = choose(axis, x, y, z);
  const Mask is_negative = (as_ints(main) < 0) & (main == main);
  const Floats half = 0.5f / absolute(main);
  // s is -z, x, x on the positive faces, and z, x, -x on the negative ones; t is -y but z, -z of y.
  const Mask is_z = ~(axis.is_x | axis.is_y);
  const Mask minus_s = (axis.is_x & ~is_negative) | (is_z & is_negative);
  const Mask minus_t = ~axis.is_y | is_negative;
  const Floats s = select(axis.is_x, z, x), t = select(axis.is_y, z, y);
  const Floats u = select(minus_s, -s, s) * half + 0.5f;
  const Floats v = select(minus_t, -t, t) * half + 0.5f;
  return {.face = (axis.is_x & 0) + (axis.is_y & 2) + (is_z & 4) + (is_negative & 1),
          .u = select(u > 0.0f, smaller(u, splat(1.0f)), splat(0.0f)),
          .v = select(v > 0.0f, smaller(v, splat(1.0f)), splat(0.0f))};
}

/// nearest_layer() of an array of `count` layers.
template <bool by_llvmpipe>
SOFTFOCUS_INLINE Ints nearest_layer(int count, Floats at) {
  if constexpr (by_llvmpipe) {
    return smaller(larger(round_to_int(at), splat(0)), splat(count - 1));
  } else {
    const Floats last = splat(static_cast<float>(count - 1));
    return truncate(nearest(select(at > 0.0f, smaller(at, last), splat(0.0f))));
  }
}

/// The squared length of a volume's difference, in texels.
SOFTFOCUS_INLINE Floats volume_square(const DecodedTexture& texture, const Vec3Lanes& change) {
  const Image& base = texture.source->levels.front();
  const Floats x = change.x * static_cast<float>(base.width);
  const Floats y = change.y * static_cast<float>(base.height);
  const Floats z = change.z * static_cast<float>(slice_count(*texture.source));
  return (x * x + y * y) + z * z;
}

/// sliced_level_of_detail().
SOFTFOCUS_INLINE Floats sliced_level_of_detail_lanes(const DecodedTexture& texture,
                                                     const Profile& profile, const Vec3Lanes& at,
                                                     const Vec3Lanes& per_x,
                                                     const Vec3Lanes& per_y) {
  switch (texture.source->shape) {
    case TextureShape::volume: {
      const Floats square = larger(volume_square(texture, per_x), volume_square(texture, per_y));
      return profile.texture_unit == TextureUnit::swiftshader ? log2_of_root_by_bits(square)
                                                              : 0.5f * log2_linear(square);
    }
    case TextureShape::cube: {
      const MainAxisLanes axis = main_axis(at.x, at.y, at.z);
      const Floats inverse = 1.0f / choose(axis, at.x, at.y, at.z), half = 0.5f * inverse;
      const Floats s = select(axis.is_x, at.z, at.x), t = select(axis.is_y, at.z, at.y);
      const Floats main_x = choose(axis, per_x.x, per_x.y, per_x.z) * inverse;
      const Floats main_y = choose(axis, per_y.x, per_y.y, per_y.z) * inverse;
      return level_of_detail_lanes(texture, profile,
                                   (select(axis.is_x, per_x.z, per_x.x) - main_x * s) * half,
                                   (select(axis.is_y, per_x.z, per_x.y) - main_x * t) * half,
                                   (select(axis.is_x, per_y.z, per_y.x) - main_y * s) * half,
                                   (select(axis.is_y, per_y.z, per_y.y) - main_y * t) * half);
    }
    default: break;
  }
  return level_of_detail_lanes(texture, profile, per_x.x, per_x.y, per_y.x, per_y.y);
}
