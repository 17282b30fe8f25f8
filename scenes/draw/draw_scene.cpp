#include "scenes/draw/draw_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "dof/smooth_edges.h"
#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"
#include "raster/pipeline/draw.h"
#include "raster/threads/loops.h"
#include "scenes/draw/light_points.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/surfaces/surface_lanes.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {
namespace {

double determinant(const glm::dmat4& m) {
  return dot(glm::dvec3{m[0]}, cross(glm::dvec3{m[1]}, glm::dvec3{m[2]}));
}

// The matrix of cofactors: the inverse transpose but for a positive factor, which the
// normal's normalisation takes out; a mirroring matrix needs its sign.
glm::mat3 normal_matrix(const glm::dmat4& to_world) {
  const glm::dvec3 x{to_world[0]};
  const glm::dvec3 y{to_world[1]};
  const glm::dvec3 z{to_world[2]};
  const double sign = determinant(to_world) < 0.0 ? -1.0 : 1.0;
  return glm::mat3{glm::vec3{cross(y, z) * sign}, glm::vec3{cross(z, x) * sign},
                   glm::vec3{cross(x, y) * sign}};
}

bool has_opacity_texture(const Material& material, const Mesh& mesh) {
  return material.opacity_texture && !mesh.uvs.empty();
}

SurfaceDraw surface_draw(const Scene& scene, const Object& object, const CameraMatrices& camera,
                         double frame) {
  const Mesh& mesh = scene.meshes[object.mesh];
  const Material& material = scene.materials[object.material];
  const glm::dmat4 to_world = object_matrix(object, frame);
  const glm::dmat4 to_clip = multiply(camera.eye_to_clip, multiply(camera.world_to_eye, to_world));

  SurfaceDraw draw{};
  draw.state.cull = material.two_sided ? Cull::none : Cull::back;
  if (determinant(to_world) < 0.0) draw.state.front_face = FrontFace::clockwise;
  if (material.texture && !mesh.uvs.empty()) draw.texture = &scene.textures[*material.texture];
  draw.opacity = {.value = material.opacity,
                  .texture = has_opacity_texture(material, mesh)
                                 ? &scene.textures[*material.opacity_texture]
                                 : nullptr,
                  .sampler = material.opacity_sampler,
                  .cuts_out = material.cut_out,
                  .blends = is_transparent(material, mesh)};
  draw.variant = {.textured = draw.texture != nullptr,
                  .specular = material.lit && material.specular != glm::vec3{0.0f},
                  .two_sided = material.two_sided,
                  .holed = draw.opacity.texture != nullptr};
  draw.input = {&mesh,
                &material,
                scene.lights,
                scene.ambient_light,
                glm::mat4{to_clip},
                glm::mat4{to_world},
                normal_matrix(to_world),
                glm::vec3{camera.eye}};
  draw.shaders = material.shaders.get();
  draw.matrices = {to_world, camera.world_to_eye, camera.eye_to_clip, frame};
  return draw;
}

}  // namespace

bool is_transparent(const Material& material, const Mesh& mesh) {
  return material.opacity < 1.0f || (has_opacity_texture(material, mesh) && !material.cut_out);
}

bool has_transparent(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    return is_transparent(scene.materials[object.material], scene.meshes[object.mesh]);
  });
}

bool has_shaders(const Scene& scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& material) { return material.shaders != nullptr; });
}

std::vector<SurfaceDraw> surface_draws(const Scene& scene, const CameraMatrices& camera,
                                       double frame) {
  std::vector<SurfaceDraw> draws;
  draws.reserve(scene.objects.size());
  for (const Object& object : scene.objects) {
    draws.push_back(surface_draw(scene, object, camera, frame));
  }
  return draws;
}

