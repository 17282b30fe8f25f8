#include "scenes/draw/frame_parts.h"

#include <utility>

#include "scenes/draw/object_numbers.h"
#include "scenes/draw/surface_draws.h"

namespace softfocus {
namespace {

void make_sized(Image& image, int width, int height) {
  if (image.width == width && image.height == height && !image.bytes.empty()) return;
  image = make_image(Format::rgba16f, width, height);
}

}  // namespace

void draw_parts(PreparedScene& prepared, const CameraMatrices& camera, double frame, int width,
                int height, std::size_t layers, FrameParts& parts, ThreadPool& pool,
                std::optional<double> behind_before_m) {
  make_sized(parts.opaque, width, height);
  parts.transparent.clear();
  parts.behind.resize(layers > 1 ? layers - 1 : 0);
  for (Image& layer : parts.behind) make_sized(layer, width, height);
  if (layers == 0) {
    draw_scene(prepared, camera, frame, parts.opaque, pool);
    return;
  }
  draw_layers(prepared, camera, frame, parts.opaque, parts.behind, pool, behind_before_m);
  parts.transparent = draw_transparent(prepared, camera, frame, parts.opaque, pool);
}

void blend(FrameParts& parts, const Profile& profile, ThreadPool& pool) {
  if (parts.transparent.empty()) return;
  parts.blended = blended(parts.opaque, parts.transparent, profile, pool);
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
  FrameParts parts;
  draw_parts(prepared, camera, frame, width, height, method.layers, parts, pool,
             static_cast<double>(settings.coc.focus_m));
  return with_dof_input(parts, settings, profile, objects, {},
                        [&](const DofInput& input) { return apply(method, input, pool); });
}

}  // namespace softfocus
