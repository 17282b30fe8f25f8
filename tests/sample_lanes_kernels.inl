// sample_lanes() and level_of_detail_lanes() over arrays whose length is a multiple of
// kLanes.

#include "raster/images/sample_lanes.inl"

inline void sample_all(const DecodedTexture& texture, const Sampler& sampler,
                       const Profile& profile, std::span<const SamplePoint> points,
                       std::span<SampledColour> colours) {
  for (std::size_t start = 0; start < points.size(); start += kLanes) {
    Floats u, v, lod;
    Mask active;
    for (int i = 0; i < kLanes; ++i) {
      const SamplePoint& point = points[start + static_cast<std::size_t>(i)];
      u[i] = point.u;
      v[i] = point.v;
      lod[i] = point.lod;
      active[i] = point.active ? -1 : 0;
    }
    const RgbLanes rgb = sample_lanes(texture, sampler, u, v, lod, active, profile);
    for (int i = 0; i < kLanes; ++i) {
      colours[start + static_cast<std::size_t>(i)] = {rgb.r[i], rgb.g[i], rgb.b[i]};
    }
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