namespace {

const DecodedTexture* decoded(const PreparedScene& prepared, const Texture* texture) {
  if (texture == nullptr) return nullptr;
  return &prepared.textures[static_cast<std::size_t>(texture - prepared.scene->textures.data())];
}

std::uint32_t vertex_count(const SurfaceDraw& surface) {
  return static_cast<std::uint32_t>(surface.input.mesh->positions.size());
}

template <std::size_t N>
SurfaceFragmentStage<N> fragment_stage(const PreparedScene& prepared, const SurfaceDraw& surface,
                                       const Profile& profile) {
  return {.texture = surface.texture,
          .sampler = surface.input.material->sampler,
          .profile = profile,
          .opacity = surface.opacity,
          .variant = surface.variant,
          .texture_reads = prepared.texture_reads};
}

/// For variants of N varyings.
template <std::size_t N>
void draw_slowly(const PreparedScene& prepared, const SurfaceDraw& surface,
                 std::span<const std::uint32_t> indices, RenderPass& pass) {
  draw(pass, surface.state, indices, vertex_count(surface),
       SurfaceVertexStage<N>{surface.input, surface.variant},
       fragment_stage<N>(prepared, surface, pass.profile));
}

std::vector<ShaderTexture> shader_textures(const PreparedScene& prepared,
                                           const SurfaceShader& shader) {
  std::vector<ShaderTexture> textures;
  textures.reserve(shader.textures.size());
  for (const ShaderSurfaceTexture& of : shader.textures) {
    ShaderTexture& to = textures.emplace_back();
    if (!of.is_there) continue;
    to.texture = &prepared.scene->textures[of.texture];
    to.sampler = of.sampler;
    // Without lanes nothing is decoded beforehand, and record_surfaces() decodes opacities alone.
    const bool is_decoded =
        of.texture < prepared.textures.size() && prepared.textures[of.texture].source != nullptr;
    if (is_decoded) to.decoded = &prepared.textures[of.texture];
  }
  return textures;
}

void draw_by_shaders(const PreparedScene& prepared, const SurfaceDraw& surface,
                     std::span<const std::uint32_t> indices, RenderPass& pass) {
  const Rectangle target = target_area(pass.targets);
  ShaderDraw draw =
      shader_draw(*surface.shaders, surface.input, surface.matrices, target.x_end, target.y_end);
  draw.vertex_textures = shader_textures(prepared, surface.shaders->vertex);
  draw.fragment_textures = shader_textures(prepared, surface.shaders->fragment);
  draw.texel.colour = surface.colour;
  if (surface.opacity.blends) {
    draw.texel.opacity = surface.opacity.value;
  } else {
    draw.texel.most_w = alpha_depth(std::numeric_limits<float>::infinity());
  }
  draw_shaders(pass, surface.state, indices, vertex_count(surface), draw);
}

void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface,
                  std::span<const std::uint32_t> indices, RenderPass& pass) {
  if (surface.shaders != nullptr) return draw_by_shaders(prepared, surface, indices, pass);
  const SurfaceVariant& variant = surface.variant;
  if (can_draw_in_lanes(pass, surface.state)) {
    auto in_lanes = fragment_stage<kMostSurfaceVaryings>(prepared, surface, pass.profile);
    in_lanes.decoded = decoded(prepared, surface.texture);
    in_lanes.decoded_opacity = decoded(prepared, surface.opacity.texture);
    return draw_in_lanes(pass, surface.state, indices, vertex_count(surface),
                         SurfaceVertexStage<kMostSurfaceVaryings>{surface.input, variant}, in_lanes,
                         surface_lane_stages(variant, pass.isa));
  }
  switch (surface_layout(variant).count) {
    case 4: return draw_slowly<4>(prepared, surface, indices, pass);
    case 6: return draw_slowly<6>(prepared, surface, indices, pass);
    case 7: return draw_slowly<7>(prepared, surface, indices, pass);
    case 9: return draw_slowly<9>(prepared, surface, indices, pass);
    case 13: return draw_slowly<13>(prepared, surface, indices, pass);
    default: return draw_slowly<kMostSurfaceVaryings>(prepared, surface, indices, pass);
  }
}

void draw_surface(const PreparedScene& prepared, const SurfaceDraw& surface, RenderPass& pass) {
  draw_surface(prepared, surface, surface.input.mesh->indices, pass);
}

/// Parts are of whole chunks, so that a draw's batches are what they are without parts.
constexpr std::size_t kChunkIndices = 3 * std::size_t{kChunkTriangles};

std::size_t chunks_of_mesh(const Mesh& mesh) {
  return (mesh.indices.size() + kChunkIndices - 1) / kChunkIndices;
}

bool is_hidden(const PreparedScene& prepared, std::size_t object) {
  return !prepared.hidden.empty() && prepared.hidden[object] != 0;
}

