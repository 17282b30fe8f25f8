#pragma once
// The work that `bench` times: a frame, and all that it needs, made beforehand.

#include <cstddef>
#include <optional>
#include <string>

#include "dof/dof.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"
#include "tools/bench/options.h"

namespace softfocus {

struct BenchWork {
  std::string name;            ///< of the scene; "spheres" and "picture" for those made here
  std::optional<Scene> scene;  ///< none: `picture` is filtered
  Image picture;
  CameraMatrices view{};
  double frame = 0.0;
  PictureSize size;
  MethodChoice method;
  DofSettings settings;                    ///< of auto without max_coc_px
  std::optional<float> largest_radius_px;  ///< as given: what auto must keep to
  Sampling sampling;
  AutoGoal goal;
  Verify verify = Verify::in_doubt;
  bool copies = false;   ///< a frame is timed with copies of its pictures too
  double focus_m = 0.0;  ///< with the aperture, for methods that draw the scene
  double aperture_radius_m = 0.0;
  Profile profile;
  std::string profile_name;
};

/// Loads or makes the work. Throws UsageError for an impossible lens, SceneError for a scene.
BenchWork make_work(const BenchOptions& options);

}  // namespace softfocus
