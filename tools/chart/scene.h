#pragma once
// A scene as all contenders get it.

#include <string>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/lens_views/accumulation.h"
#include "tools/chart/options.h"
#include "tools/files/whole_file.h"

namespace softfocus {

struct ChartScene {
  const ChartSubject* subject = &chart_subjects().front();
  Scene scene;
  CameraMatrices view{};
  double frame = 0.0;
  ThinLens lens;
  PixelCoc coc;
  double aperture_m = 0.0;  ///< its radius; 0 if the subject is not seen through a lens
  Sampling sampling;        ///< of the subject; but for the number of samples
  Image pinhole;            ///< in the profile ieee
  Image labels;             ///< label_regions() of it
};

/// Loads all scenes, so that a wrong one is reported before hours of work, and returns the files
/// that they were read from. Throws SceneError, and UsageError for an impossible lens or two
/// scenes of one name.
std::vector<ReadFile> check_scenes(const ChartOptions& options);

/// Loads and draws a scene. Throws SceneError, and UsageError for an impossible lens.
ChartScene load_chart_scene(const std::string& name, const ChartOptions& options, ThreadPool& pool);

/// Input of the methods that draw the scene. Depth of field has no jitter: filters, too, look from
/// pixels' centres.
LensViewInput accumulation_input(const ChartScene& scene, int samples);

}  // namespace softfocus
