#include "scenes/draw/frame_parts.h"

#include <utility>

#include "scenes/draw/object_numbers.h"
#include "scenes/draw/surface_draws.h"

namespace softfocus {

FrameParts draw_parts(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                      int width, int height, std::size_t layers, ThreadPool& pool,
                      std::optional<double> behind_before_m) {
  FrameParts parts;
  parts.picture = make_image(Format::rgba16f, width, height);
  while (parts.behind.size() + 1 < layers) {
    parts.behind.push_back(make_image(Format::rgba16f, width, height));
  }
  draw_layers(prepared, camera, frame, parts.picture, parts.behind, pool, behind_before_m);
  parts.transparent = draw_transparent(prepared, camera, frame, parts.picture, pool);
  if (parts.transparent.empty()) return parts;
  parts.opaque = std::move(parts.picture);
  parts.picture = blended(parts.opaque, parts.transparent, prepared.pass.profile, pool);
  return parts;
}

Image filtered_frame(const Method& method, const Scene& scene, const CameraMatrices& camera,
                     double frame, const Image& picture, const DofSettings& settings,
                     const Profile& profile, ThreadPool& pool) {
  const int width = picture.width, height = picture.height;
  const std::vector<std::uint16_t> objects =
      object_numbers_for(method, scene, camera, frame, width, height, profile, pool);
  if (method.layers == 1 && !has_transparent(scene)) {
    return apply(method, {picture, settings, profile, objects}, pool);
  }
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  const FrameParts parts = draw_parts(prepared, camera, frame, width, height, method.layers, pool,
                                      static_cast<double>(settings.coc.focus_m));
  return with_dof_input(parts, settings, profile, objects, {},
                        [&](const DofInput& input) { return apply(method, input, pool); });
}

}  // namespace softfocus
