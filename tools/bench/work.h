#pragma once
// The work that `bench` times: a frame, and all that it needs, made beforehand.

#include <cstddef>
#include <optional>
#include <string>

#include "dof/dof.h"
#include "raster/images/image.h"
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
  int samples = 1;  ///< of a pixel
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

/// Turns work that has a scene to another of its frames. Throws as make_work().
void set_frame(BenchWork& work, const BenchOptions& options, double frame);

// A picture to filter without drawing one: it has every circle of confusion, and silhouettes.

/// The focus distance that the picture is made for.
inline constexpr double kBenchPictureFocusM = 2.0;

/// The circle at infinity of the lens that it is made for, over the filter's largest.
inline constexpr double kBenchPictureHorizon = 1.5;

/// RGBA16F, depth in metres in alpha. A floor goes from the horizon above to half its blur in front
/// of the focus below, and 48 discs of all depths stand before it. With the lens above the signed
/// radii go from -1.2 to 1.2 times the filter's largest. Colours are smooth waves and noise, from 0
/// to 1.2. Every machine gives the same bits.
Image bench_picture(int width, int height);

}  // namespace softfocus