// Of what is drawn.
std::size_t chunks_of(const PreparedScene& prepared) {
  const Scene& scene = *prepared.scene;
  std::size_t chunks = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (!is_hidden(prepared, i)) chunks += chunks_of_mesh(scene.meshes[scene.objects[i].mesh]);
  }
  return chunks;
}

}  // namespace

std::size_t chunks_of_scene(const Scene& scene) {
  std::size_t chunks = 0;
  for (const Object& object : scene.objects) chunks += chunks_of_mesh(scene.meshes[object.mesh]);
  return chunks;
}

glm::vec4 clear_colour(const Scene& scene) {
  return {scene.background, alpha_depth(static_cast<float>(scene.camera.far_m))};
}

namespace {

void decode_textures(PreparedScene& prepared, ThreadPool& pool) {
  const std::vector<Texture>& textures = prepared.scene->textures;
  prepared.textures.resize(textures.size());
  pool.for_each(static_cast<int>(textures.size()), [&](int i) {
    const auto number = static_cast<std::size_t>(i);
    DecodedTexture& texture = prepared.textures[number];
    if (texture.source == nullptr) {
      texture = decode_texture(textures[number], prepared.pass.profile);
    }
  });
}

}  // namespace

PreparedScene prepare_scene(const Scene& scene, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared = prepare_surfaces(scene, profile, pool);
  if (has_shadows(scene)) prepared.shadows = make_scene_shadows(scene, profile, pool);
  if (pool.isa() != Isa::scalar) decode_textures(prepared, pool);
  return prepared;
}

PreparedScene prepare_surfaces(const Scene& scene, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared{};
  prepared.scene = &scene;
  prepared.has_transparent = has_transparent(scene);
  prepared.triangles = triangle_count(scene);
  prepared.pass.profile = profile;
  prepared.pass.isa = pool.isa();
  prepared.transparent_pass.profile = profile;
  prepared.transparent_pass.isa = pool.isa();
  if (pool.isa() == Isa::scalar) return prepared;
  prepared.textures.resize(scene.textures.size());
  for (const Material& material : scene.materials) {
    if (!material.opacity_texture) continue;
    const std::size_t number = *material.opacity_texture;
    prepared.textures[number] = decode_texture(scene.textures[number], profile);
  }
  return prepared;
}

void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass) {
  record_scene(prepared, camera, frame, pass, prepared.scene->lights);
}

namespace {

void begin_scene(const PreparedScene& prepared, RenderPass& pass) {
  pass.clear_colour = clear_colour(*prepared.scene);
  pass.clear_depth = 1.0f;
  pass.keep_depth = prepared.has_transparent || prepared.keeps_depth;
}

}  // namespace

void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass, std::span<const Light> lights) {
  begin_scene(prepared, pass);
  const std::vector<Object>& objects = prepared.scene->objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (is_hidden(prepared, i)) continue;
    SurfaceDraw surface = surface_draw(*prepared.scene, objects[i], camera, frame);
    surface.input.lights = lights;
    if (!surface.opacity.blends) draw_surface(prepared, surface, pass);
  }
}

void record_triangles(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                      RenderPass& pass, std::span<const Light> lights,
                      std::span<const std::vector<std::uint32_t>> indices_of_objects) {
  begin_scene(prepared, pass);
  for (std::size_t i = 0; i < indices_of_objects.size(); ++i) {
    if (indices_of_objects[i].empty()) continue;
    SurfaceDraw surface = surface_draw(*prepared.scene, prepared.scene->objects[i], camera, frame);
    surface.input.lights = lights;
    if (surface.shaders != nullptr) {
      draw_surface(prepared, surface, pass);
    } else {
      draw_surface(prepared, surface, indices_of_objects[i], pass);
    }
  }
}

