#ifndef SOFTFOCUS_ISA

#include "scenes/shadows/volume_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "raster/threads/scratch_shelf.h"

namespace softfocus {
namespace {

// f(x, y) = a x + b y + c
struct Linear {
  double a, b, c;
};

double at(const Linear& f, double x, double y) { return (f.a * x + f.b * y) + f.c; }

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
  std::size_t count;  // a multiple of kBlockSize
};

// The pixels of a block's row, which the widest unit takes at once.
constexpr int kBlockSize = 8;

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/shadows/volume_mask.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

// Pixels are counted in blocks, which most faces cover whole or not at all, in bands of blocks,
// which are tasks.
constexpr int kBlockPixels = kBlockSize * kBlockSize;
constexpr int kBandRows = 4 * kBlockSize;
constexpr int kBlockRows = kBandRows / kBlockSize;

// How far a sample may lie from its pixel's centre, in pixels.
constexpr double kFarthest = 0.5;

// Of the sum of its terms' sizes, more than a sum of products in binary64 can be wrong.
constexpr double kRounding = 0x1p-48;

// Corners (x, y, w) about the eye: x / w and y / w are pixels from the picture's upper left corner,
// w is the depth along the axis.
struct PixelSpace {
  glm::dvec3 eye;
  std::array<glm::dvec3, 3> rows;     // of the matrix from the world to x, y and w
  std::array<glm::dvec3, 3> columns;  // of its inverse
  double least_w;                     // of a sample
  double facing;                      // det(v_0, v_1, v_2) has this sign for what faces the eye
};

PixelSpace pixel_space(const ShadowView& view, glm::dvec3 eye) {
  const auto row = [&](int i) {
    const glm::dmat4& m = view.world_to_clip;
    return glm::dvec3{m[0][i], m[1][i], m[2][i]};
  };
  PixelSpace space{};
  space.eye = eye;
  space.rows = {(row(0) + row(3)) * (view.width / 2.0), (row(1) + row(3)) * (view.height / 2.0),
                row(3)};
  const auto& [x, y, w] = space.rows;
  const double determinant = dot(x, cross(y, w));
  space.columns = {cross(y, w) / determinant, cross(w, x) / determinant, cross(x, y) / determinant};
  space.facing = determinant > 0.0 ? -1.0 : 1.0;
  // z = a w + b, and -w = z is the near plane. A quarter of its depth: samples may come nearer.
  const double a = dot(row(2), w) / dot(w, w);
  const double b = dot(row(2), eye) + view.world_to_clip[3][2];
  space.least_w = -0.25 * b / (1.0 + a);
  return space;
}

glm::dvec3 to_pixels(const PixelSpace& space, glm::dvec3 from_eye) {
  return {dot(space.rows[0], from_eye), dot(space.rows[1], from_eye), dot(space.rows[2], from_eye)};
}

glm::dvec3 from_pixels(const PixelSpace& space, glm::dvec3 v) {
  return (space.columns[0] * v.x + space.columns[1] * v.y) + space.columns[2] * v.z;
}

glm::dvec3 to_light(const PixelSpace& space, const ShadowLight& light) {
  return to_pixels(space, light.place - space.eye * light.w);
}

// All corners of an array of faces: the joined ones, then those at infinity.
std::vector<glm::dvec3> corners_in_pixels(const PixelSpace& space, const JoinedFacets& joined,
                                          const ShadowLight& light, ThreadPool& pool) {
  const std::size_t count = joined.corners.size();
  std::vector<glm::dvec3> all(light.w == 0.0 ? count + 1 : 2 * count);
  if (light.w == 0.0) all[count] = to_pixels(space, -light.place);
  constexpr std::size_t kCornersATask = 4096;
  pool.for_each(static_cast<int>((count + kCornersATask - 1) / kCornersATask), [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kCornersATask;
    for (std::size_t i = begin; i < std::min(begin + kCornersATask, count); ++i) {
      all[i] = to_pixels(space, joined.corners[i] - space.eye);
      if (light.w != 0.0) all[count + i] = to_pixels(space, joined.corners[i] - light.place);
    }
  });
  return all;
}

// The faces of a light, and which corners of theirs are infinitely far: those from `first_far` on.
struct SeenFaces {
  std::span<const VolumeFace> faces;
  std::span<const glm::dvec3> corners;
  std::uint32_t first_far;
};

std::array<glm::dvec3, 3> corners_of(const VolumeFace& face, const SeenFaces& of) {
  return {of.corners[face.corners[0]], of.corners[face.corners[1]], of.corners[face.corners[2]]};
}

// Where in the window a face can meet rays: a convex polygon.
struct Outline {
  std::array<glm::dvec2, 4> corners;
  std::size_t count = 0;
};

double size_of(glm::dvec3 v) { return (std::fabs(v.x) + std::fabs(v.y)) + std::fabs(v.z); }

// Directions that are all but opposite: what lies between them can be anywhere.
bool is_opposite(glm::dvec3 a, glm::dvec3 b) {
  return size_of(a / size_of(a) + b / size_of(b)) < 0x1p-16;
}

// Cut where rays are not as deep as samples, which only faces behind the samples may be. Corners
// at infinity are deep if they are before the camera. The whole picture where a cut would be too
// far away to compute with.
template <VolumeCount kCount>
Outline outline_of(const VolumeFace& face, const SeenFaces& of, const PixelSpace& space,
                   const ShadowView& view) {
  const double width = view.width, height = view.height;
  const Outline whole{{glm::dvec2{0.0}, {width, 0.0}, {width, height}, {0.0, height}}, 4};
  const std::array<glm::dvec3, 3> v = corners_of(face, of);
  if (v[0].z <= 0.0 && v[1].z <= 0.0 && v[2].z <= 0.0) return {};
  std::array<double, 3> inside_by{};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    const bool is_far = face.corners[i] >= of.first_far;
    const double least = is_far ? size_of(v[i]) / (width + height) * 0x1p-24 : space.least_w;
    inside_by[i] = v[i].z - least;
    if constexpr (kCount == VolumeCount::z_pass) {
      if (inside_by[i] < 0.0) return whole;
    } else if (is_far && face.corners[next] >= of.first_far && is_opposite(v[i], v[next])) {
      return whole;
    }
  }
  Outline outline;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t next = (i + 1) % 3;
    if (inside_by[i] >= 0.0) outline.corners[outline.count++] = glm::dvec2{v[i]} / v[i].z;
    if ((inside_by[i] >= 0.0) != (inside_by[next] >= 0.0)) {
      const glm::dvec3 cut =
          v[i] + (v[next] - v[i]) * (inside_by[i] / (inside_by[i] - inside_by[next]));
      outline.corners[outline.count++] = glm::dvec2{cut} / cut.z;
    }
  }
  return outline;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

