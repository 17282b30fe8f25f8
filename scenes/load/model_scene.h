#pragma once
// A model in a scene, and a model that is given as the scene itself.

#include <cstdint>
#include <optional>
#include <string>

#include "scenes/models/model.h"
#include "scenes/scene.h"

namespace softfocus {

/// Puts each part of the model where `placement` says, with its own materials or all
/// of `material`. The model's warnings and files
/// become the scene's.
void add_model(Scene& scene, Model model, const Object& placement,
               std::optional<std::uint32_t> material);

/// A scene for a model that comes without one, whatever its unit of length:
///   camera  three-quarter view from the front, a little from above, the model within
///           90 % of a square picture; 40 degrees
///   focus   where the middle of the picture first meets the model, or the middle of
///           the model's depth where it meets none
///   lens    50 mm (nearer than 1 m: 1/20 of the focus distance) at f/2, and circles so
///           much larger or smaller that the point of the model farthest out of focus has one
///           of kModelCocPx, whatever the model's size
///   light   a key from the upper left, a weak fill from the right, neutral grey behind
/// A camera and lights of the model's own stand in for these.
Scene make_model_scene(Model model, const std::string& name);

/// Radius in pixels of a picture of 1024 rows.
inline constexpr double kModelCocPx = 12.0;

}  // namespace softfocus
