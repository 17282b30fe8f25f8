#pragma once
// Which method, radius or number of samples a scene needs: the cheapest of the candidates
// that is foreseen to keep to an error, or the most accurate that is foreseen to keep to a
// time. Nothing is timed: the same picture gives the same choice on every machine.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "dof/auto/scene_traits.h"

namespace softfocus {

struct AutoGoal {
  double max_error = 0.02;              ///< mean FLIP; not looked at if there is a time
  std::optional<double> max_time_ms{};  ///< for the method, beside drawing
};

/// What the choice is bound by.
struct AutoLimits {
  std::optional<float> max_radius_px;  ///< filters cut circles to no more than this
  std::size_t triangles = 0;           ///< of the scene: what drawing it again takes
};

/// A method of dof/dof.h with a radius, or of scenes/lens_views/lens_view_method.h with a number
/// of samples.
struct AutoMethod {
  std::string_view method;
  float radius_px = 0.0f;  ///< what circles are cut to: max_coc_px of a filter
  int samples = 0;         ///< 0 of a filter
  double predicted_error = 0.0;
  double predicted_ms = 0.0;
  bool meets_goal = true;  ///< false: no candidate is foreseen to, and this is the nearest
  std::string reason{};    ///< one sentence, without its full stop
  SceneTraits traits;
};

/// The pinhole if no circle reaches half a pixel, whatever the goal, and then its foreseen error
/// is 0. Of what keeps to an error, and is foreseen to take up to a twentieth longer than the
/// cheapest, the most accurate. Among candidates that are foreseen equal, the one that stands
/// first in the table.
AutoMethod auto_method(const SceneTraits& traits, const AutoGoal& goal, const AutoLimits& limits);

/// Whether the pinhole's picture, by which auto chose, is the one that is wanted, to the bit.
bool is_sharp(const AutoMethod& choice);

/// "two-pass, radius 8", "accumulation, 64 samples", "pinhole".
std::string setting_text(const AutoMethod& choice);

}  // namespace softfocus
