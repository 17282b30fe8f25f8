#pragma once
// A frame in the parts that a depth-of-field method reads: what is opaque, the surfaces behind it,
// and the transparent ones before it.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dof/dof.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {

struct FrameParts {
  Image opaque;                                 ///< draw_layers()'s first
  std::vector<Image> behind;                    ///< and its others
  std::vector<TransparentPicture> transparent;  ///< before `opaque`
  Image blended;                                ///< these over it; none if nothing is transparent

  /// All of it, as draw_scene() has it. Needs blend().
  const Image& picture() const { return transparent.empty() ? opaque : blended; }
};

/// Draws a frame, with `layers` - 1 opaque surfaces behind the first, as draw_layers(), into the
/// memory of `parts` as far as it has the size; without blend(). 0 layers: draw_scene() alone.
void draw_parts(PreparedScene& prepared, const CameraMatrices& camera, double frame, int width,
                int height, std::size_t layers, FrameParts& parts, ThreadPool& pool,
                std::optional<double> behind_before_m = {});

void blend(FrameParts& parts, const Profile& profile, ThreadPool& pool);

/// Calls `use(DofInput)` with a frame's parts as a method reads them. With `radii_px`, which are of
/// one picture, that is the blended picture alone.
template <class Use>
auto with_dof_input(const FrameParts& parts, const DofSettings& settings, const Profile& profile,
                    std::span<const std::uint16_t> objects, std::span<const float> radii_px,
                    const Use& use) {
  const std::vector<ConstImageView> behind{parts.behind.begin(), parts.behind.end()};
  const bool is_one = parts.transparent.empty() || !radii_px.empty();
  const std::vector<TransparentLayer> transparent =
      is_one ? std::vector<TransparentLayer>{} : views_of(parts.transparent);
  return use(DofInput{.scene = is_one ? parts.picture() : parts.opaque,
                      .settings = settings,
                      .profile = profile,
                      .objects = objects,
                      .behind = behind,
                      .transparent = transparent,
                      .radii_px = radii_px});
}

/// A frame by a method, with all that the method reads of the scene. `picture` is draw_scene()'s.
Image filtered_frame(const Method& method, const Scene& scene, const CameraMatrices& camera,
                     double frame, const Image& picture, const DofSettings& settings,
                     const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
