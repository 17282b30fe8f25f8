// sample_lanes() and level_of_detail_lanes() over arrays whose length is a multiple of
// kLanes.

#include "raster/images/sample_lanes.inl"

inline void sample_all(const DecodedTexture& texture, const Sampler& sampler,
                       const Profile& profile, std::span<const SamplePoint> points,
                       std::span<SampledColour> colours) {
  constexpr auto kStep = static_cast<std::size_t>(kLanes);
  std::vector<float> u, v, lod;
  for (const SamplePoint& point : points) {
    u.push_back(point.u);
    v.push_back(point.v);
    lod.push_back(point.lod);
  }
  std::array<RgbLanes, kMostSampled> texels;
  // Batches of 1, 2, ... vectors by turns.
  std::size_t most = 0;
  for (std::size_t done = 0; done < points.size();) {
    most = most % kMostSampled + 1;
    const std::size_t count = std::min(most, (points.size() - done) / kStep);
    sample_lanes(texture, sampler, profile, {&u[done], &v[done], &lod[done]},
                 static_cast<int>(count), texels.data());
    for (std::size_t i = 0; i < count * kStep; ++i) {
      const RgbLanes& rgb = texels[i / kStep];
      const int lane = static_cast<int>(i % kStep);
      colours[done + i] = {rgb.r[lane], rgb.g[lane], rgb.b[lane]};
    }
    done += count * kStep;
  }
}

inline void find_levels(const DecodedTexture& texture, std::span<const Footprint> footprints,
                        std::span<float> lods) {
  for (std::size_t start = 0; start < footprints.size(); start += kLanes) {
    Floats du_dx, dv_dx, du_dy, dv_dy;
    for (int i = 0; i < kLanes; ++i) {
      const Footprint& footprint = footprints[start + static_cast<std::size_t>(i)];
      du_dx[i] = footprint.uv_per_x.x;
      dv_dx[i] = footprint.uv_per_x.y;
      du_dy[i] = footprint.uv_per_y.x;
      dv_dy[i] = footprint.uv_per_y.y;
    }
    store(&lods[start], level_of_detail_lanes(texture, du_dx, dv_dx, du_dy, dv_dy));
  }
}
