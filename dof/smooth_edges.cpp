#include "dof/smooth_edges.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <utility>

#include "raster/numbers/half.h"
#include "raster/pipeline/multisample.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

glm::vec4 texel_of(std::span<const std::uint16_t> row, int x) {
  const std::uint16_t* v = &row[4 * static_cast<std::size_t>(x)];
  return {half_to_float(v[0]), half_to_float(v[1]), half_to_float(v[2]), half_to_float(v[3])};
}

float depth_of(std::span<const std::uint16_t> row, int x) {
  return half_to_float(row[4 * static_cast<std::size_t>(x) + 3]);
}

// A pixel and its neighbours, the nearest first.
struct Neighbour {
  int dx, dy;
};
constexpr std::array<Neighbour, 9> kAround{
    {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
// Where rings of equal distance end.
constexpr std::array<std::size_t, 3> kRingEnds{1, 5, 9};

/// Depths as 1 / z, in which circles of confusion are linear. A surface's pixels are on its side of
/// the middle between the two.
struct Side {
  float surface;
  float border;
  bool is_both = false;  ///< surfaces of one depth have no sides

  bool has(float inverse_depth) const {
    if (is_both) return true;
    return surface > border ? inverse_depth > border : inverse_depth <= border;
  }
};

struct Sides {
  Side shown, other;
};

Sides sides_of(float shown_m, float other_m) {
  const float shown = 1.0f / shown_m, other = 1.0f / other_m;
  const float border = 0.5f * (shown + other);
  const bool is_both = is_one_surface(shown_m, other_m);
  return {{shown, border, is_both}, {other, border, is_both}};
}

// The rows of a picture about one.
std::array<std::span<const std::uint16_t>, 3> rows_about(const ConstImageView& picture, int y) {
  const auto at = [&](int row_y) {
    return row<std::uint16_t>(picture, std::clamp(row_y, 0, picture.height - 1));
  };
  return {at(y - 1), at(y), at(y + 1)};
}

constexpr int kRowsAtOnce = 8;  // that a thread takes

bool same_texel(std::span<const std::uint16_t> a, std::span<const std::uint16_t> b, int x) {
  const std::size_t at = 4 * static_cast<std::size_t>(x);
  return std::equal(a.begin() + static_cast<std::ptrdiff_t>(at),
                    a.begin() + static_cast<std::ptrdiff_t>(at + 4),
                    b.begin() + static_cast<std::ptrdiff_t>(at));
}

// The neighbour that shows a surface: of the nearest ring that has one, that of the nearest depth.
std::optional<Neighbour> find_shown(const std::array<std::span<const std::uint16_t>, 3>& scene,
                                    int x, const Side& side) {
  const auto width = static_cast<int>(scene[1].size() / 4);
  std::size_t begin = 0;
  for (const std::size_t end : kRingEnds) {
    std::optional<Neighbour> found;
    float least = 0.0f;
    for (std::size_t i = begin; i < end; ++i) {
      const int column = x + kAround[i].dx;
      if (column < 0 || column >= width) continue;
      const auto row = static_cast<std::size_t>(1 + kAround[i].dy);
      const float inverse = 1.0f / depth_of(scene[row], column);
      if (!side.has(inverse)) continue;
      const float away = std::fabs(inverse - side.surface);
      if (found && !(away < least)) continue;
      found = kAround[i];
      least = away;
    }
    if (found) return found;
    begin = end;
  }
  return {};
}

// NaN of a depth of infinity.
float blur_px(const DofSettings& settings, float depth_m) {
  return std::min(std::fabs(coc_radius_px(settings.coc, depth_m)), settings.max_coc_px);
}

// How far a surface is in focus: 1 without a circle, 0 from a radius of a pixel on.
float sharpness(const DofSettings& settings, float depth_m) {
  const float radius = blur_px(settings, depth_m);
  return radius < 1.0f ? 1.0f - radius : 0.0f;
}

// How far the filter left a pixel as it was: 1 if it did, 0 from a difference of a tenth on.
float kept(const glm::vec3& before, const glm::vec3& filtered) {
  float most = 0.0f, largest = 0.0f;
  for (int i = 0; i < 3; ++i) {
    most = std::max(most, std::fabs(filtered[i] - before[i]));
    largest = std::max(largest, std::max(std::fabs(before[i]), std::fabs(filtered[i])));
  }
  const float tenth = 0.1f * largest;
  return most < tenth ? 1.0f - most / tenth : largest == 0.0f ? 1.0f : 0.0f;
}

glm::vec3 filtered_surface(const EdgeRows& rows, int x, const glm::vec4& surface, const Side& side,
                           const DofSettings& settings) {
  const Neighbour at = find_shown(rows.scene, x, side).value_or(Neighbour{0, 0});
  const auto row = static_cast<std::size_t>(1 + at.dy);
  const glm::vec3 filtered{texel_of(rows.filtered[row], x + at.dx)};
  const glm::vec3 before{texel_of(rows.scene[row], x + at.dx)};
  // Where something nearer is blurred over the pixel, its own colour shows in part, and the filter
  // alone knows in which.
  const float own = sharpness(settings, surface.w) * kept(before, filtered);
  return own > 0.0f ? filtered + (glm::vec3{surface} - before) * own : filtered;
}

}  // namespace

void show_others(std::span<const int> pixels, std::span<const std::uint16_t> other,
                 std::span<std::uint16_t> scene) {
  for (const int x : pixels) {
    const std::ptrdiff_t at = std::ptrdiff_t{4} * x;
    std::copy_n(other.begin() + at, 4, scene.begin() + at);
  }
}

EdgeDiffusion::EdgeDiffusion(int width)
    : run_before_(static_cast<std::size_t>(width) + 2), run_(run_before_.size()) {}

void EdgeDiffusion::next_row(std::span<const std::uint16_t> scene,
                             std::span<const std::uint16_t> other,
                             std::span<const std::uint8_t> coverage, const DofSettings& settings,
                             std::vector<int>& show_other) {
  std::swap(run_before_, run_);
  std::swap(owed_before_, owed_);
  std::fill(run_.begin(), run_.end(), 0);
  owed_.assign(1, 0);
  constexpr int kMost = 170;  // that is owed: two thirds of a pixel
  for (std::size_t x = 0; x < coverage.size(); ++x) {
    const int part = coverage[x];
    if (part == 0) continue;
    const auto column = static_cast<int>(x);
    const float own_m = depth_of(scene, column), other_m = depth_of(other, column);
    // Surfaces of one depth are blurred alike.
    if (is_one_surface(own_m, other_m) ||
        !(blur_px(settings, std::fmin(own_m, other_m)) >= kDiffusedPx)) {
      continue;
    }
    if (run_[x] == 0) owed_.push_back(0);
    run_[x + 1] = owed_.size() - 1;
    int& owed = owed_.back();
    // What a run above still owes, the first pixel that touches it takes.
    for (std::size_t i = x; i < x + 3; ++i) owed += std::exchange(owed_before_[run_before_[i]], 0);
    const bool is_nearer = own_m <= other_m;
    owed += is_nearer ? -part : part;
    const bool shows_other = is_nearer ? owed < -kMost : owed > kMost;
    if (!shows_other) continue;
    owed += is_nearer ? 255 : -255;
    show_other.push_back(column);
  }
}

DiffusedScene diffused_scene(const DofInput& input, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  DiffusedScene diffused{scene};
  if (input.edges.coverage.texels == nullptr) return diffused;
  // Layers behind and objects' numbers are those of the surfaces that centres show.
  if (!input.behind.empty() || !input.objects.empty()) return diffused;
  EdgeDiffusion diffusion{scene.width};
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(scene.height));
  bool differs = false;
  for (int y = 0; y < scene.height; ++y) {
    std::vector<int>& of_row = rows[static_cast<std::size_t>(y)];
    diffusion.next_row(row<std::uint16_t>(scene, y), row<std::uint16_t>(input.edges.other, y),
                       row<std::uint8_t>(input.edges.coverage, y), input.settings, of_row);
    differs = differs || !of_row.empty();
  }
  if (!differs) return diffused;
  const std::size_t count = 4 * static_cast<std::size_t>(scene.width);
  diffused.memory = make_row_memory<std::uint16_t>(count * static_cast<std::size_t>(scene.height),
                                                   &pool.memory());
  const ImageView copy =
      view_of(Format::rgba16f, reinterpret_cast<std::byte*>(diffused.memory.get()), scene.width,
              scene.height);
  for_each_row(pool, scene.height, kRowsAtOnce, [&](int y) {
    const auto from = row<std::uint16_t>(scene, y);
    const auto to = row<std::uint16_t>(copy, y);
    std::copy(from.begin(), from.end(), to.begin());
    show_others(rows[static_cast<std::size_t>(y)], row<std::uint16_t>(input.edges.other, y), to);
  });
  diffused.scene = copy;
  return diffused;
}

