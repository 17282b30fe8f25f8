#pragma once
// A scene as all contenders get it, and the drawing of each contender's picture.

#include <map>
#include <optional>
#include <string>

#include "reference/accumulation.h"
#include "scenes/draw_scene.h"
#include "tools/chart_options.h"
#include "tools/chart_settings.h"

namespace softfocus {

struct ChartScene {
  Scene scene;
  View view{};
  double frame = 0.0;
  ThinLens lens;
  PixelCoc coc;
  double aperture_m = 0.0;  ///< its radius
  Image pinhole;            ///< in the profile ieee
  Image labels;             ///< label_regions() of it
};

/// Loads all scenes that are wanted, so that a wrong one is told before hours of work. Throws
/// SceneError, and UsageError for a lens that cannot be and for two scenes of one name.
void check_scenes(const ChartOptions& options);

/// Loads and draws it. Throws SceneError, and UsageError for a lens that cannot be.
ChartScene load_chart_scene(const std::string& name, const ChartOptions& options, ThreadPool& pool);

/// For the methods that draw the scene; no jitter, for a filter looks from pixels' centres too.
SceneMethodInput accumulation_input(const ChartScene& scene, int samples);

/// Milliseconds of one run.
struct RunTime {
  double frame_ms = 0.0;
  std::optional<double> filter_ms;  ///< none if nothing was filtered
};

/// Makes contenders' pictures again and again in the same memory.
class ChartRunner {
 public:
  /// The scene must outlive it. `most_samples` is of the contenders.
  ChartRunner(const ChartScene& scene, int most_samples, ThreadPool& pool);

  /// Draws a whole frame, by a filter or from the lens's points: once to warm up, then timed.
  RunTime run(const ChartEntry& entry);

  /// Of the last run.
  const Image& result() const { return result_; }

 private:
  RunTime filter(const ChartEntry& entry);
  RunTime accumulate(int samples);

  const ChartScene& scene_;
  int most_samples_;
  ThreadPool& pool_;
  std::map<std::string, PreparedScene> prepared_;  // by profile
  std::optional<AccumulationBuffer> buffer_;
  SampleSums sums_;
  Image drawn_;
  Image result_;
};

}  // namespace softfocus
