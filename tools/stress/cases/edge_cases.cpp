// Something sharp beside something blurred: light that leaks, outlines, and what shows through.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dof/unmix_edges.h"
#include "tools/stress/cases/stress_case.h"
#include "tools/stress/cases/stress_measures.h"

namespace softfocus {
namespace {

constexpr std::array<double, 14> kEdgeRadii{1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 40, 48, 64};
constexpr std::array<double, 10> kBarWidths{1, 2, 3, 4, 6, 8, 12, 16, 24, 32};

constexpr float kDark = 0.1f, kBright = 1.0f;
constexpr double kContrast = 0.9;

glm::vec3 grey(double value) { return glm::vec3{static_cast<float>(value)}; }

/// The left half of the picture, and its size beyond the borders.
PixelBox left_half(int size) { return {-1.0 * size, -1.0 * size, size / 2.0, 2.0 * size}; }

/// A sharp half before a blurred wall. Both are of one colour: nothing may change.
StressTrial sharp_before_wall(double radius, int size, ThreadPool& pool, float near, float far) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, grey(far));
  add_rectangle(scene, size, left_half(size), kStressFocusM, grey(near));
  StressFrame frame = drawn_frame(std::move(scene), 2.0 * radius, radius, size, pool);
  frame.truth = frame.sharp;
  return single(std::move(frame));
}

StressTrial make_far_leak(double radius, int size, ThreadPool& pool) {
  return sharp_before_wall(radius, size, pool, kDark, kBright);
}

StressTrial make_near_leak(double radius, int size, ThreadPool& pool) {
  return sharp_before_wall(radius, size, pool, kBright, kDark);
}

double leaked(const StressAnswer& answer, PixelRange columns) {
  const PixelRange rows = middle_half(answer.truth[0].height);
  return largest_difference(column_means(answer.result[0], rows),
                            column_means(answer.truth[0], rows), columns) /
         kContrast;
}

double leaked_on_near(const StressAnswer& answer) {
  return leaked(answer, {0, answer.truth[0].width / 2});
}

double leaked_on_far(const StressAnswer& answer) {
  const int width = answer.truth[0].width;
  return leaked(answer, {width / 2, width - width / 4});
}

/// A blurred bright half before a sharp dark wall.
StressTrial make_near_edge(double radius, int size, ThreadPool& pool) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFocusM, grey(kDark));
  add_rectangle(scene, size, left_half(size), kStressNearM, grey(kBright));
  StressFrame frame = drawn_frame(std::move(scene), radius, radius, size, pool);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int) { return kDark + kContrast * disc_left_of((size / 2.0 - x - 0.5) / radius); },
      [](int, int) { return kStressNearM; });
  return single(std::move(frame));
}

/// Over the circle's width and two pixels more.
double edge_spread_error(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  const int reach = static_cast<int>(std::ceil(answer.severity)) + 2;
  const PixelRange rows = middle_half(size);
  return rms_difference(column_means(answer.result[0], rows), column_means(answer.truth[0], rows),
                        {std::max(size / 2 - reach, 0), std::min(size / 2 + reach, size)}) /
         kContrast;
}

constexpr int kStripePx = 4;
constexpr float kStripeDark = 0.2f, kStripeBright = 0.8f, kBarGrey = 0.5f;

double radius_of_bar(int size) { return size / 16.0; }

float stripe_at(int y) { return y / kStripePx % 2 == 0 ? kStripeDark : kStripeBright; }

/// The part of the lens that a bar from `left` to `right` covers, at a column's middle.
double bar_cover(int x, double left, double right, double radius) {
  return disc_left_of((right - x - 0.5) / radius) - disc_left_of((left - x - 0.5) / radius);
}

PixelRange bar_columns(double width, int size) {
  const int left = size / 2 - static_cast<int>(width) / 2;
  return {left, left + static_cast<int>(width)};
}