void widen(Range& range, double to) {
  range.low = std::min(range.low, to);
  range.high = std::max(range.high, to);
}

Range rows_of(const Outline& outline) {
  Range range;
  for (std::size_t i = 0; i < outline.count; ++i) widen(range, outline.corners[i].y);
  return range;
}

// Between two heights.
Range columns_of(const Outline& outline, double y_low, double y_high) {
  Range range;
  for (std::size_t i = 0; i < outline.count; ++i) {
    glm::dvec2 a = outline.corners[i], b = outline.corners[(i + 1) % outline.count];
    if (a.y > b.y) std::swap(a, b);
    if (b.y < y_low || a.y > y_high) continue;
    const double per_y = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    widen(range, a.y < y_low ? a.x + (y_low - a.y) * per_y : a.x);
    widen(range, b.y > y_high ? b.x + (y_high - b.y) * per_y : b.x);
  }
  return range;
}

// The whole numbers from one place to another, within 0 <= n < most.
struct Cells {
  int begin, end;
};

Cells cells_within(double low, double high, int size, int most) {
  if (!(low <= high)) return {0, 0};
  const double begin = std::floor(low / size), end = std::floor(high / size) + 1.0;
  return {begin > 0.0 ? static_cast<int>(std::min<double>(begin, most)) : 0,
          end > 0.0 ? static_cast<int>(std::min<double>(end, most)) : 0};
}

// Beyond what a sample may lie away, for the rounding of outlines.
constexpr double kReach = kFarthest + 0x1p-6;

// CSR: the faces that may meet band i's samples are faces[begins[i]] to faces[begins[i + 1] - 1].
struct Bands {
  std::vector<std::size_t> begins;
  std::vector<std::uint32_t> faces;
};

