// softfocus relief bench: each resampling's time beside Clua's (2004).

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/relief/warp/march_relief.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/timing.h"
#include "tools/files/findings.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
int bench_relief(const ReliefOptions& options) {
  const ReliefTexture relief = read_relief_file(options.input);
  const ReliefExtent extent = *relief_extent(relief);
  const auto [width, height] = options.size;
  const CameraMatrices camera = camera_matrices(camera_before(relief, options), 0.0, width, height);
  const std::optional<PlaneRectangle> place = warped_extent(relief, extent, camera.eye);
  if (!place) {
    throw UsageError(
        "--yaw, --pitch and --distance: from there the relief is not seen from its "
        "front, or stretched without bounds; smaller angles or a larger distance would be right");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa}, one{1, options.pool.isa};
  WarpedRelief warped;
  const double texels = static_cast<double>(relief.width) * relief.height;
  Findings found{options.json};
  found.add({{"texels", size_text({relief.width, relief.height})},
             {"filled_texels", extent.filled},
             {"warped_to", size_text({place->width, place->height})},
             {"threads", pool.threads()},
             {"isa", isa_name(pool.isa())}});
  found.begin_table("resamplings", {{"name", 16},
                                    {"one_thread_ms", 13, 3},
                                    {"one_thread_least_ms", 19, 3},
                                    {"ms", 9, 3},
                                    {"least_ms", 9, 3},
                                    {"fixed_ms", 9, 3},
                                    {"fixed_least_ms", 14, 3},
                                    {"megatexels_a_second", 19},
                                    {"ms_in_2004", 10, 1},
                                    {"ratio", 6},
                                    {"overlaps", 9},
                                    {"stretched", 9}});
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
    const Spread by_one = spread_of(times[0].ms), by_all = spread_of(times[1].ms),
                 fixed = spread_of(times[2].ms);
    found.add_row({{"name", choice.name},
                   {"one_thread_ms", by_one.median},
                   {"one_thread_least_ms", by_one.min},
                   {"ms", by_all.median},
                   {"least_ms", by_all.min},
                   {"fixed_ms", fixed.median},
                   {"fixed_least_ms", fixed.min},
                   {"megatexels_a_second", texels / by_all.median / 1e3},
                   {"ms_in_2004", choice.source_ms},
                   {"ratio", choice.source_ms / by_all.median},
                   {"overlaps", counts.overlaps},
                   {"stretched", counts.stretched}});
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
        const auto from = row<std::uint16_t>(blank, 0);
        std::copy(from.begin(), from.end(), row<std::uint16_t>(picture, y).begin());
      });
      map_relief(warped, mapping, picture, threads);
    };
  };
  std::vector<Milliseconds> times{{"mapping, 1 thread"}, {"mapping, all threads"}};
  time_in_turn(times, options.runs, map_by(one), map_by(pool));
  found.add_times(times);

  // 8 to 128 slices: frames a second of Clua, table 6.1.
  constexpr std::array kSlices{std::pair{8, 17.0}, std::pair{16, 7.0}, std::pair{32, 3.0},
                               std::pair{64, 1.0}, std::pair{128, 0.4}};
  const MarchMapping march = march_mapping(relief, extent, camera, width, height);
  found.begin_table(
      "slices",
      {{"slices", 6}, {"ms", 9, 2}, {"bisected_ms", 11, 2}, {"frames_a_second_in_2004", 23, 1}});
  for (const std::pair<int, double>& of : kSlices) {
    std::vector<Milliseconds> marched{{"slices"}, {"bisected"}};
    const auto by = [&](int bisections) {
      return [&, bisections] {
        std::copy(blank.bytes.begin(), blank.bytes.end(), picture.bytes.begin());
        march_relief(relief, march, {of.first, bisections}, picture, pool);
      };
    };
    time_in_turn(marched, std::min(options.runs, 10), by(0), by(6));
    found.add_row({{"slices", of.first},
                   {"ms", spread_of(marched[0].ms).median},
                   {"bisected_ms", spread_of(marched[1].ms).median},
                   {"frames_a_second_in_2004", of.second}});
  }
  found.finish();
  return kDone;
}

}  // namespace softfocus
