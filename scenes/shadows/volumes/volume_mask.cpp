#ifndef SOFTFOCUS_ISA

#include "scenes/shadows/volumes/volume_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/shadows/volumes/volume_samples.h"

namespace softfocus {
namespace {

struct CountedFace {
  std::array<Linear, 3> edges;
  std::array<double, 3> least;  // E is positive if it is greater
  std::array<double, 3> w, is_finite;
  std::int64_t times;
};

// Pixels' samples, one after the other.
struct Samples {
  const double *x, *y, *q;
  std::int64_t* counts;
  std::size_t count;  // a multiple of kSampleBlockSize
};

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/shadows/volumes/volume_mask.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// More than the error of a sum of products in binary64, over the sum of its terms' sizes.
constexpr double kRounding = 0x1p-48;

// Extremes over a block are those of the points that its samples can be.
struct BlockArea {
  double x_low, x_high, y_low, y_high;
};

double least_in(const Linear& f, const BlockArea& area) {
  return at(f, f.a > 0.0 ? area.x_low : area.x_high, f.b > 0.0 ? area.y_low : area.y_high);
}

double greatest_in(const Linear& f, const BlockArea& area) {
  return at(f, f.a > 0.0 ? area.x_high : area.x_low, f.b > 0.0 ? area.y_high : area.y_low);
}

// The terms of a x b . (x, y, 1) within the picture, as sizes.
double size_of_edge(glm::dvec3 a, glm::dvec3 b, const ShadowView& view) {
  a = abs(a);
  b = abs(b);
  return ((a.y * b.z + a.z * b.y) * (view.width + 1) +
          (a.z * b.x + a.x * b.z) * (view.height + 1)) +
         (a.x * b.y + a.y * b.x);
}

Linear linear(glm::dvec3 v) { return {v.x, v.y, v.z}; }

// A centre on an edge, E = 0, is on the side to which a step to the right, or else down, leads.
double least_outside(const Linear& edge) {
  const bool owns = edge.a > 0.0 || (edge.a == 0.0 && edge.b > 0.0);
  return owns ? -std::numeric_limits<double>::denorm_min() : 0.0;
}

// Written as the lanes are.
template <VolumeCount kCount>
void count_samples(const CountedFace& face, const Samples& samples) {
  for (std::size_t i = 0; i < samples.count; ++i) {
    const double e0 = at(face.edges[0], samples.x[i], samples.y[i]);
    const double e1 = at(face.edges[1], samples.x[i], samples.y[i]);
    const double e2 = at(face.edges[2], samples.x[i], samples.y[i]);
    const bool in0 = e0 > face.least[0], in1 = e1 > face.least[1], in2 = e2 > face.least[2];
    if (in0 != in1 || in0 != in2) continue;
    const double of_w = (e0 * face.w[0] + e1 * face.w[1]) + e2 * face.w[2];
    const double finite =
        (e0 * face.is_finite[0] + e1 * face.is_finite[1]) + e2 * face.is_finite[2];
    const double beyond = samples.q[i] * of_w - finite;
    const bool counts = kCount == VolumeCount::z_fail
                            ? (in0 ? beyond > 0.0 : beyond < 0.0)
                            : (in0 ? of_w > 0.0 && !(beyond > 0.0) : of_w < 0.0 && !(beyond < 0.0));
    if (counts) samples.counts[i] += in0 ? face.times : -face.times;
  }
}

using CountSamples = void (*)(const CountedFace&, const Samples&);

template <VolumeCount kCount>
CountSamples count_samples_by(Isa isa) {
  if (isa == Isa::scalar) return count_samples<kCount>;
  return kCount == VolumeCount::z_fail ? SOFTFOCUS_KERNEL(isa, count_behind)
                                       : SOFTFOCUS_KERNEL(isa, count_before);
}

template <VolumeCount kCount>
class BandCounter {
 public:
  BandCounter(const ShadowView& view, const PixelSpace& space, const SeenFaces& faces, int y_begin,
              Isa isa, Band& band)
      : view_(view),
        space_(space),
        faces_(faces),
        y_begin_(y_begin),
        blocks_across_((view.width + kSampleBlockSize - 1) / kSampleBlockSize),
        count_samples_(count_samples_by<kCount>(isa)),
        band_(band) {}

