#pragma once
// Image-space effects: what a camera or a program adds to a drawn picture (Akenine-Moller et al.
// 2018, chapter 12). Depth of field has a room of its own (dof/dof.h).

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "raster/images/image.h"
#include "raster/numbers/parameter.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct Effect;

struct EffectInput {
  ConstImageView picture;              ///< RGBA16F: linear colour, and in alpha what stays there
  std::span<const double> parameters;  ///< one for each of the effect's, within its limits
  Profile profile;
  /// Of an effect that reads it: RG16F of the picture's size, pixels a frame (velocity.h).
  ConstImageView velocity = {};
};

/// The velocity that an effect reads. Its first parameter is then the shutter: the part of a frame
/// that it is open, centred on the frame.
enum class VelocityOf : std::uint8_t {
  nothing,  ///< it reads none
  all,      ///< objects and camera
  camera,   ///< from the picture's depth, as if nothing else moved
};

/// An entry of the table.
struct Effect {
  std::string_view name;
  std::string_view summary;
  std::span<const Parameter> parameters;
  /// Writes RGBA16F of the picture's size, with its alpha. Null: it makes frames (scenes/temporal).
  void (*filter)(const Effect& effect, const EffectInput& input, const ImageView& result,
                 ThreadPool& pool);
  /// Whether a pixel's light goes to its neighbours, and so its opacity, if it has one, with it.
  bool spreads = false;
  VelocityOf velocity = VelocityOf::nothing;
};

/// An effect with its numbers.
struct ChosenEffect {
  const Effect* effect;
  std::vector<double> parameters;  ///< one for each of the effect's
};

std::span<const Effect> effects();

/// The effect of that name, or nullptr.
const Effect* find_effect(std::string_view name);

/// The picture with the effect. The bits depend on the input alone.
Image apply(const Effect& effect, const EffectInput& input, ThreadPool& pool);

}  // namespace softfocus