/// A blurred bar before sharp stripes, which lie across it.
StressTrial make_partial_occlusion(double width, int size, ThreadPool& pool) {
  const double radius = radius_of_bar(size);
  const auto [left, right] = bar_columns(width, size);
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFocusM + 0.001, grey(kStripeDark));
  for (int y = kStripePx; y < size; y += 2 * kStripePx) {
    add_rectangle(scene, size, {-1.0 * size, 1.0 * y, 2.0 * size, 1.0 * (y + kStripePx)},
                  kStressFocusM, grey(kStripeBright));
  }
  add_rectangle(scene, size, {1.0 * left, -1.0 * size, 1.0 * right, 2.0 * size}, kStressNearM,
                grey(kBarGrey));
  StressFrame frame = drawn_frame(std::move(scene), radius, radius, size, pool);
  const PixelRange bar = bar_columns(width, size);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        const double cover = bar_cover(x, bar.begin, bar.end, radius);
        return cover * kBarGrey + (1.0 - cover) * stripe_at(y);
      },
      [](int, int) { return kStressNearM; });
  return single(std::move(frame));
}

/// Half the difference between bright and dark stripes in each column, over theirs: 1 where all
/// of the background shows.
std::vector<double> stripe_contrasts(const Image& picture) {
  const auto [top, bottom] = middle_half(picture.height);
  std::vector<double> contrasts(static_cast<std::size_t>(picture.width));
  for (int y = top; y < bottom; ++y) {
    const double sign = stripe_at(y) == kStripeBright ? 1.0 : -1.0;
    for (int x = 0; x < picture.width; ++x) {
      contrasts[static_cast<std::size_t>(x)] += sign * light_at(picture, x, y);
    }
  }
  for (double& contrast : contrasts) {
    contrast *= 2.0 / ((bottom - top) * double{kStripeBright - kStripeDark});
  }
  return contrasts;
}

double shown_through_error(const StressAnswer& answer) {
  const auto bar = bar_columns(answer.severity, answer.truth[0].width);
  return rms_difference(stripe_contrasts(answer.result[0]), stripe_contrasts(answer.truth[0]), bar);
}

constexpr int kLampPx = 5;
constexpr double kLampLight = 100.0, kLampGround = 0.05;

/// A far lamp just beside a sharp edge, which cuts its circle in two.
StressTrial make_lamp_at_edge(double radius, int size, ThreadPool& pool) {
  const int left = size / 2, top = size / 2 - kLampPx / 2;
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, grey(kLampGround));
  add_rectangle(scene, size, pixel_square(left, top, kLampPx), kStressFarM - 0.01,
                grey(static_cast<float>(kLampLight)));
  add_rectangle(scene, size, left_half(size), kStressFocusM, grey(kLampGround));
  StressFrame frame = drawn_frame(std::move(scene), 2.0 * radius, radius, size, pool);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        const double light = x < left ? 0.0 : square_light(x, y, left, top, kLampPx, radius);
        return kLampGround + light * (kLampLight - kLampGround);
      },
      [](int, int) { return kStressFarM; });
  return single(std::move(frame));
}

/// All light above the ground's, between two columns.
double lamp_light(const Image& picture, PixelRange columns) {
  double sum = 0.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = columns.begin; x < columns.end; ++x) sum += light_at(picture, x, y) - kLampGround;
  }
  return sum;
}

double lamp_light_on_sharp(const StressAnswer& answer) {
  return std::fabs(lamp_light(answer.result[0], {0, answer.truth[0].width / 2})) /
         (kLampPx * kLampPx * (kLampLight - kLampGround));
}

double lamp_light_lost(const StressAnswer& answer) {
  const PixelRange right{answer.truth[0].width / 2, answer.truth[0].width};
  return std::fabs(lamp_light(answer.result[0], right) / lamp_light(answer.truth[0], right) - 1.0);
}

constexpr int kEdgeSamples = 4;  // of a pixel, where edges are to be smooth

/// The line x = middle + y tan(lean), counted from the picture's middle.
constexpr double kLeanDegrees = 7.0, kLeanSine = 0.12186934340514748,
                 kLeanCosine = 0.992546151641322;

/// How far right of that line a pixel's middle is, square to it.
double from_leaning_line(int size, double x, double y) {
  return (x - size / 2.0) * kLeanCosine - (y - size / 2.0) * kLeanSine;
}