  void count(const VolumeFace& of) {
    const std::array<glm::dvec3, 3> v = corners_of(of, faces_);
    CountedFace face{};
    Linear finite{0.0, 0.0, 0.0};
    double depth_size = 0.0, finite_size = 0.0;
    std::array<double, 3> sizes{};
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec3 edge = cross(v[(i + 1) % 3], v[(i + 2) % 3]);
      if (edge == glm::dvec3{0.0}) return;
      face.edges[i] = linear(edge);
      face.least[i] = least_outside(face.edges[i]);
      face.w[i] = v[i].z;
      face.is_finite[i] = of.corners[i] < faces_.first_far ? 1.0 : 0.0;
      sizes[i] = kRounding * size_of_edge(v[(i + 1) % 3], v[(i + 2) % 3], view_);
      finite = {finite.a + edge.x * face.is_finite[i], finite.b + edge.y * face.is_finite[i],
                finite.c + edge.z * face.is_finite[i]};
      depth_size += sizes[i] * std::fabs(v[i].z);
      finite_size += sizes[i] * face.is_finite[i];
    }
    // z-fail counts what leaves a volume behind the sample, z-pass what enters one before it.
    const double sign = kCount == VolumeCount::z_fail ? -space_.facing : space_.facing;
    face.times = sign > 0.0 ? of.times : -of.times;
    const double depth = dot(v[0], glm::dvec3{face.edges[0].a, face.edges[0].b, face.edges[0].c});
    const Outline outline = outline_of(of, faces_, kCount, space_, view_);
    const Extremes rows = rows_of(outline);
    for (int row = 0; row < kSampleBlockRows; ++row) {
      const int y = y_begin_ + row * kSampleBlockSize;
      const double y_low = y - kReach, y_high = y + kSampleBlockSize + kReach;
      if (rows.high < y_low || rows.low > y_high) continue;
      const Extremes columns = columns_of(outline, y_low, y_high);
      const Cells blocks = cells_within(columns.low - kReach, columns.high + kReach,
                                        kSampleBlockSize, blocks_across_);
      for (int column = blocks.begin; column < blocks.end; ++column) {
        const std::size_t number = static_cast<std::size_t>(row * blocks_across_ + column);
        Band::Block& block = band_.blocks[number];
        if (!(block.q.low <= block.q.high)) continue;
        const double x = column * kSampleBlockSize;
        const BlockArea area{x + 0.5 - kFarthest, x + kSampleBlockSize - 0.5 + kFarthest,
                             y + 0.5 - kFarthest, y + kSampleBlockSize - 0.5 + kFarthest};
        // With the sign of E: which sides can be met, which must be.
        bool may_be_positive = true, may_be_negative = true;
        bool is_positive = true, is_negative = true;
        for (std::size_t i = 0; i < 3; ++i) {
          const double low = least_in(face.edges[i], area);
          const double high = greatest_in(face.edges[i], area);
          may_be_positive &= high >= -sizes[i];
          may_be_negative &= low <= sizes[i];
          is_positive &= low > sizes[i];
          is_negative &= high < -sizes[i];
        }
        if (!may_be_positive && !may_be_negative) continue;
        // q of_w - finite, as in count_pixels(): of_w is the same everywhere.
        const double margin = block.q.high * depth_size + finite_size;
        const double low =
            std::min(block.q.low * depth, block.q.high * depth) - greatest_in(finite, area);
        const double high =
            std::max(block.q.low * depth, block.q.high * depth) - least_in(finite, area);
        if constexpr (kCount == VolumeCount::z_fail) {
          if (!(may_be_positive && high >= -margin) && !(may_be_negative && low <= margin)) {
            continue;
          }
          if (is_positive && low > margin) {
            block.count += face.times;
            continue;
          }
          if (is_negative && high < -margin) {
            block.count -= face.times;
            continue;
          }
        } else {
          if (!(may_be_positive && low <= margin) && !(may_be_negative && high >= -margin)) {
            continue;
          }
          if (is_positive && depth > depth_size && high < -margin) {
            block.count += face.times;
            continue;
          }
          if (is_negative && depth < -depth_size && low > margin) {
            block.count -= face.times;
            continue;
          }
        }
        const std::size_t first = number * kSampleBlockPixels;
        const auto within = [&](double at_row) {
          return std::clamp(static_cast<int>(std::clamp(at_row, 0.0, 8.0)), 0, kSampleBlockSize);
        };
        const int row_begin = within(std::floor(rows.low - kReach - y));
        const int row_end = within(std::floor(rows.high + kReach - y) + 1.0);
        if (row_begin >= row_end) continue;
        const std::size_t from = first + static_cast<std::size_t>(row_begin * kSampleBlockSize);
        count_samples_(face, {band_.x.data() + from, band_.y.data() + from, band_.q.data() + from,
                              band_.counts.data() + from,
                              static_cast<std::size_t>((row_end - row_begin) * kSampleBlockSize)});
      }
    }
  }

