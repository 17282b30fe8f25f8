// What the stages of surfaces in lanes share: a mesh's vectors, and where a surface has holes.

namespace {

SOFTFOCUS_INLINE Vec3Lanes load_vectors(const std::vector<glm::vec3>& vectors, Ints index) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const float* first = &vectors[0].x;
  const Ints at = index * 3;
  const Mask every = ~Mask{};
  return {gather(first, at, every), gather(first + 1, at, every), gather(first + 2, at, every)};
}

// The red of a holed surface's opacity texture; u is a varying, and v the next.
template <class Quads>
SOFTFOCUS_INLINE Floats opacity_texels(const Quads& in, std::size_t u,
                                       const DecodedTexture& texture, const Sampler& sampler,
                                       const Profile& profile) {
  const std::size_t v = u + 1;
  alignas(64) std::array<std::array<float, kLanes>, 3> place;
  store(place[0].data(), in.varying(u));
  store(place[1].data(), in.varying(v));
  store(place[2].data(),
        level_of_detail_lanes(texture, profile, in.ddx(u), in.ddx(v), in.ddy(u), in.ddy(v)));
  RgbaLanes texels;
  sample_lanes(texture, sampler, profile, {place[0].data(), place[1].data(), place[2].data()}, 1,
               &texels);
  return texels.r;
}

}  // namespace
