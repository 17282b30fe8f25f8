#include "tools/relief/turn_sums.h"

#include <cstdio>

namespace softfocus {

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

void print_sums(const Scene& scene, const ReliefOptions& options, const TurnSums& sums) {
  std::printf("%s: %zu triangles, %zu frames of %dx%d, tolerance %g texels\n", scene.name.c_str(),
              triangle_count(scene), sums.impostor_ms.size(), options.size.width,
              options.size.height, options.tolerance);
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
  print_errors(sums.errors);
  std::printf(
      "error at the critical point / largest error: %.2f to %.2f, median %.2f; bound / "
      "largest error: %.2f to %.2f, median %.2f\n",
      sorted_at(sums.predicted, 0.0), sorted_at(sums.predicted, 1.0),
      sorted_at(sums.predicted, 0.5), sorted_at(sums.bound, 0.0), sorted_at(sums.bound, 1.0),
      sorted_at(sums.bound, 0.5));
}

}  // namespace softfocus