 private:
  const ShadowView& view_;
  const PixelSpace& space_;
  const SeenFaces& faces_;
  int y_begin_;
  int blocks_across_;
  CountSamples count_samples_;
  Band& band_;
};

std::size_t draw_far_samples(const Facets& facets, const JoinedFacets& joined,
                             ShadowVolumes& volumes, std::uint8_t bit,
                             std::span<const std::vector<FarSample>> far,
                             std::span<std::uint8_t> mask, ThreadPool& pool) {
  std::size_t sum = 0;
  for (const auto& of_band : far) sum += of_band.size();
  if (sum == 0) return 0;
  if (!volumes.grid) volumes.grid = make_light_grid(facets, volumes.light);
  pool.for_each(static_cast<int>(far.size()), [&](int number) {
    std::vector<std::uint32_t> casters;
    for (const FarSample& sample : far[static_cast<std::size_t>(number)]) {
      find_casters(*volumes.grid, {&sample.place, 1}, casters);
      if (volumes_that_hold(facets, joined, volumes.light, casters, sample.place) > 0) {
        mask[sample.pixel] = static_cast<std::uint8_t>(mask[sample.pixel] | bit);
      }
    }
  });
  return sum;
}

// Everything that the bands of a picture are counted with.
struct BandsOfView {
  const SampledScene& scene;
  MaskRows rows;  // all
  const ShadowView& view;
  const PixelSpace& space;
};

// Calls use(rows, band) for each band with samples. Returns those that lie elsewhere, by bands.
template <VolumeCount kCount, class Use>
std::vector<std::vector<FarSample>> count_bands(const SeenFaces& faces, const BandsOfView& of,
                                                ThreadPool& pool, const Use& use) {
  const Bands bands = sort_into_bands(faces, kCount, of.space, of.view, pool);
  std::vector<std::vector<FarSample>> far(bands.begins.size() - 1);
  for_each_with<Band>(pool, static_cast<int>(far.size()), [&](int number, auto& band) {
    const auto i = static_cast<std::size_t>(number);
    MaskRows rows = of.rows;
    rows.y_begin = number * kBandRows;
    rows.y_end = std::min(rows.y_begin + kBandRows, of.view.height);
    if (find_samples(of.scene, rows, of.view, of.space, band, far[i])) {
      BandCounter<kCount> counter{of.view, of.space, faces, rows.y_begin, pool.isa(), band};
      for (std::size_t k = bands.begins[i]; k < bands.begins[i + 1]; ++k) {
        counter.count(faces.faces[bands.faces[k]]);
      }
      use(rows, band);
    }
  });
  return far;
}

template <class Use>
std::vector<std::vector<FarSample>> count_bands_by(VolumeCount count, const SeenFaces& faces,
                                                   const BandsOfView& of, ThreadPool& pool,
                                                   const Use& use) {
  return count == VolumeCount::z_fail ? count_bands<VolumeCount::z_fail>(faces, of, pool, use)
                                      : count_bands<VolumeCount::z_pass>(faces, of, pool, use);
}

SeenFaces seen_faces(const ShadowVolumes& volumes, const JoinedFacets& joined, VolumeCount count,
                     std::span<const glm::dvec3> corners) {
  const bool by_pass = count == VolumeCount::z_pass;
  return {{volumes.faces.data(), by_pass ? volumes.faces_before_far_caps : volumes.faces.size()},
          corners,
          static_cast<std::uint32_t>(joined.corners.size())};
}

}  // namespace

std::size_t draw_volume_mask(const Facets& facets, const JoinedFacets& joined,
                             ShadowVolumes& volumes, std::span<const LitSide> lit, std::uint8_t bit,
                             std::span<const SeenFacet> seen, const ShadowView& view,
                             glm::dvec3 eye, VolumeCount count, std::span<std::uint8_t> mask,
                             ThreadPool& pool) {
  const PixelSpace space = pixel_space(view, eye);
  const std::vector<glm::dvec3> corners = corners_in_pixels(space, joined, volumes.light, pool);
  const SampledScene sampled{facets, volumes.light, lit};
  const std::int32_t of_eye =
      count == VolumeCount::z_pass
          ? volumes_that_hold(facets, joined, volumes.light, volumes.casters, eye)
          : 0;
  const auto far = count_bands_by(
      count, seen_faces(volumes, joined, count, corners),
      {sampled, {seen, mask, bit, 0, view.height}, view, space}, pool,
      [&](const MaskRows& rows, const Band& band) { set_mask(rows, view.width, of_eye, band); });
  return draw_far_samples(facets, joined, volumes, bit, far, mask, pool);
}