/// Adds a rectangle from `left` to `right` of the line.
void add_leaning(Scene& scene, int size, double left, double right, double depth_m, float colour) {
  // It is turned about its upper left corner, which lies on the line through `left`.
  const double up = size * 1.0;
  const double corner_x = size / 2.0 - up * kLeanSine + left * kLeanCosine;
  const double corner_y = size / 2.0 - up * kLeanCosine - left * kLeanSine;
  add_rectangle(scene, size, {corner_x, corner_y, corner_x + (right - left), corner_y + 2.0 * up},
                depth_m, grey(colour));
  scene.objects.back().rotation_degrees.z = kLeanDegrees;
}

/// The part of a pixel left of the line.
double left_of_line(int size, int x, int y) {
  constexpr int kFine = 16;
  int inside = 0;
  for (int i = 0; i < kFine * kFine; ++i) {
    const int column = i % kFine, row = i / kFine;
    inside += from_leaning_line(size, x + (column + 0.5) / kFine, y + (row + 0.5) / kFine) < 0.0;
  }
  return static_cast<double>(inside) / (kFine * kFine);
}

/// A sharp bright half with a leaning outline before a blurred dark wall.
StressTrial make_smooth_edge(double radius, int size, ThreadPool& pool) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFarM, grey(kDark));
  add_leaning(scene, size, -2.0 * size, 0.0, kStressFocusM, kBright);
  StressFrame frame =
      drawn_frame(std::move(scene), 2.0 * radius, radius, size, pool, kStressFocusM, kEdgeSamples);
  frame.truth = grey_picture_of(
      size, [&](int x, int y) { return kDark + kContrast * left_of_line(size, x, y); },
      [](int, int) { return kStressFocusM; });
  return single(std::move(frame));
}

/// The same as a renderer draws it, and as it is un-mixed: colours are means over a pixel, depths
/// those of its centre.
StressTrial make_render_edge(double radius, int size, ThreadPool& pool) {
  StressTrial trial = make_smooth_edge(radius, size, pool);
  StressFrame& frame = trial.frames[0];
  const Image depths = std::move(frame.sharp);
  frame.sharp = grey_picture_of(
      size, [&](int x, int y) { return kDark + kContrast * left_of_line(size, x, y); },
      [&](int x, int y) { return load_texel(depths, x, y).w; });
  UnmixedEdges edges = unmix_edges(frame.sharp, frame.settings, {}, pool);
  frame.edges = {edges.pixels == 0 ? 1 : kEdgeSamples, std::move(edges.other),
                 std::move(edges.coverage)};
  return trial;
}

/// Of the pixels that the line crosses.
double stairs(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  double sum = 0.0;
  int count = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (std::fabs(from_leaning_line(size, x + 0.5, y + 0.5)) > 0.5) continue;
      const double apart = light_at(answer.result[0], x, y) - light_at(answer.truth[0], x, y);
      sum += apart * apart;
      ++count;
    }
  }
  return std::sqrt(sum / count) / kContrast;
}

constexpr double kStrandPx = 0.5;  // of width

/// A blurred strand, leaning and thinner than a pixel, before a sharp wall.
StressTrial make_strand(double radius, int size, ThreadPool& pool) {
  Scene scene = flat_scene();
  add_backdrop(scene, size, kStressFocusM, grey(kDark));
  add_leaning(scene, size, -0.5 * kStrandPx, 0.5 * kStrandPx, kStressNearM, kBright);
  StressFrame frame =
      drawn_frame(std::move(scene), radius, radius, size, pool, kStressFocusM, kEdgeSamples);
  frame.truth = grey_picture_of(
      size,
      [&](int x, int y) {
        const double from = from_leaning_line(size, x + 0.5, y + 0.5);
        return kDark + kContrast * (disc_left_of((0.5 * kStrandPx - from) / radius) -
                                    disc_left_of((-0.5 * kStrandPx - from) / radius));
      },
      [](int, int) { return kStressNearM; });
  return single(std::move(frame));
}

