#include "tools/relief/turn_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "dof/measure/measures.h"
#include "dof/measure/outline.h"
#include "raster/numbers/vector_math.h"
#include "scenes/surfaces/surface_stages.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"

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

Camera turn_camera(const Scene& scene, const ReliefMaker& maker, const ReliefOptions& options) {
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
  camera.far_m = distance * 10.0 * std::fmax(options.approach, 1.0);
  camera.orbit_degrees_per_frame = options.approach > 0.0 ? 0.0 : 360.0 / options.frames;
  return camera;
}

glm::vec4 turn_background(const Scene& scene, const Camera& camera) {
  const glm::vec4 background = clear_colour(scene);
  return {glm::vec3{background}, alpha_depth(static_cast<float>(camera.far_m))};
}

void redraw_turned(PreparedScene& prepared, const CameraMatrices& camera,
                   const ReliefOptions& options, std::span<const Light> lights, glm::vec4 clear,
                   Image& picture, ThreadPool& pool) {
  RenderPass& pass = prepared.pass;
  pass.targets.colour[0] = &picture;
  pass.targets.depth = &prepared.depth;
  record_scene(prepared, camera, options.frame, pass, lights);
  pass.clear_colour = clear;
  finish(pass, pool);
}

void clear_area(const Image& blank, const Rectangle& area, Image& to, ThreadPool& pool) {
  constexpr int kRows = 16;
  const int rows = area.y_end - area.y_begin;
  const std::uint16_t* texels = row<std::uint16_t>(blank, 0).data() + 4 * area.x_begin;
  pool.for_each((rows + kRows - 1) / kRows, [&](int band) {
    const int begin = area.y_begin + kRows * band;
    for (int y = begin; y < std::min(begin + kRows, area.y_end); ++y) {
      std::copy_n(texels, 4 * (area.x_end - area.x_begin),
                  row<std::uint16_t>(to, y).data() + 4 * area.x_begin);
    }
  });
}

void measure_frame(const Image& redrawn, const Image& shown, std::uint16_t background_depth,
                   ThreadPool& pool, TurnErrors& errors) {
  const std::vector<std::uint8_t> drawn = coverage_of(redrawn, background_depth);
  const OutlineError outline =
      outline_error(drawn, coverage_of(shown, background_depth), redrawn.width, redrawn.height);
  errors.outline_px.push_back(outline.mean_px);
  errors.most_outline_px = std::fmax(errors.most_outline_px, outline.most_px);
  errors.lost += outline.lost;
  errors.gained += outline.gained;
  errors.seen += outline.seen;
  const MeasuredPictures measured = measure_pictures(redrawn, shown, nullptr, {}, pool);
  errors.flip.push_back(measured.whole.flip);
  // All of FLIP lies on the object and around it.
  const auto pixels = static_cast<double>(drawn.size());
  errors.object_flip.push_back(
      outline.seen == 0 ? 0.0 : measured.whole.flip * pixels / static_cast<double>(outline.seen));
}

void print_errors(const TurnErrors& errors) {
  std::printf(
      "FLIP %.4f (to %.4f), of the object's pixels %.4f; outline %.3f px (to %.3f), at most "
      "%.1f px\n",
      mean_of(errors.flip), sorted_at(errors.flip, 1.0), mean_of(errors.object_flip),
      mean_of(errors.outline_px), sorted_at(errors.outline_px, 1.0), errors.most_outline_px);
  std::printf("of %zu pixels %zu lost, %zu gained\n", errors.seen, errors.lost, errors.gained);
}

TurnPictures turn_pictures(const ReliefOptions& options) {
  TurnPictures pictures;
  if (options.output.empty()) return pictures;
  pictures.name = numbered_name("-o", options.output);
  const auto by_name = format_by_extension(options.output);
  if (!pictures.name || !by_name) {
    throw UsageError("-o '" + options.output +
                     "': a turn has many frames; a name such as turn_%04d.png would be right");
  }
  check_writable(name_at(*pictures.name, 0));
  pictures.format = *by_name;
  return pictures;
}

void write_pair(const TurnPictures& pictures, int frame, const Image& redrawn, const Image& shown) {
  if (!pictures.name) return;
  Image pair = make_image(Format::rgba16f, 2 * redrawn.width, redrawn.height);
  for (int y = 0; y < pair.height; ++y) {
    std::uint16_t* to = row<std::uint16_t>(pair, y).data();
    const auto left = row<std::uint16_t>(redrawn, y), right = row<std::uint16_t>(shown, y);
    std::copy(left.begin(), left.end(), to);
    std::copy(right.begin(), right.end(), to + left.size());
  }
  WholeFile file{name_at(*pictures.name, frame)};
  file.write(encode(pair, pictures.format));
  file.commit();
}

}  // namespace softfocus
