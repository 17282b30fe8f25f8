// What the stages of surfaces in lanes share: a mesh's vectors, and where a surface has holes.

namespace {

SOFTFOCUS_INLINE Vec3Lanes load_vectors(const std::vector<glm::vec3>& vectors, Ints index) {
  static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
  const float* first = &vectors[0].x;
  const Ints at = index * 3;
  const Mask every = ~Mask{};
  return {gather(first, at, every), gather(first + 1, at, every), gather(first + 2, at, every)};
}

// The red of a holed surface's opacity texture; u is varying `first`, v the next.
template <class Quads>
SOFTFOCUS_INLINE Floats opacity_texels(const Quads& in, std::size_t first,
                                       const DecodedTexture& texture, const Sampler& sampler,
                                       const Profile& profile) {
  const Floats u = in.varying(first), v = in.varying(first + 1);
  alignas(64) std::array<std::array<float, kLanes>, 3> place;
  store(place[0].data(), u);
  store(place[1].data(), v);
  store(place[2].data(), level_of_detail_of_quads(texture, profile, u, v));
  RgbaLanes texels;
  sample_lanes(texture, sampler, profile, {place[0].data(), place[1].data(), place[2].data()}, 1,
               &texels);
  return texels.r;
}

}  // namespace
