#pragma once
// Measures of `softfocus shadows` beside those of projected shadows and volumes.

#include <utility>

#include "raster/threads/parallel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/scene.h"
#include "scenes/shadows/shadow_truth.h"
#include "tools/cli/option_values.h"
#include "tools/files/findings.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

struct ShadowMeasure {
  const Scene& scene;
  PictureSize size;
  double frame;
  int runs;
  const Driver* versus = nullptr;  ///< draws the same maps
};

/// A scene drawn by itself: its shadows, and time after time the same frame.
struct RepeatedShadows {
  RepeatedShadows(Scene of, const ShadowMeasure& measure, ThreadPool& with,
                  const Profile& profile = {})
      : scene(std::move(of)),
        camera(
            camera_matrices(scene.camera, measure.frame, measure.size.width, measure.size.height)),
        frame(measure.frame),
        picture(make_image(Format::rgba16f, measure.size.width, measure.size.height)),
        pool(with),
        prepared(prepare_scene(scene, profile, with)) {}
  RepeatedShadows(const RepeatedShadows&) = delete;
  RepeatedShadows& operator=(const RepeatedShadows&) = delete;

  /// As if the camera alone had moved.
  void draw() { draw_forgetting(false); }
  void draw_anew() { draw_forgetting(true); }
  void draw_forgetting(bool all) {
    if (prepared.shadows) forget(*prepared.shadows, all);
    draw_scene(prepared, camera, frame, picture, pool);
  }

  /// As if the lights alone had moved, by less than a degree.
  void draw_moved() {
    for (Light& light : scene.lights) {
      glm::vec3& place = light.position_or_direction;
      const float cosine = 0.9999f, sine = 0.01414f;
      place = {cosine * place.x + sine * place.z, place.y, cosine * place.z - sine * place.x};
    }
    draw_scene(prepared, camera, frame, picture, pool);
  }

  SceneShadows& shadows() { return *prepared.shadows; }
  const SceneShadows& shadows() const { return *prepared.shadows; }
  ShadowView view() const {
    return {multiply(camera.eye_to_clip, camera.world_to_eye), picture.width, picture.height, {}};
  }

  Scene scene;
  CameraMatrices camera;
  double frame;
  Image picture;
  ThreadPool& pool;
  PreparedScene prepared;
};

/// Of pixels times lights.
void add_shadow_errors(const ShadowErrors& errors, Findings& found);

// --- shadow maps: what they cost and how wrong they are, beside projected ones, which are right

/// Finds times, each in turn, and the driver's if there is one. All lights have a map. Throws
/// DriverError. With `check` every pixel against a ray.
void measure_maps(const ShadowMeasure& measure, bool check, Findings& found, ThreadPool& pool);

/// Finds a table: time and wrong pixels by size, bias, slope bias, kernel and cascades, one of
/// them at a time changed from the scene's settings.
void find_map_table(const ShadowMeasure& measure, Findings& found, ThreadPool& pool);

// --- soft shadows: each point of a light against rays, and how far few points are from many

/// Finds the time of a frame. With `check`, every pixel's stencil of every point against a ray.
void measure_soft(const ShadowMeasure& measure, bool check, Findings& found, ThreadPool& pool);

/// Finds a table: how far the shares of N points are from those of 1,024 others, by rays; and
/// the time of N points.
void find_soft_table(const ShadowMeasure& measure, Findings& found, ThreadPool& pool);

// --- where light ends on curves of few facets, by each rule of scenes/shadows/terminators.h

/// Finds a table: a sphere, a torus and a teapot of few facets over a floor, and FLIP against the
/// shape of many, by region.
void find_terminator_table(PictureSize size, Findings& found, ThreadPool& pool);

}  // namespace softfocus
