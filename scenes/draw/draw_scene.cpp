#include "scenes/draw/draw_scene.h"

#include <array>
#include <cassert>
#include <utility>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "scenes/draw/surface_draws.h"
#include "scenes/draw/surface_lanes.h"
#include "scenes/draw/surface_stages.h"

namespace softfocus {
namespace {

const DecodedTexture* decoded(const PreparedScene& prepared, const Texture* texture) {
  if (texture == nullptr) return nullptr;
  return &prepared.textures[static_cast<std::size_t>(texture - prepared.scene->textures.data())];
}

template <SurfaceVariant variant>
void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface, RenderPass& pass) {
  const SurfaceVertexInput& input = surface.input;
  const auto vertices = static_cast<std::uint32_t>(input.mesh->positions.size());
  const SurfaceVertexStage<variant> vertex_stage{input};
  SurfaceFragmentStage<variant> fragment_stage{surface.texture, input.material->sampler,
                                               pass.profile, surface.opacity,
                                               surface.opacity_sampler};
  if (!can_draw_in_lanes(pass, surface.state)) {
    draw(pass, surface.state, input.mesh->indices, vertices, vertex_stage, fragment_stage);
    return;
  }
  fragment_stage.decoded = decoded(prepared, surface.texture);
  fragment_stage.decoded_opacity = decoded(prepared, surface.opacity);
  draw_in_lanes(pass, surface.state, input.mesh->indices, vertices, vertex_stage, fragment_stage,
                surface_lane_stages<variant>(pass.isa));
}

using DrawSurface = void (*)(const PreparedScene&, const SurfaceDraw&, RenderPass&);

constexpr SurfaceVariant variant_of(std::size_t number) {
  return {(number & 1) != 0, (number & 2) != 0, (number & 4) != 0, (number & 8) != 0};
}

constexpr auto kVariants = []<std::size_t... number>(std::index_sequence<number...>) {
  return std::array<DrawSurface, sizeof...(number)>{draw_surface<variant_of(number)>...};
}
(std::make_index_sequence<16>{});

void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface, RenderPass& pass) {
  const SurfaceVariant variant = surface.variant;
  const std::size_t number = (variant.textured ? 1u : 0u) + (variant.specular ? 2u : 0u) +
                             (variant.two_sided ? 4u : 0u) + (variant.cut_out ? 8u : 0u);
  kVariants[number](prepared, surface, pass);
}

}  // namespace

glm::vec4 clear_colour(const Scene& scene) {
  return {scene.background, alpha_depth(static_cast<float>(scene.camera.far_m))};
}

PreparedScene prepare_scene(const Scene& scene, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared = prepare_surfaces(scene, profile, pool);
  if (pool.isa() == Isa::scalar) return prepared;
  pool.for_each(static_cast<int>(scene.textures.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    DecodedTexture& texture = prepared.textures[number];
    if (texture.source == nullptr) texture = decode_texture(scene.textures[number], profile);
  });
  return prepared;
}

PreparedScene prepare_surfaces(const Scene& scene, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared{&scene, {}, {}, {}, {}};
  prepared.pass.profile = profile;
  prepared.pass.isa = pool.isa();
  if (pool.isa() == Isa::scalar) return prepared;
  prepared.textures.resize(scene.textures.size());
  for (const Material& material : scene.materials) {
    if (!material.cut_out || !material.opacity_texture) continue;
    const std::size_t number = *material.opacity_texture;
    prepared.textures[number] = decode_texture(scene.textures[number], profile);
  }
  return prepared;
}

void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass) {
  pass.clear_colour = clear_colour(*prepared.scene);
  pass.clear_depth = 1.0f;
  pass.keep_depth = false;
  for (const SurfaceDraw& surface : surface_draws(*prepared.scene, camera, frame)) {
    draw_surface(prepared, surface, pass);
  }
}

void record_surfaces(const PreparedScene& prepared, std::span<const Material> of_objects,
                     const CameraMatrices& camera, double frame, RenderPass& pass) {
  std::vector<SurfaceDraw> surfaces = surface_draws(*prepared.scene, camera, frame);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    // Which sides are culled stays the scene's choice.
    surfaces[i].input.material = &of_objects[i];
    surfaces[i].texture = nullptr;
    surfaces[i].variant = {.cut_out = surfaces[i].variant.cut_out};
    draw_surface(prepared, surfaces[i], pass);
  }
}

void draw_scene(PreparedScene& prepared, const CameraMatrices& camera, double frame, Image& picture,
                ThreadPool& pool) {
  draw_layers(prepared, camera, frame, picture, {}, pool);
}

void draw_layers(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 Image& picture, std::span<Image> behind, ThreadPool& pool) {
  assert(behind.size() < kMaxLayers);
  const auto depth_of_size = [&](Image& depth) {
    if (depth.width != picture.width || depth.height != picture.height) {
      depth = make_image(Format::r32f, picture.width, picture.height);
    }
    return &depth;
  };
  RenderTargets& targets = prepared.pass.targets;
  targets.colour[0] = &picture;
  targets.depth = depth_of_size(prepared.depth);
  targets.behind = {};
  if (prepared.depths_behind.size() < behind.size()) prepared.depths_behind.resize(behind.size());
  for (std::size_t i = 0; i < behind.size(); ++i) {
    targets.behind[i] = {&behind[i], depth_of_size(prepared.depths_behind[i])};
  }
  record_scene(prepared, camera, frame, prepared.pass);
  finish(prepared.pass, pool);
}

Image draw_scene(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                 int height, const Profile& profile, ThreadPool& pool) {
  Image picture = make_image(Format::rgba16f, width, height);
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  draw_scene(prepared, camera, frame, picture, pool);
  return picture;
}

std::vector<Image> draw_layers(const Scene& scene, const CameraMatrices& camera, double frame,
                               int width, int height, std::size_t layers, const Profile& profile,
                               ThreadPool& pool) {
  std::vector<Image> pictures;
  for (std::size_t i = 0; i < layers; ++i) {
    pictures.push_back(make_image(Format::rgba16f, width, height));
  }
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  draw_layers(prepared, camera, frame, pictures[0], std::span{pictures}.subspan(1), pool);
  return pictures;
}

}  // namespace softfocus