VolumeCounts count_volumes(const Facets& facets, const JoinedFacets& joined,
                           const ShadowVolumes& volumes, std::span<const LitSide> lit,
                           std::uint8_t bit, std::span<const SeenFacet> seen,
                           const ShadowView& view, glm::dvec3 eye, VolumeCount count,
                           std::span<std::uint8_t> mask, ThreadPool& pool) {
  const PixelSpace space = pixel_space(view, eye);
  VolumeCounts counted;
  counted.corners = corners_in_pixels(space, joined, volumes.light, pool);
  const SeenFaces faces = seen_faces(volumes, joined, count, counted.corners);
  counted.faces = faces.faces.size();
  counted.samples.resize(seen.size());
  counted.counts.resize(seen.size());
  const SampledScene sampled{facets, volumes.light, lit};
  count_bands_by(count, faces, {sampled, {seen, mask, bit, 0, view.height}, view, space}, pool,
                 [&](const MaskRows& rows, const Band& band) {
                   for (int y = rows.y_begin; y < rows.y_end; ++y) {
                     const std::size_t row =
                         static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
                     for (int x = 0; x < view.width; ++x) {
                       const std::size_t from = place_in_band(x, y - rows.y_begin, view.width);
                       if (band.counted[from] == 0) continue;
                       const std::size_t pixel = row + static_cast<std::size_t>(x);
                       counted.samples[pixel] = {band.x[from], band.y[from], band.q[from]};
                       counted.counts[pixel] = count_at(band, from);
                     }
                   }
                 });
  return counted;
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

namespace {

// Half as many numbers as other kernels have lanes.
using SampleDoubles [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = double;
using SampleLongs [[gnu::vector_size(4 * SOFTFOCUS_LANES)]] = std::int64_t;
constexpr std::size_t kSampleLanes = SOFTFOCUS_LANES / 2;

SOFTFOCUS_INLINE SampleDoubles load_samples(const double* from) {
  SampleDoubles v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

SOFTFOCUS_INLINE SampleDoubles at(const Linear& f, SampleDoubles x, SampleDoubles y) {
  return (f.a * x + f.b * y) + f.c;
}

SOFTFOCUS_INLINE void add_counts(const CountedFace& face, SampleLongs up, SampleLongs down,
                                 std::int64_t* to) {
  SampleLongs counts;
  std::memcpy(&counts, to, sizeof counts);
  counts += (up & face.times) - (down & face.times);
  std::memcpy(to, &counts, sizeof counts);
}

template <bool kBehind>
SOFTFOCUS_INLINE void count_samples(const CountedFace& face, const Samples& samples) {
  for (std::size_t i = 0; i < samples.count; i += kSampleLanes) {
    const SampleDoubles x = load_samples(samples.x + i), y = load_samples(samples.y + i);
    const SampleDoubles e0 = at(face.edges[0], x, y);
    const SampleDoubles e1 = at(face.edges[1], x, y);
    const SampleDoubles e2 = at(face.edges[2], x, y);
    const SampleLongs in0 = e0 > face.least[0], in1 = e1 > face.least[1], in2 = e2 > face.least[2];
    const SampleLongs up = in0 & in1 & in2, down = ~(in0 | in1 | in2);
    const SampleDoubles of_w = (e0 * face.w[0] + e1 * face.w[1]) + e2 * face.w[2];
    const SampleDoubles finite =
        (e0 * face.is_finite[0] + e1 * face.is_finite[1]) + e2 * face.is_finite[2];
    const SampleDoubles beyond = load_samples(samples.q + i) * of_w - finite;
    const SampleLongs above = beyond > 0.0, below = beyond < 0.0;
    if constexpr (kBehind) {
      add_counts(face, up & above, down & below, samples.counts + i);
    } else {
      const SampleLongs ahead = of_w > 0.0, astern = of_w < 0.0;
      add_counts(face, up & ahead & ~above, down & astern & ~below, samples.counts + i);
    }
  }
}

}  // namespace

void count_behind(const CountedFace& face, const Samples& samples) {
  count_samples<true>(face, samples);
}

void count_before(const CountedFace& face, const Samples& samples) {
  count_samples<false>(face, samples);
}

#endif
