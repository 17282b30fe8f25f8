#include "tools/relief/turn_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "dof/measure/measures.h"
#include "raster/images/texel.h"

namespace softfocus {

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double sorted_at(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

namespace {

/// Which pixels show the object: those that are nearer than the background.
std::vector<std::uint8_t> coverage_of(const Image& picture, std::uint16_t background_depth) {
  std::vector<std::uint8_t> covered;
  for (int y = 0; y < picture.height; ++y) {
    const std::uint16_t* texels = row<std::uint16_t>(picture, y).data();
    for (int x = 0; x < picture.width; ++x) {
      covered.push_back(texels[4 * x + 3] != background_depth ? 1 : 0);
    }
  }
  return covered;
}

/// How far two coverages' outlines lie apart: wrong pixels a pixel of outline, and how deep the
/// deepest lies.
struct OutlineError {
  double mean_px = 0.0, most_px = 0.0;
  std::size_t lost = 0, gained = 0, seen = 0;
};

OutlineError outline_error(const std::vector<std::uint8_t>& drawn,
                           const std::vector<std::uint8_t>& shown, int width, int height) {
  const auto at = [&](const std::vector<std::uint8_t>& of, int x, int y) {
    if (x < 0 || y < 0 || x >= width || y >= height) return 0;
    return static_cast<int>(of[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x)]);
  };
  OutlineError error;
  std::size_t outline = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int is = at(drawn, x, y), looks = at(shown, x, y);
      error.seen += static_cast<std::size_t>(is);
      if (is == 1 && (at(drawn, x - 1, y) + at(drawn, x + 1, y) + at(drawn, x, y - 1) +
                      at(drawn, x, y + 1)) < 4) {
        ++outline;
      }
      if (is == looks) continue;
      ++(is == 1 ? error.lost : error.gained);
      // The nearest pixel that is drawn as this one is shown; the outline runs half a pixel before.
      constexpr int kFarthest = 32;
      double nearest = kFarthest;
      for (int r = 1; r < kFarthest && nearest > r; ++r) {
        for (int i = -r; i <= r; ++i) {
          const std::array<std::array<int, 2>, 4> ring{
              {{x + i, y - r}, {x + i, y + r}, {x - r, y + i}, {x + r, y + i}}};
          for (const std::array<int, 2>& place : ring) {
            if (at(drawn, place[0], place[1]) != looks) continue;
            const double dx = place[0] - x, dy = place[1] - y;
            nearest = std::fmin(nearest, std::sqrt(dx * dx + dy * dy));
          }
        }
      }
      error.most_px = std::fmax(error.most_px, nearest - 0.5);
    }
  }
  if (outline > 0) {
    error.mean_px = static_cast<double>(error.lost + error.gained) / static_cast<double>(outline);
  }
  return error;
}

}  // namespace

void add_frame(const ScheduledFrame& frame, double ms, TurnSums& sums) {
  sums.impostor_ms.push_back(ms);
  (frame.step == ImpostorStep::renew    ? sums.renew_ms
   : frame.step == ImpostorStep::recall ? sums.recall_ms
   : frame.step == ImpostorStep::warp   ? sums.warp_ms
                                        : sums.sprite_ms)
      .push_back(ms);
  sums.renewals += frame.renewals;
  sums.updates += frame.takes ? 1 : 0;
  sums.stalls += frame.stalls ? 1 : 0;
  sums.stale += frame.is_stale ? 1 : 0;
  sums.late_frames.push_back(frame.late_frames);
}

void measure_frame(const Image& redrawn, const Image& shown, std::uint16_t background_depth,
                   ThreadPool& pool, TurnSums& sums) {
  const std::vector<std::uint8_t> drawn = coverage_of(redrawn, background_depth);
  const OutlineError outline =
      outline_error(drawn, coverage_of(shown, background_depth), redrawn.width, redrawn.height);
  sums.outline_px.push_back(outline.mean_px);
  sums.most_outline_px = std::fmax(sums.most_outline_px, outline.most_px);
  sums.lost += outline.lost;
  sums.gained += outline.gained;
  sums.seen += outline.seen;
  const MeasuredPictures measured = measure_pictures(redrawn, shown, nullptr, {}, pool);
  sums.flip.push_back(measured.whole.flip);
  // All of FLIP lies on the object and around it.
  const auto pixels = static_cast<double>(drawn.size());
  sums.object_flip.push_back(
      outline.seen == 0 ? 0.0 : measured.whole.flip * pixels / static_cast<double>(outline.seen));
}

void print_sums(const Scene& scene, const ReliefOptions& options, const TurnSums& sums) {
  std::printf("%s: %zu triangles, %d frames of %dx%d, tolerance %g texels\n", scene.name.c_str(),
              triangle_count(scene), options.frames, options.size.width, options.size.height,
              options.tolerance);
  std::printf(
      "renewals %d, recalls %zu, warps %zu, sprites %zu; reliefs and warp at most %.2f MB\n",
      sums.renewals, sums.recall_ms.size(), sums.warp_ms.size(), sums.sprite_ms.size(),
      static_cast<double>(sums.most_bytes) / 1e6);
  const double redrawn = mean_of(sums.redrawn_ms), impostor = mean_of(sums.impostor_ms);
  std::printf(
      "ms a frame: redrawn %.3f, impostor %.3f, ratio %.2f; medians: redrawn %.3f, renew "
      "%.3f, warp %.3f, sprite %.3f\n",
      redrawn, impostor, redrawn / impostor, sorted_at(sums.redrawn_ms, 0.5),
      sorted_at(sums.renew_ms, 0.5), sorted_at(sums.warp_ms, 0.5), sorted_at(sums.sprite_ms, 0.5));
  // The first frame has nothing to show before it has drawn.
  const std::vector<double> after_first(sums.impostor_ms.begin() + 1, sums.impostor_ms.end());
  std::printf(
      "frames a second %.1f, worst frame after the first %.2f ms, 99 of 100 below %.2f; worst "
      "redrawn %.2f\n",
      1e3 / impostor, sorted_at(after_first, 1.0), sorted_at(after_first, 0.99),
      sorted_at(sums.redrawn_ms, 1.0));
  std::printf("updates a second %.1f; late frames %.2f (to %.0f), stale %d, stalls %d of %zu\n",
              1e3 * sums.updates / (impostor * static_cast<double>(sums.impostor_ms.size())),
              mean_of(sums.late_frames), sorted_at(sums.late_frames, 1.0), sums.stale, sums.stalls,
              sums.impostor_ms.size());
  std::printf(
      "FLIP %.4f (to %.4f), of the object's pixels %.4f; outline %.3f px (to %.3f), at most "
      "%.1f px\n",
      mean_of(sums.flip), sorted_at(sums.flip, 1.0), mean_of(sums.object_flip),
      mean_of(sums.outline_px), sorted_at(sums.outline_px, 1.0), sums.most_outline_px);
  std::printf("of %zu pixels %zu lost, %zu gained\n", sums.seen, sums.lost, sums.gained);
  std::printf(
      "error at the critical point / largest error: %.2f to %.2f, median %.2f; bound / "
      "largest error: %.2f to %.2f, median %.2f\n",
      sorted_at(sums.predicted, 0.0), sorted_at(sums.predicted, 1.0),
      sorted_at(sums.predicted, 0.5), sorted_at(sums.bound, 0.0), sorted_at(sums.bound, 1.0),
      sorted_at(sums.bound, 0.5));
}

}  // namespace softfocus
