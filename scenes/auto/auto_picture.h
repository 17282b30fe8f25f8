#pragma once
// The picture of --method auto: what dof/auto chooses, drawn, and held against views of the lens
// where the prediction is in doubt.

#include <functional>
#include <optional>

#include "dof/auto/auto_method.h"
#include "dof/dof.h"
#include "scenes/lens_views/lens_view_method.h"

namespace softfocus {

/// When a choice by error is checked. A choice by time never is.
enum class Verify : std::uint8_t { never, in_doubt, always };

/// What is being done, for times and for progress.
enum class AutoStage : std::uint8_t { choosing, filtering, sampling, checking };

struct AutoInput {
  /// The scene and its pinhole picture. `sampling.samples` is not looked at.
  const LensViewInput& views;
  DofSettings settings;  ///< max_coc_px is not looked at
  AutoGoal goal;
  AutoLimits limits;
  Verify verify = Verify::in_doubt;
  std::function<void(AutoStage)> on_stage = {};  ///< told as each begins; may be empty
};

struct AutoPicture {
  Image picture;
  /// What was chosen at last. If its error was measured, meets_goal tells of that.
  AutoMethod choice;
  float max_coc_px = 0.0f;  ///< of a filter
  /// The mean FLIP that was found, with its standard error added; none if nothing was checked.
  std::optional<double> measured_error = {};
  int rejected = 0;  ///< choices that were drawn, checked and found to miss the limit
};

/// Whether a check is due: the prediction times kDoubt is beyond the limit, something out of focus
/// is brighter than 1, or the picture has fewer rows than those of the fit.
bool is_in_doubt(const AutoMethod& choice, const AutoGoal& goal);

/// The picture of a choice other than accumulation. `settings.max_coc_px` and
/// `views.sampling.samples` are not looked at.
Image picture_of(const AutoMethod& choice, const LensViewInput& views, DofSettings settings,
                 ThreadPool& pool);

/// A picture of filters or of filtered-views is checked on kCheckedTiles tiles, against 16 views of
/// the lens or more. If it misses the limit, the next dearer choice that should meet it is taken.
/// An accumulation is checked in the same way, against four times its views (from 128 samples on
/// 512 views, or twice its own), and its samples doubled. The same bits on every machine, and the
/// bits that the method gives by its own name.
AutoPicture auto_picture(const AutoInput& input, ThreadPool& pool);

inline constexpr int kCheckedTiles = 24;

}  // namespace softfocus