template <VolumeCount kCount>
Bands sort_into_bands(const SeenFaces& of, const PixelSpace& space, const ShadowView& view,
                      ThreadPool& pool) {
  const std::span<const VolumeFace> faces = of.faces;
  const int count = (view.height + kBandRows - 1) / kBandRows;
  std::vector<Cells> of_faces(faces.size(), {0, 0});
  constexpr std::size_t kFacesATask = 4096;
  pool.for_each(static_cast<int>((faces.size() + kFacesATask - 1) / kFacesATask), [&](int task) {
    const std::size_t begin = static_cast<std::size_t>(task) * kFacesATask;
    for (std::size_t i = begin; i < std::min(begin + kFacesATask, faces.size()); ++i) {
      const Outline outline = outline_of<kCount>(faces[i], of, space, view);
      const Range rows = rows_of(outline), columns = columns_of(outline, 0.0, view.height);
      if (columns.high < -kReach || columns.low > view.width + kReach) continue;
      of_faces[i] = cells_within(rows.low - kReach, rows.high + kReach, kBandRows, count);
    }
  });
  Bands bands;
  bands.begins.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const Cells& cells : of_faces) {
    for (int band = cells.begin; band < cells.end; ++band) {
      ++bands.begins[static_cast<std::size_t>(band) + 1];
    }
  }
  for (std::size_t i = 1; i < bands.begins.size(); ++i) bands.begins[i] += bands.begins[i - 1];
  bands.faces.resize(bands.begins.back());
  std::vector<std::size_t> next = bands.begins;
  for (std::uint32_t i = 0; i < of_faces.size(); ++i) {
    for (int band = of_faces[i].begin; band < of_faces[i].end; ++band) {
      bands.faces[next[static_cast<std::size_t>(band)]++] = i;
    }
  }
  return bands;
}

// What a band of the picture is counted with. Pixels lie block by block.
struct Band {
  std::vector<double> x, y, q;
  std::vector<std::int64_t> counts;
  std::vector<std::uint8_t> counted;  // whether the pixel has a sample
  struct Block {
    Range q;
    std::int64_t count = 0;  // of all its pixels
  };
  std::vector<Block> blocks;
};

