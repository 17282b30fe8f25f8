#pragma once
// A scene as all contenders get it, and the drawing of each contender's picture.

#include <map>
#include <optional>
#include <string>

#include "dof/auto/auto_method.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/draw/draw_scene.h"
#include "tools/chart/options.h"
#include "tools/chart/settings.h"

namespace softfocus {

struct ChartScene {
  Scene scene;
  CameraMatrices view{};
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
LensViewInput accumulation_input(const ChartScene& scene, int samples);

/// Milliseconds of one run. What auto takes to choose counts as filtering.
struct RunTime {
  double frame_ms = 0.0;
  std::optional<double> filter_ms;  ///< none if nothing was filtered
};

/// Whether the scene's lens is one that the contender's arithmetic has.
bool can_run(const ChartScene& scene, const ChartEntry& entry);

/// Makes contenders' pictures again and again in the same memory.
class ChartRunner {
 public:
  /// The scene must outlive it.
  ChartRunner(const ChartScene& scene, ThreadPool& pool);

  /// Draws a whole frame, by a filter, from the lens's points or by what auto chooses: once to
  /// warm up, then timed.
  RunTime run(const ChartEntry& entry);

  /// Of the last run.
  const Image& result() const { return result_; }
  /// What auto chose last, in words.
  const std::string& chosen() const { return chosen_; }

 private:
  RunTime filter(const ChartEntry& entry);
  RunTime accumulate(int samples);
  RunTime choose(double max_error);
  PreparedScene& prepared_for(const std::string& profile);
  void filter_drawn(const Method& filter, float max_coc_px, const Profile& profile);
  void filter_drawn(const ChartEntry& entry, const Profile& profile);
  const FixedTable& table_for(float max_coc_px);
  void warm_up_views();
  void add_all_views(int samples);
  void carry_out(const AutoMethod& choice);

  const ChartScene& scene_;
  LensViewInput views_;  // with as many points of the lens as anything here takes
  ThreadPool& pool_;
  std::map<std::string, PreparedScene> prepared_;  // by profile
  std::map<float, FixedTable> tables_;             // by radius
  std::optional<AccumulationBuffer> buffer_;
  SampleSums sums_;
  Image drawn_;
  Image result_;
  std::string chosen_;
};

}  // namespace softfocus
