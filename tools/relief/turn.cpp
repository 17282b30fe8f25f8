// softfocus relief turn: an object as a relief impostor through a full turn of the camera, beside
// the same frames redrawn.

#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "tools/cli/commands.h"
#include "tools/relief/turn_frames.h"

namespace softfocus {
namespace {

/// Of the bound on the error, each way.
constexpr int kBoundRegions = 16;

struct TurnSums {
  std::vector<double> redrawn_ms, impostor_ms, renew_ms, recall_ms, warp_ms, sprite_ms;
  TurnErrors errors;
  std::vector<double> predicted, bound;  ///< times the measured error
  std::size_t most_bytes = 0;
};

void print_sums(const Scene& scene, const ReliefOptions& options, const TurnSums& sums) {
  std::printf("%s: %zu triangles, %d frames of %dx%d, tolerance %g texels\n", scene.name.c_str(),
              triangle_count(scene), options.frames, options.size.width, options.size.height,
              options.tolerance);
  std::printf(
      "renewals %zu, recalls %zu, warps %zu, sprites %zu; reliefs and warp at most %.2f MB\n",
      sums.renew_ms.size(), sums.recall_ms.size(), sums.warp_ms.size(), sums.sprite_ms.size(),
      static_cast<double>(sums.most_bytes) / 1e6);
  const double redrawn = mean_of(sums.redrawn_ms), impostor = mean_of(sums.impostor_ms);
  std::printf(
      "ms a frame: redrawn %.3f, impostor %.3f, ratio %.2f; medians: redrawn %.3f, renew "
      "%.3f, warp %.3f, sprite %.3f\n",
      redrawn, impostor, redrawn / impostor, sorted_at(sums.redrawn_ms, 0.5),
      sorted_at(sums.renew_ms, 0.5), sorted_at(sums.warp_ms, 0.5), sorted_at(sums.sprite_ms, 0.5));
  print_errors(sums.errors);
  std::printf(
      "error at the critical point / largest error: %.2f to %.2f, median %.2f; bound / "
      "largest error: %.2f to %.2f, median %.2f\n",
      sorted_at(sums.predicted, 0.0), sorted_at(sums.predicted, 1.0),
      sorted_at(sums.predicted, 0.5), sorted_at(sums.bound, 0.0), sorted_at(sums.bound, 1.0),
      sorted_at(sums.bound, 0.5));
}

}  // namespace

int turn_impostor(const ReliefOptions& options) {
  if (options.rival) return turn_octahedral(options);
  const TurnPictures pictures = turn_pictures(options);
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const int width = options.size.width, height = options.size.height;
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);

  const Camera camera = turn_camera(scene, maker, options);
  const ImpostorSettings settings{.warp = warp_rule(options),
                                  .depth_bits = options.depth_bits,
                                  .tolerance_texels = options.tolerance,
                                  .regions = options.regions,
                                  .texels_per_pixel = options.texels_per_pixel,
                                  .sprites = !options.no_sprites,
                                  .cache_bytes = static_cast<std::size_t>(options.cache_mb * 1e6)};
  const glm::vec4 clear = turn_background(scene, camera);
  const std::uint16_t background_depth = float_to_half(clear.w, HalfRounding::nearest_even);
  Image redrawn = make_image(Format::rgba16f, width, height);
  Image shown = make_image(Format::rgba16f, width, height);
  clear_image(shown, clear, Profile{});
  const Image blank = shown;
  prepared.depth = make_image(Format::r32f, width, height);
  Impostor impostor;
  std::optional<CriticalRegions> bounds;
  std::optional<CriticalPoint> point;
  TurnSums sums;
  for (int frame = 0; frame < options.turns * options.frames; ++frame) {
    const CameraMatrices matrices = camera_matrices(camera, frame, width, height);
    const auto redraw = [&] { redraw_turned(prepared, matrices, options, clear, redrawn, pool); };
    if (frame == 0) redraw();  // warms up
    sums.redrawn_ms.push_back(milliseconds_of(redraw));
    ImpostorStep step{};
    sums.impostor_ms.push_back(milliseconds_of([&] {
      copy_rows(blank, shown, pool);
      step = update_impostor(impostor, maker, settings, matrices, camera.up, height, pool);
      draw_impostor(impostor, matrices, shown, pool);
    }));
    (step == ImpostorStep::renew    ? sums.renew_ms
     : step == ImpostorStep::recall ? sums.recall_ms
     : step == ImpostorStep::warp   ? sums.warp_ms
                                    : sums.sprite_ms)
        .push_back(sums.impostor_ms.back());
    std::size_t bytes = impostor.warped.colours.size() * (4 + 4);
    if (impostor.drawn) bytes += bytes_of(*impostor.drawn);
    for (const DrawnRelief& kept : impostor.cache) bytes += bytes_of(kept);
    sums.most_bytes = std::max(sums.most_bytes, bytes);
    if (impostor.drawn) {
      const ReliefTexture& relief = impostor.drawn->texture;
      if (!bounds || step == ImpostorStep::renew || step == ImpostorStep::recall) {
        bounds = critical_regions(relief, impostor.drawn->extent, kBoundRegions, kBoundRegions);
        point = critical_point(relief);
      }
      if (point) {
        const double largest = largest_error(relief, matrices.eye);
        sums.predicted.push_back(critical_error(relief, *point, matrices.eye) / largest);
        sums.bound.push_back(error_bound(relief, *bounds, matrices.eye) / largest);
      }
    }
    if (frame % options.every != 0) continue;
    measure_frame(redrawn, shown, background_depth, pool, sums.errors);
    write_pair(pictures, frame, redrawn, shown);
  }
  print_sums(scene, options, sums);
  return kDone;
}

}  // namespace softfocus