// A pixel whose sample lies elsewhere.
struct FarSample {
  std::size_t pixel;
  glm::dvec3 place;
};

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
        blocks_across_((view.width + kBlockSize - 1) / kBlockSize),
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
    const Outline outline = outline_of<kCount>(of, faces_, space_, view_);
    const Range rows = rows_of(outline);
    for (int row = 0; row < kBlockRows; ++row) {
      const int y = y_begin_ + row * kBlockSize;
      const double y_low = y - kReach, y_high = y + kBlockSize + kReach;
      if (rows.high < y_low || rows.low > y_high) continue;
      const Range columns = columns_of(outline, y_low, y_high);
      const Cells blocks =
          cells_within(columns.low - kReach, columns.high + kReach, kBlockSize, blocks_across_);
      for (int column = blocks.begin; column < blocks.end; ++column) {
        const std::size_t number = static_cast<std::size_t>(row * blocks_across_ + column);
        Band::Block& block = band_.blocks[number];
        if (!(block.q.low <= block.q.high)) continue;
        const double x = column * kBlockSize;
        const BlockArea area{x + 0.5 - kFarthest, x + kBlockSize - 0.5 + kFarthest,
                             y + 0.5 - kFarthest, y + kBlockSize - 0.5 + kFarthest};
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
        const std::size_t first = number * kBlockPixels;
        const auto within = [&](double at_row) {
          return std::clamp(static_cast<int>(std::clamp(at_row, 0.0, 8.0)), 0, kBlockSize);
        };
        const int row_begin = within(std::floor(rows.low - kReach - y));
        const int row_end = within(std::floor(rows.high + kReach - y) + 1.0);
        if (row_begin >= row_end) continue;
        const std::size_t from = first + static_cast<std::size_t>(row_begin * kBlockSize);
        count_samples_(face, {band_.x.data() + from, band_.y.data() + from, band_.q.data() + from,
                              band_.counts.data() + from,
                              static_cast<std::size_t>((row_end - row_begin) * kBlockSize)});
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

class Sampler {
 public:
  Sampler(const Facets& facets, const ShadowLight& light, std::span<const LitSide> lit,
          const PixelSpace& space)
      : facets_(facets),
        light_(light),
        lit_(lit),
        space_(space),
        light_in_pixels_(to_light(space, light)) {}

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

struct MaskRows {
  std::span<const SeenFacet> seen;
  std::span<std::uint8_t> mask;
  std::uint8_t bit;
  int y_begin, y_end;
};

std::size_t place_in_band(int x, int row, int blocks_across) {
  const int block = row / kBlockSize * blocks_across + x / kBlockSize;
  return static_cast<std::size_t>(block * kBlockPixels + row % kBlockSize * kBlockSize +
                                  x % kBlockSize);
}

bool find_samples(Sampler sampler, const MaskRows& rows, const ShadowView& view,
                  const PixelSpace& space, Band& band, std::vector<FarSample>& far) {
  const int across = (view.width + kBlockSize - 1) / kBlockSize;
  const std::size_t blocks = static_cast<std::size_t>(across) * kBlockRows;
  const std::size_t pixels = blocks * kBlockPixels;
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
      const std::size_t to = place_in_band(x, y - rows.y_begin, across);
      band.x[to] = at_x;
      band.y[to] = at_y;
      band.q[to] = q;
      band.counted[to] = 1;
      widen(band.blocks[to / kBlockPixels].q, q);
      any = true;
    }
  }
  return any;
}

void set_mask(const MaskRows& rows, int width, std::int32_t of_eye, const Band& band) {
  const int across = (width + kBlockSize - 1) / kBlockSize;
  for (int y = rows.y_begin; y < rows.y_end; ++y) {
    std::uint8_t* mask =
        rows.mask.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    for (int x = 0; x < width; ++x) {
      const std::size_t from = place_in_band(x, y - rows.y_begin, across);
      const std::int64_t count =
          of_eye + band.blocks[from / kBlockPixels].count + band.counts[from];
      if (band.counted[from] != 0 && count > 0) {
        mask[x] = static_cast<std::uint8_t>(mask[x] | rows.bit);
      }
    }
  }
}

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

template <VolumeCount kCount>
std::size_t draw_counted(const Facets& facets, const JoinedFacets& joined, ShadowVolumes& volumes,
                         std::span<const LitSide> lit, std::uint8_t bit,
                         std::span<const SeenFacet> seen, const ShadowView& view, glm::dvec3 eye,
                         std::span<std::uint8_t> mask, ThreadPool& pool) {
  constexpr bool kByPass = kCount == VolumeCount::z_pass;
  const PixelSpace space = pixel_space(view, eye);
  const std::vector<glm::dvec3> corners = corners_in_pixels(space, joined, volumes.light, pool);
  const SeenFaces faces{
      {volumes.faces.data(), kByPass ? volumes.faces_before_far_caps : volumes.faces.size()},
      corners,
      static_cast<std::uint32_t>(joined.corners.size())};
  const Bands bands = sort_into_bands<kCount>(faces, space, view, pool);
  const std::int32_t of_eye =
      kByPass ? volumes_that_hold(facets, joined, volumes.light, volumes.casters, eye) : 0;
  const Sampler sampler{facets, volumes.light, lit, space};

  std::vector<std::vector<FarSample>> far(bands.begins.size() - 1);
  ScratchShelf<Band> shelf;
  pool.for_each(static_cast<int>(far.size()), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    const int y_begin = number * kBandRows;
    const MaskRows rows{seen, mask, bit, y_begin, std::min(y_begin + kBandRows, view.height)};
    Band band = shelf.take();
    if (find_samples(sampler, rows, view, space, band, far[i])) {
      BandCounter<kCount> counter{view, space, faces, y_begin, pool.isa(), band};
      for (std::size_t k = bands.begins[i]; k < bands.begins[i + 1]; ++k) {
        counter.count(faces.faces[bands.faces[k]]);
      }
      set_mask(rows, view.width, of_eye, band);
    }
    shelf.put_back(std::move(band));
  });
  return draw_far_samples(facets, joined, volumes, bit, far, mask, pool);
}

}  // namespace

std::size_t draw_volume_mask(const Facets& facets, const JoinedFacets& joined,
                             ShadowVolumes& volumes, std::span<const LitSide> lit, std::uint8_t bit,
                             std::span<const SeenFacet> seen, const ShadowView& view,
                             glm::dvec3 eye, VolumeCount count, std::span<std::uint8_t> mask,
                             ThreadPool& pool) {
  const auto draw = count == VolumeCount::z_fail ? draw_counted<VolumeCount::z_fail>
                                                 : draw_counted<VolumeCount::z_pass>;
  return draw(facets, joined, volumes, lit, bit, seen, view, eye, mask, pool);
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