void smooth_row(const EdgeRows& rows, const DofSettings& settings, HalfRounding rounding,
                std::vector<SmoothPixel>& changed) {
  const auto width = static_cast<int>(rows.coverage.size());
  for (int x = 0; x < width; ++x) {
    const std::uint8_t coverage = rows.coverage[static_cast<std::size_t>(x)];
    if (coverage == 0) continue;
    const auto at = static_cast<std::size_t>(x);
    const bool is_diffused = !same_texel(rows.scene[1], rows.own, x);
    const glm::vec4 shown = texel_of(rows.scene[1], x);
    const glm::vec4 other = texel_of(is_diffused ? rows.own : rows.other, x);
    const Sides sides = sides_of(shown.w, other.w);
    const glm::vec3 a = filtered_surface(rows, x, shown, sides.shown, settings);
    const glm::vec3 b = filtered_surface(rows, x, other, sides.other, settings);
    const float part = static_cast<float>(is_diffused ? 255 - coverage : coverage) / 255.0f;
    const glm::vec3 colour = a * (1.0f - part) + b * part;
    changed.push_back({x,
                       {float_to_half(colour.x, rounding), float_to_half(colour.y, rounding),
                        float_to_half(colour.z, rounding),
                        (is_diffused ? rows.own : rows.filtered[1])[4 * at + 3]}});
  }
}