void record_scene_part(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                       int part, int parts, RenderPass& pass, std::span<const Material> materials) {
  assert(part >= 0 && part < parts);
  pass.clear_colour.reset();
  pass.clear_depth.reset();
  if (part == 0) {
    pass.clear_colour = clear_colour(*prepared.scene);
    pass.clear_depth = 1.0f;
  }
  std::vector<SurfaceDraw> surfaces = surface_draws(*prepared.scene, camera, frame);
  std::size_t all = 0;
  for (const SurfaceDraw& surface : surfaces) {
    if (!surface.opacity.blends) all += chunks_of_mesh(*surface.input.mesh);
  }
  const auto border = [&](int i) {
    return all * static_cast<std::size_t>(i) / static_cast<std::size_t>(parts);
  };
  const std::size_t part_begin = border(part), part_end = border(part + 1);
  std::size_t first = 0;
  for (SurfaceDraw& surface : surfaces) {
    if (surface.opacity.blends) continue;
    if (!materials.empty()) {
      surface.input.material = &materials[static_cast<std::size_t>(
          surface.input.material - prepared.scene->materials.data())];
      surface.shaders = nullptr;
    }
    const Mesh& mesh = *surface.input.mesh;
    const std::size_t chunks = chunks_of_mesh(mesh);
    const std::size_t begin = std::clamp(part_begin, first, first + chunks) - first;
    const std::size_t end = std::clamp(part_end, first, first + chunks) - first;
    first += chunks;
    if (begin == end) continue;
    const std::size_t indices_end = std::min(end * kChunkIndices, mesh.indices.size());
    draw_surface(
        prepared, surface,
        std::span{mesh.indices}.subspan(begin * kChunkIndices, indices_end - begin * kChunkIndices),
        pass);
  }
}

void record_transparent(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                        RenderPass& pass) {
  for (const SurfaceDraw& surface : surface_draws(*prepared.scene, camera, frame)) {
    const SurfaceOpacity& opacity = surface.opacity;
    if (opacity.blends && opacity.value > 0.0f) draw_surface(prepared, surface, pass);
  }
}

void record_surfaces(const PreparedScene& prepared, std::span<const Material> of_objects,
                     const CameraMatrices& camera, double frame, RenderPass& pass) {
  std::vector<SurfaceDraw> surfaces = surface_draws(*prepared.scene, camera, frame);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i].opacity.blends) continue;
    // Which sides are culled stays the scene's choice.
    surfaces[i].input.material = &of_objects[i];
    surfaces[i].colour = of_objects[i].diffuse;
    surfaces[i].texture = nullptr;
    surfaces[i].variant = {.holed = surfaces[i].variant.holed};
    draw_surface(prepared, surfaces[i], pass);
  }
}

namespace {

Image* of_size(Image& depth, const Image& picture) {
  if (depth.width != picture.width || depth.height != picture.height) {
    depth = make_image(Format::r32f, picture.width, picture.height);
  }
  return &depth;
}

// The depth buffer's value of a distance along the axis.
float buffer_depth(const Camera& camera, double distance_m) {
  const double near = camera.near_m, far = camera.far_m;
  return static_cast<float>(far * (distance_m - near) / (distance_m * (far - near)));
}

// Calls `with(tile area, its layers)` for each tile that shows something transparent or, if
// `every`, for all.
template <class With>
void for_each_transparent_tile(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                               bool every, ThreadPool& pool, const With& with) {
  TransparentTargets& targets = prepared.transparent;
  if (targets.depth[0].width != prepared.depth.width ||
      targets.depth[0].height != prepared.depth.height) {
    targets = make_transparent_targets(prepared.depth.width, prepared.depth.height);
  }
  RenderPass& pass = prepared.transparent_pass;
  set_targets(targets, pass);
  record_transparent(prepared, camera, frame, pass);
  TileLists lists;
  sort_into_tiles({&pass, 1}, {&lists, 1}, pool);
  for_each_with<TileMemory>(pool, tile_count(lists), [&](int tile, auto& memory) {
    const std::size_t layers =
        draw_transparent_tile(pass, lists, tile, prepared.depth, targets, memory);
    if (layers > 0 || every) with(tile_area(lists, tile), layers);
  });
  pass.draws.clear();
}

void blend_transparent(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                       Image& picture, ThreadPool& pool) {
  const DepthsInMetres in_metres = depths_in_metres(prepared.scene->camera);
  for_each_transparent_tile(
      prepared, camera, frame, false, pool, [&](const Rectangle& area, std::size_t layers) {
        std::uint16_t* texels = row<std::uint16_t>(picture, area.y_begin).data() + 4 * area.x_begin;
        blend_transparent_tile(prepared.transparent, layers, prepared.depth, area, in_metres,
                               prepared.pass.profile, pool.isa(),
                               reinterpret_cast<std::byte*>(texels), picture.stride_bytes);
      });
}

// A scene of any number of objects, in passes on the same targets: the same bits.
void draw_in_passes(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                    std::span<const Light> lights, RenderPass& pass, ThreadPool& pool) {
  const Scene& scene = *prepared.scene;
  const std::optional<float> behind_before = std::exchange(pass.behind_before, std::nullopt);
  pass.clear_colour = clear_colour(scene);
  pass.clear_depth = 1.0f;
  pass.keep_depth = true;
  std::size_t chunks = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (is_hidden(prepared, i)) continue;
    const Object& object = scene.objects[i];
    const std::size_t more = chunks_of_mesh(scene.meshes[object.mesh]);
    if (chunks > 0 && chunks + more > kPassChunks) {
      finish(pass, pool);
      pass.clear_colour.reset();
      pass.clear_depth.reset();
      chunks = 0;
    }
    SurfaceDraw surface = surface_draw(scene, object, camera, frame);
    if (surface.opacity.blends) continue;
    surface.input.lights = lights;
    draw_surface(prepared, surface, pass);
    chunks += more;
  }
  finish(pass, pool);
  pass.behind_before = behind_before;
  if (behind_before && has_layers(pass.targets))
    clear_behind(pass, clear_colour(scene), 1.0f, pool);
}

