#pragma once
// Auto: picks the cheapest candidate whose predicted error is within a limit, or the most
// accurate whose predicted time is. Nothing is timed: the same picture gives the same method on
// every machine.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/auto/candidates.h"
#include "dof/auto/scene_traits.h"
#include "dof/parameters.h"

namespace softfocus {

struct AutoGoal {
  double max_error = parameter::kMaxError.preset;  ///< mean FLIP; ignored if there is a time
  std::optional<double> max_time_ms{};             ///< for the method, beside drawing
};

/// What auto has to keep to, beside the goal.
struct AutoLimits {
  std::optional<float> max_radius_px;  ///< filters cut circles to no more than this
  std::size_t triangles = 0;           ///< of the scene, to predict the time to draw it again
  /// The table to choose from, its lines those of candidates().
  std::span<const Candidate> table = candidates();
};

/// A method of dof/dof.h with a radius, or of scenes/lens_views/lens_view_method.h with a number
/// of samples.
struct AutoMethod {
  std::string_view method;
  std::size_t candidate = 0;  ///< its index in candidates()
  float radius_px = 0.0f;     ///< max_coc_px of a filter
  int samples = 0;            ///< of a lens-view method; 0: a filter
  double predicted_error = 0.0;
  double predicted_ms = 0.0;
  bool meets_goal = true;  ///< false: no candidate does, and this is the nearest
  std::string reason{};    ///< one sentence, without its full stop
  SceneTraits traits;
};

/// The pinhole, with a predicted error of 0, if no circle reaches half a pixel. For an error:
/// the most accurate of the candidates within it that take at most a twentieth longer than the
/// cheapest. Of equal candidates the first in the table.
AutoMethod auto_method(const SceneTraits& traits, const AutoGoal& goal, const AutoLimits& limits);

/// The choice among the filters alone, for a picture that has no scene to draw anew: RGBA16F,
/// depth in alpha.
AutoMethod auto_filter(const ConstImageView& picture, const PixelCoc& coc, const AutoGoal& goal,
                       std::optional<float> max_radius_px, ThreadPool& pool);

/// The candidates that differ on such a picture, from cheap to dear, with their predictions. A
/// filter's radius is cut to the largest circle.
std::vector<AutoMethod> open_choices(const SceneTraits& traits, const AutoLimits& limits);

/// Whether the method's picture is the pinhole's, to the bit.
bool is_sharp(const AutoMethod& choice);

/// Three digits, as the reasons have their numbers.
std::string number_text(double value);

/// "two-pass, radius 8", "accumulation, 64 samples", "pinhole".
std::string setting_text(const AutoMethod& choice);

}  // namespace softfocus