void take_shown_colours(const ConstImageView& scene, const ConstImageView& coverage,
                        const ImageView& other, ThreadPool& pool) {
  for_each_row(pool, scene.height, kRowsAtOnce, [&](int y) {
    const auto rows = rows_about(scene, y);
    const std::span<const std::uint8_t> covered = row<std::uint8_t>(coverage, y);
    const std::span<std::uint16_t> to = row<std::uint16_t>(other, y);
    for (int x = 0; x < scene.width; ++x) {
      if (covered[static_cast<std::size_t>(x)] == 0) continue;
      const Sides sides = sides_of(depth_of(rows[1], x), depth_of(to, x));
      const Neighbour at = find_shown(rows, x, sides.other).value_or(Neighbour{0, 0});
      const auto from = rows[static_cast<std::size_t>(1 + at.dy)].subspan(
          4 * static_cast<std::size_t>(x + at.dx), 3);
      std::copy(from.begin(), from.end(), to.begin() + std::ptrdiff_t{4} * x);
    }
  });
}

void smooth_edges(const DofInput& input, const ConstImageView& diffused, const ImageView& filtered,
                  ThreadPool& pool) {
  if (input.edges.coverage.texels == nullptr) return;
  const int height = filtered.height;
  std::vector<std::vector<SmoothPixel>> changed(static_cast<std::size_t>(height));
  const ConstImageView before = filtered;
  for_each_row(pool, height, kRowsAtOnce, [&](int y) {
    const EdgeRows rows{.scene = rows_about(diffused, y),
                        .own = row<std::uint16_t>(input.scene, y),
                        .filtered = rows_about(before, y),
                        .other = row<std::uint16_t>(input.edges.other, y),
                        .coverage = row<std::uint8_t>(input.edges.coverage, y)};
    smooth_row(rows, input.settings, input.profile.half_store,
               changed[static_cast<std::size_t>(y)]);
  });
  for_each_row(pool, height, kRowsAtOnce, [&](int y) {
    const std::span<std::uint16_t> to = row<std::uint16_t>(filtered, y);
    for (const SmoothPixel& pixel : changed[static_cast<std::size_t>(y)]) {
      std::copy(pixel.texel.begin(), pixel.texel.end(),
                to.begin() + 4 * static_cast<std::ptrdiff_t>(pixel.x));
    }
  });
}

}  // namespace softfocus
