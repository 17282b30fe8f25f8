// softfocus relief turn: an object as a relief impostor through a full turn of the camera, beside
// the same frames redrawn.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "dof/measure/measures.h"
#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surfaces/surface_stages.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {
namespace {

/// Of the bound on the error, each way.
constexpr int kBoundRegions = 16;

template <class Work>
double milliseconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

struct TurnSums {
  std::vector<double> redrawn_ms, impostor_ms, renew_ms, recall_ms, warp_ms, sprite_ms;
  std::vector<double> flip, object_flip, outline_px;
  double most_outline_px = 0.0;
  std::size_t lost = 0, gained = 0, seen = 0;  ///< pixels, of measured frames
  std::vector<double> predicted, bound;        ///< times the measured error
  std::size_t most_bytes = 0;
};

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

/// The redrawn frame, and the impostor to its right.
void write_pair(const std::string& name, const Image& redrawn, const Image& shown,
                FileFormat format) {
  Image pair = make_image(Format::rgba16f, 2 * redrawn.width, redrawn.height);
  for (int y = 0; y < pair.height; ++y) {
    std::uint16_t* to = row<std::uint16_t>(pair, y).data();
    const auto left = row<std::uint16_t>(redrawn, y), right = row<std::uint16_t>(shown, y);
    std::copy(left.begin(), left.end(), to);
    std::copy(right.begin(), right.end(), to + left.size());
  }
  WholeFile file{name};
  file.write(encode(pair, format));
  file.commit();
}

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

}  // namespace

int turn_impostor(const ReliefOptions& options) {
  std::optional<NumberedName> name;
  FileFormat format = FileFormat::png;
  if (!options.output.empty()) {
    name = numbered_name("-o", options.output);
    const auto by_name = format_by_extension(options.output);
    if (!name || !by_name) {
      throw UsageError("-o '" + options.output +
                       "': a turn has many frames; a name such as turn_%04d.png would be right");
    }
    format = *by_name;
  }
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const int width = options.size.width, height = options.size.height;
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  PreparedScene prepared = prepare_scene(scene, Profile{}, pool);

  // About the object's middle, from the scene's camera on.
  Camera camera = scene.camera;
  const glm::dvec3 arm = camera.position - camera.target;
  const double zoomed = 1.0 / options.zoom;
  camera.target = maker.middle;
  camera.position = maker.middle + arm * zoomed;
  const double distance = std::sqrt(dot(arm, arm)) * zoomed;
  if (distance <= 1.2 * maker.radius_m) {
    throw UsageError("--zoom: the eye would come into the object's box; a smaller one is right");
  }
  camera.near_m = (distance - maker.radius_m) * 0.5;
  camera.far_m = distance * 10.0;
  camera.orbit_degrees_per_frame = 360.0 / options.frames;

  const ImpostorSettings settings{.warp = warp_rule(options),
                                  .depth_bits = options.depth_bits,
                                  .tolerance_texels = options.tolerance,
                                  .regions = options.regions,
                                  .texels_per_pixel = options.texels_per_pixel,
                                  .sprites = !options.no_sprites,
                                  .cache_bytes = static_cast<std::size_t>(options.cache_mb * 1e6)};
  const glm::vec4 background = clear_colour(scene);
  const glm::vec4 clear{glm::vec3{background}, alpha_depth(static_cast<float>(camera.far_m))};
  const std::uint16_t background_depth = float_to_half(clear.w, HalfRounding::nearest_even);
  Image redrawn = make_image(Format::rgba16f, width, height);
  Image shown = make_image(Format::rgba16f, width, height);
  clear_image(shown, clear, Profile{});
  const Image blank = shown;  // its rows are all the same
  prepared.depth = make_image(Format::r32f, width, height);
  Impostor impostor;
  std::optional<CriticalRegions> bounds;
  std::optional<CriticalPoint> point;
  TurnSums sums;
  for (int frame = 0; frame < options.turns * options.frames; ++frame) {
    const CameraMatrices matrices = camera_matrices(camera, frame, width, height);
    const auto redraw = [&] {
      RenderPass& pass = prepared.pass;
      pass.targets.colour[0] = &redrawn;
      pass.targets.depth = &prepared.depth;
      record_scene(prepared, matrices, options.frame, pass);
      pass.clear_colour = clear;
      finish(pass, pool);
    };
    if (frame == 0) redraw();  // warms up
    sums.redrawn_ms.push_back(milliseconds_of(redraw));
    ImpostorStep step{};
    sums.impostor_ms.push_back(milliseconds_of([&] {
      pool.for_each((height + 15) / 16, [&](int band) {
        for (int y = 16 * band; y < std::min(16 * band + 16, height); ++y) {
          // One row stays in the cache; reading them all took more time than the warp.
          const auto from = row<std::uint16_t>(blank, 0);
          std::copy(from.begin(), from.end(), row<std::uint16_t>(shown, y).begin());
        }
      });
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
    measure_frame(redrawn, shown, background_depth, pool, sums);
    if (name) write_pair(name_at(*name, frame), redrawn, shown, format);
  }
  print_sums(scene, options, sums);
  return kDone;
}

}  // namespace softfocus