// Into the targets that the scene's pass has, which are `layers`.
void draw_lit_by(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 std::span<const Light> lights, std::span<Image* const> layers, ThreadPool& pool) {
  RenderPass& pass = prepared.pass;
  if (chunks_of(prepared) > kPassChunks) {
    draw_in_passes(prepared, camera, frame, lights, pass, pool);
  } else {
    record_scene(prepared, camera, frame, pass, lights);
    finish(pass, pool);
  }
  if (!prepared.shadows) return;
  add_shadows(prepared, camera, frame, lights, layers, pass.behind_before, pool);
}

void draw_lit(PreparedScene& prepared, const CameraMatrices& camera, double frame,
              std::span<Image* const> layers, ThreadPool& pool) {
  const Scene& scene = *prepared.scene;
  const int points = prepared.shadows && has_soft_shadows(scene) ? scene.light_points : 1;
  if (points == 1) return draw_lit_by(prepared, camera, frame, scene.lights, layers, pool);
  LayerSums sums;
  for (int i = 0; i < points; ++i) {
    const std::vector<Light> lights = lights_at_point(scene.lights, static_cast<std::uint32_t>(i));
    draw_lit_by(prepared, camera, frame, lights, layers, pool);
    prepared.pass.edges.reset();  // they are the same by any light
    add_layers(layers, sums, pool);
    if (prepared.on_light_points) prepared.on_light_points(i + 1);
  }
  store_means(sums, layers, prepared.pass.profile, pool);
}

}  // namespace

void draw_scene(PreparedScene& prepared, const CameraMatrices& camera, double frame, Image& picture,
                ThreadPool& pool) {
  draw_layers(prepared, camera, frame, picture, {}, pool);
  if (prepared.has_transparent) blend_transparent(prepared, camera, frame, picture, pool);
}

std::vector<TransparentPicture> draw_transparent(PreparedScene& prepared,
                                                 const CameraMatrices& camera, double frame,
                                                 const Image& picture, ThreadPool& pool) {
  std::vector<TransparentPicture> pictures;
  if (!prepared.has_transparent) return pictures;
  while (pictures.size() < kTransparentLayers) {
    pictures.push_back({make_image(Format::rgba16f, picture.width, picture.height),
                        make_image(Format::rgba16f, picture.width, picture.height)});
  }
  const DepthsInMetres in_metres = depths_in_metres(prepared.scene->camera);
  std::array<std::atomic<bool>, kTransparentLayers> shows{};
  for_each_transparent_tile(
      prepared, camera, frame, true, pool, [&](const Rectangle& area, std::size_t layers) {
        store_transparent_tile(prepared.transparent, layers, area, in_metres, picture,
                               prepared.pass.profile, pool.isa(), pictures);
        for (std::size_t i = 0; i < layers; ++i) shows[i].store(true, std::memory_order_relaxed);
      });
  while (!pictures.empty() && !shows[pictures.size() - 1]) pictures.pop_back();
  return pictures;
}

