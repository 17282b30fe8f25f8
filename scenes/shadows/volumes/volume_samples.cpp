#include "scenes/shadows/volumes/volume_samples.h"

#include <cmath>

namespace softfocus {
namespace {

// A linear function of the ray: height over the plane a metre of depth, and the eye's height.
struct PlaneOnScreen {
  Linear per_w;
  double of_eye;
};

PlaneOnScreen on_screen(const FacetPlane& plane, const PixelSpace& space) {
  return {{dot(plane.normal, space.columns[0]), dot(plane.normal, space.columns[1]),
           dot(plane.normal, space.columns[2])},
          height_over(plane, space.eye)};
}

class FacetSampler {
 public:
  FacetSampler(const SampledScene& scene, const PixelSpace& space)
      : facets_(scene.facets),
        light_(scene.light),
        lit_(scene.lit),
        space_(space),
        light_in_pixels_(to_light(space, scene.light)) {}

  // What the next samples are of. False if it takes no shadows.
  bool set(SeenFacet seen) {
    if (!shows_facet(seen)) return false;
    const std::uint32_t facet = facet_of(seen), receiver = facets_.receiver_of[facet];
    if (lit_[receiver] != (seen_from_back(seen) ? LitSide::back : LitSide::front)) return false;
    const FacetPlane& plane = facets_.receivers[receiver].plane;
    facet_ = on_screen(facets_.planes[facet], space_);
    receiver_ = on_screen(plane, space_);
    light_height_ = height_over(plane, light_);
    over_ = seen_from_back(seen) ? -facets_.epsilon_m : facets_.epsilon_m;
    return true;
  }

  // (x, y, w) of the sample of a pixel's centre.
  glm::dvec3 sample(double x, double y) const {
    const double w = -facet_.of_eye / at(facet_.per_w, x, y);
    const double height = w * at(receiver_.per_w, x, y) + receiver_.of_eye;
    const double t = (over_ - height) / (light_height_ - light_.w * height);
    return glm::dvec3{x, y, 1.0} * (w * (1.0 - t * light_.w)) + light_in_pixels_ * t;
  }

 private:
  const Facets& facets_;
  const ShadowLight& light_;
  std::span<const LitSide> lit_;
  const PixelSpace& space_;
  glm::dvec3 light_in_pixels_;
  PlaneOnScreen facet_{}, receiver_{};
  double light_height_ = 0.0, over_ = 0.0;
};

}  // namespace

std::size_t place_in_band(int x, int row, int width) {
  const int blocks_across = (width + kSampleBlockSize - 1) / kSampleBlockSize;
  const int block = row / kSampleBlockSize * blocks_across + x / kSampleBlockSize;
  return static_cast<std::size_t>(block * kSampleBlockPixels +
                                  row % kSampleBlockSize * kSampleBlockSize + x % kSampleBlockSize);
}

bool find_samples(const SampledScene& scene, const MaskRows& rows, const ShadowView& view,
                  const PixelSpace& space, Band& band, std::vector<FarSample>& far) {
  FacetSampler sampler{scene, space};
  const int across = (view.width + kSampleBlockSize - 1) / kSampleBlockSize;
  const std::size_t blocks = static_cast<std::size_t>(across) * kSampleBlockRows;
  const std::size_t pixels = blocks * kSampleBlockPixels;
  // What pixels without a sample count to does not matter.
  band.x.resize(pixels);
  band.y.resize(pixels);
  band.q.resize(pixels);
  band.counts.assign(pixels, 0);
  band.counted.assign(pixels, 0);
  band.blocks.assign(blocks, {});
  bool any = false;
  for (int y = rows.y_begin; y < rows.y_end; ++y) {
    SeenFacet last = 0;
    bool takes = false;
    for (int x = 0; x < view.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                static_cast<std::size_t>(x);
      if (rows.seen[pixel] != last) {
        last = rows.seen[pixel];
        takes = sampler.set(last);
      }
      if (!takes || (rows.mask[pixel] & rows.bit) != 0) continue;
      const glm::dvec3 sample = sampler.sample(x + 0.5, y + 0.5);
      const double q = 1.0 / sample.z;
      const double at_x = sample.x * q, at_y = sample.y * q;
      if (!(sample.z >= space.least_w) || !(std::fabs(at_x - (x + 0.5)) <= kFarthest) ||
          !(std::fabs(at_y - (y + 0.5)) <= kFarthest)) {
        far.push_back({pixel, space.eye + from_pixels(space, sample)});
        continue;
      }
      const std::size_t to = place_in_band(x, y - rows.y_begin, view.width);
      band.x[to] = at_x;
      band.y[to] = at_y;
      band.q[to] = q;
      band.counted[to] = 1;
      widen(band.blocks[to / kSampleBlockPixels].q, q);
      any = true;
    }
  }
  return any;
}

void set_mask(const MaskRows& rows, int width, std::int32_t of_eye, const Band& band) {
  for (int y = rows.y_begin; y < rows.y_end; ++y) {
    std::uint8_t* mask =
        rows.mask.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    for (int x = 0; x < width; ++x) {
      const std::size_t from = place_in_band(x, y - rows.y_begin, width);
      if (band.counted[from] != 0 && of_eye + count_at(band, from) > 0) {
        mask[x] = static_cast<std::uint8_t>(mask[x] | rows.bit);
      }
    }
  }
}

}  // namespace softfocus
