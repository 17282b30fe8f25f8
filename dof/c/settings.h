#pragma once
// A C program's settings: the lens, the method and the profile that they name.

#include <optional>

#include "dof/c/softfocus.h"
#include "dof/dof.h"

namespace softfocus {

/// How to blur a picture of some size.
struct ReadSettings {
  const Method* method = nullptr;  ///< null: auto
  DofSettings dof;                 ///< its max_coc_px is set if max_radius_px has a value
  std::optional<float> max_radius_px;
  double max_error = 0.0;  ///< of auto
  Profile profile;
};

/// What softfocus_init_settings() gives.
softfocus_settings default_settings();

/// Throws BadArgument.
ReadSettings read_settings(const softfocus_settings* settings, int width_px, int height_px);

}  // namespace softfocus