namespace {

void make_sized(Image& image, int width, int height, Format format = Format::rgba16f) {
  if (image.width == width && image.height == height && !image.bytes.empty()) return;
  image = make_image(format, width, height);
}

// Whether all opaque draws of a scene are in lanes, and in one pass.
bool draws_in_lanes(const PreparedScene& prepared) {
  return !has_shaders(*prepared.scene) && can_draw_in_lanes(prepared.pass, DrawState{}) &&
         chunks_of(prepared) <= kPassChunks;
}

// Of a picture that has been drawn without them.
void find_scene_edges(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                      const Image& picture, const EdgeTargets& to, ThreadPool& pool) {
  make_sized(prepared.sampled_colour, picture.width, picture.height * to.samples);
  make_sized(prepared.sampled_depth, picture.width, picture.height * to.samples, Format::r32f);
  RenderPass& pass = prepared.pass;
  const RenderTargets targets = pass.targets;
  pass.targets = {.colour = {&prepared.sampled_colour},
                  .depth = &prepared.sampled_depth,
                  .stencil = nullptr,
                  .behind = {},
                  .samples = to.samples};
  pass.behind_before = {};
  if (chunks_of(prepared) > kPassChunks) {
    draw_in_passes(prepared, camera, frame, prepared.scene->lights, pass, pool);
  } else {
    record_scene(prepared, camera, frame, pass);
    finish(pass, pool);
  }
  pass.targets = targets;
  find_edges(picture, prepared.sampled_colour, to, pass.profile, pool);
}

// draw_layers() of triangles.
void draw_triangles(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                    Image& picture, std::span<Image> behind, ThreadPool& pool,
                    std::optional<double> behind_before_m, EdgePictures* edges) {
  assert(behind.size() < kMaxLayers);
  RenderPass& pass = prepared.pass;
  RenderTargets& targets = pass.targets;
  targets.colour[0] = &picture;
  targets.depth = of_size(prepared.depth, picture);
  targets.behind = {};
  if (prepared.depths_behind.size() < behind.size()) prepared.depths_behind.resize(behind.size());
  for (std::size_t i = 0; i < behind.size(); ++i) {
    targets.behind[i] = {&behind[i], of_size(prepared.depths_behind[i], picture)};
  }
  pass.behind_before = {};
  if (behind_before_m) {
    pass.behind_before = buffer_depth(prepared.scene->camera, *behind_before_m);
  }
  std::vector<Image*> layers{&picture};
  for (Image& layer : behind) layers.push_back(&layer);
  const Isa isa = pass.isa;
  // Drawing fragment by fragment finds no edges: without a vector unit lanes are four wide.
  if (isa == Isa::scalar) pass.isa = Isa::baseline;
  const bool in_lanes = draws_in_lanes(prepared);
  pass.isa = isa;
  if (edges != nullptr && (pass.profile.coverage != Coverage::edge_functions ||
                           (!in_lanes && picture.height * edges->samples > kMaxImageSize))) {
    edges->samples = 1;
  }
  if (edges == nullptr || edges->samples == 1) {
    draw_lit(prepared, camera, frame, layers, pool);
    return;
  }
  make_sized(edges->other, picture.width, picture.height);
  make_sized(edges->coverage, picture.width, picture.height, Format::r8);
  const EdgeTargets to{edges->samples, &edges->other, &edges->coverage};
  prepared.texture_reads = texture_reads_of(edges->samples);
  if (in_lanes) {
    if (isa == Isa::scalar) pass.isa = Isa::baseline;
    if (isa == Isa::scalar) decode_textures(prepared, pool);
    pass.edges = to;
    draw_lit(prepared, camera, frame, layers, pool);
    pass.edges.reset();
    pass.isa = isa;
  } else {
    draw_lit(prepared, camera, frame, layers, pool);
    find_scene_edges(prepared, camera, frame, picture, to, pool);
  }
  prepared.texture_reads = 1;
  // Shadows are put into pictures, of what pixels' centres show.
  if (prepared.shadows) take_shown_colours(picture, edges->coverage, edges->other, pool);
}

std::size_t triangles_of(const PreparedScene& prepared) {
  const Scene& scene = *prepared.scene;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (is_hidden(prepared, i)) continue;
    triangles += scene.meshes[scene.objects[i].mesh].indices.size() / 3;
  }
  return triangles;
}

