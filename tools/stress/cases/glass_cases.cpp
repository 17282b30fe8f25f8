// Transparent surfaces: each, and what is seen through it, has a circle of its own.

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 12> kPaneRadii{1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48};
constexpr double kPaneOpacity = 0.5;
constexpr double kPaneGrey = 0.4, kDarkField = 0.1, kBrightField = 0.9;
constexpr double kFieldContrast = kBrightField - kDarkField;
constexpr int kFieldPx = 8;

glm::vec3 pane_grey(double value) { return glm::vec3{static_cast<float>(value)}; }

void add_pane(Scene& scene, int size, const PixelBox& box, double depth_m, glm::vec3 colour) {
  add_rectangle(scene, size, box, depth_m, colour);
  scene.materials.back().opacity = static_cast<float>(kPaneOpacity);
}

/// The left half of the picture, and its size beyond the borders.
PixelBox pane_half(int size) { return {-1.0 * size, -1.0 * size, size / 2.0, 2.0 * size}; }

double field_at(int y) { return y / kFieldPx % 2 == 0 ? kDarkField : kBrightField; }

double seen_through(double light, double cover) {
  const double hidden = kPaneOpacity * cover;
  return hidden * kPaneGrey + (1.0 - hidden) * light;
}

/// A blurred pane before sharp stripes, which lie across its outline.
StressTrial make_pane_before(double radius, int size, ThreadPool& pool) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFocusM + 0.001, pane_grey(kDarkField));
  for (int y = kFieldPx; y < size; y += 2 * kFieldPx) {
    add_rectangle(scene, size, {-1.0 * size, 1.0 * y, 2.0 * size, 1.0 * (y + kFieldPx)},
                  kStressFocusM, pane_grey(kBrightField));
  }
  add_pane(scene, size, pane_half(size), kStressNearM, pane_grey(kPaneGrey));
  StressFrame frame = drawn_frame(std::move(scene), radius, radius, size, pool);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        return seen_through(field_at(y), disc_left_of((size / 2.0 - x - 0.5) / radius));
      },
      [](int, int) { return kStressNearM; });
  return single(std::move(frame));
}

/// A sharp pane before a blurred edge, which lies across its outline.
StressTrial make_pane_behind(double radius, int size, ThreadPool& pool) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, pane_grey(kDarkField));
  add_rectangle(scene, size, {-1.0 * size, size / 2.0, 2.0 * size, 2.0 * size}, kStressFarM - 0.001,
                pane_grey(kBrightField));
  add_pane(scene, size, pane_half(size), kStressFocusM, pane_grey(kPaneGrey));
  StressFrame frame = drawn_frame(std::move(scene), 2.0 * radius, radius, size, pool);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        const double cover = disc_left_of((y + 0.5 - size / 2.0) / radius);
        return seen_through(kDarkField + kFieldContrast * cover, x < size / 2 ? 1.0 : 0.0);
      },
      [](int, int) { return kStressFocusM; });
  return single(std::move(frame));
}

/// The circle's width, and two pixels more, about the picture's middle.
PixelRange blurred_range(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  const int reach = static_cast<int>(std::ceil(answer.severity)) + 2;
  return {std::max(size / 2 - reach, 0), std::min(size / 2 + reach, size)};
}

double pane_error(const StressAnswer& answer, PixelRange columns, PixelRange rows) {
  double sum = 0.0;
  for (int y = rows.begin; y < rows.end; ++y) {
    for (int x = columns.begin; x < columns.end; ++x) {
      const double off = light_at(answer.result[0], x, y) - light_at(answer.truth[0], x, y);
      sum += off * off;
    }
  }
  const int pixels = (rows.end - rows.begin) * (columns.end - columns.begin);
  return std::sqrt(sum / pixels) / kFieldContrast;
}

double pane_before_error(const StressAnswer& answer) {
  return pane_error(answer, blurred_range(answer), middle_half(answer.truth[0].height));
}

double pane_behind_error(const StressAnswer& answer) {
  return pane_error(answer, middle_half(answer.truth[0].width), blurred_range(answer));
}

/// A near and a far pane, whose outlines cross, with a sharp board between them and a checkered
/// wall behind.
StressTrial make_panes_crossing(double radius, int size, ThreadPool& pool) {
  const double unit = size / 256.0;
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, pane_grey(1.0),
               add_pattern(scene, "checker", 16, {0.15f, 0.18f, 0.25f}, {0.75f, 0.72f, 0.62f}));
  add_pane(scene, size, {96 * unit, 40 * unit, 230 * unit, 150 * unit}, 3.0, {0.2f, 0.3f, 0.8f});
  add_rectangle(scene, size, {110 * unit, 90 * unit, 190 * unit, 200 * unit}, kStressFocusM,
                {0.8f, 0.6f, 0.2f},
                add_pattern(scene, "checker", 8, {0.2f, 0.2f, 0.2f}, {1.0f, 1.0f, 1.0f}));
  add_pane(scene, size, {30 * unit, 60 * unit, 150 * unit, 210 * unit}, 4.0 / 3.0,
           {0.2f, 0.7f, 0.3f});
  add_pane(scene, size, {60 * unit, 120 * unit, 210 * unit, 170 * unit}, 1.2, {0.8f, 0.3f, 0.2f});
  return single(drawn_frame(std::move(scene), 2.0 * radius, 1.5 * radius, size, pool));
}

double panes_error(const StressAnswer& answer) {
  return answer_flip(answer.truth[0], answer.result[0], answer.pool);
}

constexpr StressParameter kPaneRadius{"radius", "px"};
constexpr std::string_view kPaneUnit = "of the contrast";
constexpr std::string_view kWhyCrossing = "as for crowds of opaque things";
constexpr std::string_view kWhyPane = "about a fifth of what a hard edge has";

constexpr std::array kGlassCases{
    StressCase{"pane-before", "A blurred pane before sharp stripes",
               "The stripes are as sharp through the pane as beside it, and its outline is soft.",
               kPaneRadius, "RMS error", kPaneUnit, 0.05, kWhyPane, kPaneRadii, 16, 0,
               make_pane_before, pane_before_error},
    StressCase{"pane-behind", "A sharp pane before a blurred edge",
               "The edge is as soft through the pane as beside it, and its outline is sharp.",
               kPaneRadius, "RMS error", kPaneUnit, 0.05, kWhyPane, kPaneRadii, 16, 0,
               make_pane_behind, pane_behind_error},
    StressCase{"panes-crossing", "Near and far panes over each other, and a board between",
               "As the lens sees it.", kPaneRadius, "mean FLIP", "0 to 1", 0.1, kWhyCrossing,
               kPaneRadii, 8, 512, make_panes_crossing, panes_error},
};

}  // namespace

std::span<const StressCase> glass_cases() { return kGlassCases; }

}  // namespace softfocus