/// Of the light of as many rows as the circle is wide, wherever they are.
double beads(const StressAnswer& answer) {
  const int size = answer.truth[0].width;
  const auto [top, bottom] = middle_half(size);
  const int height = static_cast<int>(std::ceil(2.0 * answer.severity));
  const auto light = [&](const Image& picture, int y) {
    double sum = 0.0;
    for (int x = 0; x < size; ++x) sum += light_at(picture, x, y) - double{kDark};
    return sum;
  };
  double most = 0.0;
  for (int y = top; y + height <= bottom; ++y) {
    double got = 0.0, wanted = 0.0;
    for (int i = 0; i < height; ++i) {
      got += light(answer.result[0], y + i);
      wanted += light(answer.truth[0], y + i);
    }
    const double error = std::fabs(got / wanted - 1.0);
    if (std::isnan(error)) return error;
    most = std::max(most, error);
  }
  return most;
}

constexpr StressParameter kEdgeRadius{"radius", "px"};
constexpr std::string_view kWeber = "about the least step at an edge that an eye sees";

constexpr std::array kEdgeCases{
    StressCase{"leak-far", "A bright blurred wall behind something sharp and dark",
               "The wall gives no light to the sharp thing.", kEdgeRadius, "largest leak",
               "of the contrast", 0.02, kWeber, kEdgeRadii, 16, 0, make_far_leak, leaked_on_near},
    StressCase{"leak-near", "Something sharp and bright before a dark blurred wall",
               "The sharp thing gives no light to the wall.", kEdgeRadius, "largest leak",
               "of the contrast", 0.02, kWeber, kEdgeRadii, 16, 0, make_near_leak, leaked_on_far},
    StressCase{"near-edge", "The outline of something blurred before something sharp",
               "The outline is as soft outside as inside: the edge-spread function of a disc.",
               kEdgeRadius, "RMS error of the edge-spread function", "of the contrast", 0.05,
               "a fifth of what a hard edge has", kEdgeRadii, 16, 0, make_near_edge,
               edge_spread_error},
    StressCase{"partial-occlusion",
               "A thin blurred bar before sharp stripes",
               "The stripes show through the bar as far as the lens sees past it. The radius is a "
               "16th of the height.",
               {"bar width", "px"},
               "RMS error of the stripes' contrast within the bar",
               "of the stripes' contrast",
               0.1,
               "a tenth of the contrast is still the same pattern",
               kBarWidths,
               8,
               0,
               make_partial_occlusion,
               shown_through_error},
    StressCase{"lamp-edge-leak", "A lamp whose circle a sharp edge hides half of",
               "No light of the lamp falls on the sharp thing.", kEdgeRadius,
               "light on the sharp thing", "of the lamp's light", 0.02, kWeber, kEdgeRadii, 16, 0,
               make_lamp_at_edge, lamp_light_on_sharp},
    StressCase{"lamp-edge-light", "A lamp whose circle a sharp edge hides half of",
               "The visible half of the circle has its light.", kEdgeRadius, "light gained or lost",
               "of the visible light", 0.1, "a seventh of a stop", kEdgeRadii, 16, 0,
               make_lamp_at_edge, lamp_light_lost},
    StressCase{"smooth-edge", "A sharp leaning outline before a blurred wall, 4 samples a pixel",
               "A pixel on the outline has the light of both sides, each by its part.", kEdgeRadius,
               "RMS error on the outline", "of the contrast", 0.1, "stairs have .29", kEdgeRadii, 8,
               0, make_smooth_edge, stairs},
    StressCase{"render-edge", "A renderer's picture of the same, its edges un-mixed",
               "A pixel on the outline keeps its light.", kEdgeRadius, "RMS error on the outline",
               "of the contrast", 0.1, "stairs have .29", kEdgeRadii, 8, 0, make_render_edge,
               stairs},
    StressCase{"strand",
               "A blurred strand, half a pixel wide, before a sharp wall, 4 samples a pixel",
               "The strand has its light all along.", kEdgeRadius,
               "largest error of the light of a circle's width of rows", "of the strand's light",
               0.2, "beads that an eye sees", kEdgeRadii, 8, 0, make_strand, beads},
};

}  // namespace

std::span<const StressCase> edge_cases() { return kEdgeCases; }

}  // namespace softfocus