// Lays the stand-ins into a picture that has been drawn without what they stand for.
void lay_stand_ins(PreparedScene& prepared, std::span<Image* const> layers, EdgePictures* edges,
                   ThreadPool& pool) {
  if (edges != nullptr && edges->samples == 1) edges = nullptr;
  std::vector<std::uint8_t> changed;
  const auto width = static_cast<std::size_t>(layers[0]->width);
  if (prepared.has_transparent || prepared.keeps_depth) {
    changed.assign(width * static_cast<std::size_t>(layers[0]->height), 0);
  }
  prepared.stand_ins->lay(layers, edges, changed, pool);
  if (changed.empty()) return;
  pool.for_each(layers[0]->height, [&](int y) {
    const std::uint8_t* is_changed = changed.data() + width * static_cast<std::size_t>(y);
    const std::uint16_t* texels = row<std::uint16_t>(*layers[0], y).data();
    float* depths = row<float>(prepared.depth, y).data();
    for (std::size_t x = 0; x < width; ++x) {
      if (is_changed[x] == 0) continue;
      depths[x] = buffer_depth(prepared.scene->camera,
                               static_cast<double>(half_to_float(texels[4 * x + 3])));
    }
  });
}

}  // namespace

void draw_layers(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 Image& picture, std::span<Image> behind, ThreadPool& pool,
                 std::optional<double> behind_before_m, EdgePictures* edges) {
  if (prepared.stand_ins != nullptr) {
    prepared.hidden =
        prepared.stand_ins->prepare(camera, frame, picture.width, picture.height, pool);
  }
  prepared.triangles = triangles_of(prepared);
  if (prepared.stand_ins == nullptr) {
    return draw_triangles(prepared, camera, frame, picture, behind, pool, behind_before_m, edges);
  }
  // An impostor may come to lie before what is in focus, which then is behind.
  draw_triangles(prepared, camera, frame, picture, behind, pool, {}, edges);
  prepared.hidden.clear();
  std::vector<Image*> layers{&picture};
  for (Image& layer : behind) layers.push_back(&layer);
  lay_stand_ins(prepared, layers, edges, pool);
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

void draw_parts(PreparedScene& prepared, const CameraMatrices& camera, double frame, int width,
                int height, std::size_t layers, FrameParts& parts, ThreadPool& pool,
                std::optional<double> behind_before_m, int samples) {
  make_sized(parts.opaque, width, height);
  parts.transparent.clear();
  parts.behind.resize(layers > 1 ? layers - 1 : 0);
  for (Image& layer : parts.behind) make_sized(layer, width, height);
  parts.edges.samples = 1;
  if (layers == 0) {
    draw_scene(prepared, camera, frame, parts.opaque, pool);
    return;
  }
  parts.edges.samples = samples;
  draw_layers(prepared, camera, frame, parts.opaque, parts.behind, pool, behind_before_m,
              &parts.edges);
  parts.transparent = draw_transparent(prepared, camera, frame, parts.opaque, pool);
}

void blend(FrameParts& parts, const Profile& profile, ThreadPool& pool) {
  if (parts.transparent.empty()) return;
  parts.blended = blended(parts.opaque, parts.transparent, profile, pool);
}

Image filtered_frame(const Method& method, const Scene& scene, const CameraMatrices& camera,
                     double frame, const Image& picture, const DofSettings& settings,
                     const Profile& profile, ThreadPool& pool,
                     std::shared_ptr<const StandIns> stand_ins) {
  const int width = picture.width, height = picture.height;
  const std::vector<std::uint16_t> objects =
      object_numbers_for(method, scene, camera, frame, width, height, profile, pool);
  if (method.layers == 1 && !has_transparent(scene)) {
    return apply(method, {picture, settings, profile, objects}, pool);
  }
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  prepared.stand_ins = std::move(stand_ins);
  FrameParts parts;
  draw_parts(prepared, camera, frame, width, height, method.layers, parts, pool,
             static_cast<double>(settings.coc.focus_m));
  return with_dof_input(parts, settings, profile, objects, {},
                        [&](const DofInput& input) { return apply(method, input, pool); });
}

}  // namespace softfocus
