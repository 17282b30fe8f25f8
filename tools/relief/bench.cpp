// softfocus relief bench: each resampling's time beside Clua's (2004).

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "raster/images/texel.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/info/time_in_turn.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

double median_of(const Milliseconds& times) { return times.ms[times.ms.size() / 2]; }

}  // namespace

int bench_relief(const ReliefOptions& options) {
  const ReliefTexture relief = read_relief_file(options.input);
  const ReliefExtent extent = *relief_extent(relief);
  const auto [width, height] = options.size;
  const CameraMatrices camera = camera_matrices(camera_before(relief, options), 0.0, width, height);
  const std::optional<PlaneRectangle> place = warped_extent(relief, extent, camera.eye);
  if (!place) {
    throw UsageError(
        "--yaw, --pitch and --distance: from there the relief is not seen from its "
        "front; smaller angles would be right");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa}, one{1, options.pool.isa};
  WarpedRelief warped;
  const double texels = static_cast<double>(relief.width) * relief.height;
  std::printf("%dx%d texels, %lld of them filled, warped to %dx%d; %d threads, %s\n", relief.width,
              relief.height, static_cast<long long>(extent.filled), place->width, place->height,
              pool.threads(), std::string{isa_name(pool.isa())}.c_str());
  std::printf("%-12s %10s %10s %10s %12s %10s %8s %9s %9s\n", "resampling", "1 thread", "all",
              "fixed, all", "Mtexels/s", "2004 ms", "ratio", "overlaps", "stretched");
  for (const NamedResampling& choice : kResamplings) {
    const auto by = [&](ThreadPool& threads, PlaceNumbers numbers) {
      return [&, numbers] {
        warp_relief(relief, extent, camera.eye, *place,
                    {.resampling = choice.resampling, .numbers = numbers}, warped, threads);
      };
    };
    WarpCounts counts;
    warp_relief(relief, extent, camera.eye, *place, {.resampling = choice.resampling}, warped, pool,
                &counts);
    std::vector<Milliseconds> times{{"1 thread"}, {"all"}, {"fixed"}};
    time_in_turn(times, options.runs, by(one, PlaceNumbers::floats), by(pool, PlaceNumbers::floats),
                 by(pool, PlaceNumbers::fixed));
    for (Milliseconds& of : times) std::sort(of.ms.begin(), of.ms.end());
    const double all_ms = median_of(times[1]);
    std::printf("%-12s %10.3f %10.3f %10.3f %12.0f %10.1f %8.0f %9lld %9lld\n",
                std::string{choice.name}.c_str(), median_of(times[0]), all_ms, median_of(times[2]),
                texels / all_ms / 1e3, choice.source_ms, choice.source_ms / all_ms,
                static_cast<long long>(counts.overlaps), static_cast<long long>(counts.stretched));
  }
  Image picture = make_image(Format::rgba16f, width, height);
  clear_image(picture, {0.0f, 0.0f, 0.0f, 65504.0f}, Profile{});
  const Image blank = picture;
  const PlaneMapping mapping = plane_mapping(relief, camera, *place, width, height);
  const auto map_by = [&](ThreadPool& threads) {
    return [&] {
      // Or the second run's depths would be no nearer than the first's.
      threads.for_each(mapping.area.y_end - mapping.area.y_begin, [&](int i) {
        const int y = mapping.area.y_begin + i;
        const auto from = row<std::uint16_t>(blank, y);
        std::copy(from.begin(), from.end(), row<std::uint16_t>(picture, y).begin());
      });
      map_relief(warped, mapping, picture, threads);
    };
  };
  std::vector<Milliseconds> times{{"mapping, 1 thread"}, {"mapping, all threads"}};
  time_in_turn(times, options.runs, map_by(one), map_by(pool));
  print_times(times);
  return kDone;
}

}  // namespace softfocus
