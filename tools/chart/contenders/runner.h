#pragma once
// The drawing of each contender's picture, again and again in the same memory.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenes/filtered_views/filtered_views.h"
#include "scenes/frame/frame.h"
#include "scenes/warped_views/warped_views.h"
#include "tools/chart/contenders/shadow_contenders.h"
#include "tools/chart/contenders/turn_contenders.h"
#include "tools/chart/scene.h"
#include "tools/chart/settings.h"

namespace softfocus {

/// Milliseconds of one run. auto's choosing counts as filtering.
struct RunTime {
  double frame_ms = 0.0;
  std::optional<double> filter_ms;  ///< none if nothing was filtered
};

/// Whether the contender's arithmetic can hold the scene's lens.
bool can_run(const ChartScene& scene, const ChartEntry& entry);

/// Makes contenders' pictures again and again in the same memory.
class ChartRunner {
 public:
  /// The scene must outlive it.
  ChartRunner(const ChartScene& scene, ThreadPool& pool);

  /// Draws a whole frame, by a filter, from the lens's points or by what auto chooses.
  RunTime run(const ChartEntry& entry);
  /// run() after a run without a clock: the contender before has filled the caches with its own.
  RunTime run_warm(const ChartEntry& entry);

  /// The last run's picture.
  const Image& result() const { return result_; }
  /// ChartErrors::wrong_pixels of the last run, of a chart of shadows. The run was of that entry.
  double wrong_pixels(const ChartEntry& entry);
  /// Adds outline, renewals and memory of the last run, of a chart of impostors.
  void add_turn_errors(const Image& truth, ChartErrors& errors);
  /// auto's last choice, in words.
  const std::string& chosen() const { return chosen_; }

 private:
  RunTime filter(const ChartEntry& entry);
  RunTime draw_with_effects(const ChartEntry& entry);
  RunTime draw_with_shadows(const ChartEntry& entry);
  ShadowContenders& shadow_contenders();
  TurnContenders& turn_contenders();
  Image with_effect(ChosenEffect chosen, const Image& before);
  RunTime draw_after_frames(const ChosenEffect& chosen, int frames);
  RunTime accumulate(int samples);
  RunTime filter_views(int samples);
  RunTime warp_views(int samples, int drawn_views);
  RunTime draw_otherwise(const LensViewMethod& method);
  RunTime choose(double max_error);
  FrameMemory& memory_for(const std::string& profile);
  Shot shot_by(const MethodChoice& method, const Profile& profile) const;
  RunTime run_shot(const Shot& shot, float max_coc_px, FrameMemory& memory);
  void make_result(const Shot& shot, float max_coc_px, FrameMemory& memory);
  const FixedTable& table_for(float max_coc_px);
  AccumulationBuffer& buffer();
  void add_views(int first, int last);
  void warm_up(const ChartEntry& entry);
  void place_views_of(int samples);
  void add_all_views(int samples);

  const ChartScene& scene_;
  LensViewInput views_;  // with as many points of the lens as anything here takes
  ThreadPool& pool_;
  std::map<std::string, FrameMemory> memories_;  // by profile, with the prepared scene
  std::map<float, FixedTable> tables_;           // by radius
  std::optional<AccumulationBuffer> buffer_;
  std::optional<FilteredViewsBuffer> filtered_;
  std::optional<WarpedViewsBuffer> warped_;
  SampleSums sums_;
  std::optional<PreparedScene> prepared_large_;  // of what is drawn larger
  std::optional<ShadowContenders> shadows_;
  std::optional<TurnContenders> turns_;
  Image drawn_, large_;  // without depth of field
  FrameParts smooth_;
  DrawnFrame frame_;  // of the method run last
  Image result_;
  std::string chosen_;
};

}  // namespace softfocus
