#include "tools/gl/scene_on_gl.h"

#include <algorithm>

#include "scenes/draw/draw_scene.h"
#include "scenes/draw/transparent_layers.h"
#include "scenes/files/scene_error.h"

namespace softfocus {
namespace {

template <class Value>
GlBuffer make_buffer(GLenum target, const std::vector<Value>& values) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(target, name);
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(Value)), values.data(),
               GL_STATIC_DRAW);
  return GlBuffer{name};
}

void set_attribute(GLuint location, const GlBuffer& buffer, GLint components) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(location);
}

void set_lights(const GlProgram& program, const SurfaceVertexInput& input) {
  set_uniform(program, "ambient_light", input.ambient_light);
  set_uniform(program, "light_count", static_cast<int>(input.lights.size()));
  for (std::size_t i = 0; i < input.lights.size(); ++i) {
    const Light& light = input.lights[i];
    const std::string at = '[' + std::to_string(i) + ']';
    const float is_point = light.kind == LightKind::point ? 1.0f : 0.0f;
    set_uniform(program, ("light_position" + at).c_str(),
                glm::vec4{light.position_or_direction, is_point});
    set_uniform(program, ("light_colour" + at).c_str(), light.colour);
  }
}

void set_material(const GlProgram& program, const Material& material) {
  set_uniform(program, "material_ambient", material.ambient);
  set_uniform(program, "material_diffuse", material.diffuse);
  set_uniform(program, "material_specular", material.specular);
  set_uniform(program, "material_shininess", material.shininess);
  set_uniform(program, "least_highlight", least_highlight(material.shininess));
  set_uniform(program, "material_lit", material.lit ? 1 : 0);
}

// The picture's row 0, its top, is GL's lowest row: turned over, what we see as
// counter-clockwise is clockwise to GL.
void set_state(const DrawState& state) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(state.depth->test == Compare::always ? GL_ALWAYS : GL_LESS);
  glDepthMask(state.depth->write ? GL_TRUE : GL_FALSE);
  glDisable(GL_BLEND);
  glFrontFace(state.front_face == FrontFace::counter_clockwise ? GL_CW : GL_CCW);
  if (state.cull == Cull::none) {
    glDisable(GL_CULL_FACE);
  } else {
    glEnable(GL_CULL_FACE);
    glCullFace(state.cull == Cull::back ? GL_BACK : GL_FRONT);
  }
}

}  // namespace

GlScene::GlScene(const GlContext& context, const Shaders& shaders, const Scene& scene)
    : context_(context), shaders_(shaders), scene_(scene) {
  for (const Material& material : scene.materials) {
    if (material.shaders == nullptr) continue;
    throw SceneError("--gl: material '" + material.name +
                     "' has shaders of its own, which drivers are not given; the emulated GPU "
                     "draws them");
  }
  for (const softfocus::Mesh& mesh : scene.meshes) {
    std::vector<glm::vec2> uvs = mesh.uvs;
    uvs.resize(mesh.positions.size());
    std::vector<glm::vec3> colours = mesh.colours;
    colours.resize(mesh.positions.size(), glm::vec3{1.0f});
    meshes_.push_back({make_buffer(GL_ARRAY_BUFFER, mesh.positions),
                       make_buffer(GL_ARRAY_BUFFER, mesh.normals),
                       make_buffer(GL_ARRAY_BUFFER, uvs), make_buffer(GL_ARRAY_BUFFER, colours),
                       make_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices)});
  }
  for (const Material& material : scene.materials) {
    if (material.texture) {
      textures_.emplace(&material, upload(scene.textures[*material.texture], material.sampler));
    }
    if (material.opacity_texture) {
      opacities_.emplace(
          &material, upload(scene.textures[*material.opacity_texture], material.opacity_sampler));
    }
  }
}

void GlScene::make_unshared_meshes() {
  if (!unshared_meshes_.empty()) return;
  for (const softfocus::Mesh& mesh : scene_.meshes) {
    std::vector<glm::vec3> positions, normals, colours;
    std::vector<glm::vec2> uvs;
    std::vector<std::uint32_t> indices;
    for (const std::uint32_t i : mesh.indices) {
      positions.push_back(mesh.positions[i]);
      normals.push_back(mesh.normals[i]);
      uvs.push_back(mesh.uvs.empty() ? glm::vec2{0.0f} : mesh.uvs[i]);
      colours.push_back(mesh.colours.empty() ? glm::vec3{1.0f} : mesh.colours[i]);
      indices.push_back(static_cast<std::uint32_t>(indices.size()));
    }
    unshared_meshes_.push_back(
        {make_buffer(GL_ARRAY_BUFFER, positions), make_buffer(GL_ARRAY_BUFFER, normals),
         make_buffer(GL_ARRAY_BUFFER, uvs), make_buffer(GL_ARRAY_BUFFER, colours),
         make_buffer(GL_ELEMENT_ARRAY_BUFFER, indices)});
  }
}

const GlProgram& GlScene::program(const SurfaceDraw& surface, bool peeled) {
  const SurfaceVariant variant = surface.variant;
  const bool blends = surface.opacity.blends;
  GlProgram& program = programs_[(blends ? 32u : 0u) + (peeled ? 16u : 0u) +
                                 (variant.holed ? 8u : 0u) + (variant.textured ? 4u : 0u) +
                                 (variant.specular ? 2u : 0u) + (variant.two_sided ? 1u : 0u)];
  if (program != 0) return program;
  std::string defines =
      "#define MAX_LIGHTS " + std::to_string(std::max<std::size_t>(scene_.lights.size(), 1)) + '\n';
  if (variant.textured) defines += "#define TEXTURED\n";
  if (variant.specular) defines += "#define SPECULAR\n";
  if (variant.two_sided) defines += "#define TWO_SIDED\n";
  if (variant.holed) defines += "#define CUT_OUT\n";
  if (blends) defines += "#define BLENDED\n";
  if (peeled) defines += "#define PEELED\n";
  program = link_program(context_, shaders_, "surface.vert", "surface.frag", defines);
  return program;
}

void GlScene::draw(const CameraMatrices& view, double frame, const GlTarget& target) {
  if (has_transparent(scene_)) return draw_blended(view, frame, target);
  bind(target);
  const glm::vec4 clear = clear_colour(scene_);
  glClearColor(clear.r, clear.g, clear.b, clear.a);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_surfaces(view, frame, {});
}

namespace {

// A layer's colour; and the depth and number of its fragments' triangles.
constexpr std::array kPeeledFormats{Format::rgba16f, Format::rgba32f};

GlTarget before_all_layers(int width, int height) {
  constexpr glm::vec4 kBeforeAll{-1.0f, 0.0f, 0.0f, 0.0f};
  GlTarget before = make_target(kPeeledFormats, width, height, true);
  bind(before);
  glClearBufferfv(GL_COLOR, 1, &kBeforeAll.x);
  return before;
}

}  // namespace

GlTarget GlScene::peel(const CameraMatrices& view, double frame, glm::vec4 clear,
                       const Peeling& peeling, int width, int height) {
  // Behind a pixel without a fragment none is looked for.
  constexpr glm::vec4 kBehindAll{2.0f, 0.0f, 0.0f, 0.0f};
  constexpr float kFar = 1.0f;
  make_unshared_meshes();
  GlTarget target = make_target(kPeeledFormats, width, height, true);
  bind(target);
  glDepthMask(GL_TRUE);
  glClearBufferfv(GL_COLOR, 0, &clear.x);
  glClearBufferfv(GL_COLOR, 1, &kBehindAll.x);
  glClearBufferfv(GL_DEPTH, 0, &kFar);
  draw_surfaces(view, frame, peeling);
  return target;
}

std::vector<Image> GlScene::draw_layers(const CameraMatrices& view, double frame, int width,
                                        int height, std::size_t layers) {
  std::vector<Image> pictures;
  GlTarget before = before_all_layers(width, height);
  for (std::size_t i = 0; i < layers; ++i) {
    before = peel(view, frame, clear_colour(scene_), {&before.colour[1]}, width, height);
    pictures.push_back(read_colour(before, 0));
  }
  return pictures;
}

void GlScene::draw_blended(const CameraMatrices& view, double frame, const GlTarget& target) {
  const int width = target.width, height = target.height;
  const GlTarget before_all = before_all_layers(width, height);
  GlTarget picture =
      peel(view, frame, clear_colour(scene_), {&before_all.colour[1]}, width, height);
  std::vector<GlTarget> layers;
  for (std::size_t i = 0; i < kTransparentLayers; ++i) {
    const GlTarget& before = i == 0 ? before_all : layers.back();
    layers.push_back(
        peel(view, frame, glm::vec4{0.0f}, {&before.colour[1], &picture.colour[1]}, width, height));
  }
  if (blend_program_ == 0) {
    blend_program_ = link_program(context_, shaders_, "fullscreen.vert", "blend_layer.frag");
  }
  const DepthsInMetres in_metres = depths_in_metres(scene_.camera);
  set_uniform(blend_program_, "inverse_far", in_metres.inverse_far);
  set_uniform(blend_program_, "inverse_near_less_far", in_metres.inverse_near_less_far);
  for (std::size_t i = kTransparentLayers; i-- > 0;) {
    GlTarget next;
    if (i > 0) next = make_target(std::array{Format::rgba16f}, width, height, false);
    set_texture(blend_program_, "below", 0, picture.colour[0]);
    set_texture(blend_program_, "layer", 1, layers[i].colour[0]);
    set_texture(blend_program_, "layer_depth", 2, layers[i].colour[1]);
    draw_fullscreen(i > 0 ? next : target, blend_program_);
    if (i > 0) picture = std::move(next);
  }
}

void GlScene::draw_surfaces(const CameraMatrices& view, double frame, const Peeling& peeling) {
  const GlTexture* before = peeling.before;
  int first_triangle = 0;
  // State that the draw before has set is not set again.
  const GlProgram* program_set = nullptr;
  const Material* material_set = nullptr;
  const softfocus::Mesh* mesh_set = nullptr;
  for (const SurfaceDraw& surface : surface_draws(scene_, view, frame)) {
    const SurfaceVertexInput& input = surface.input;
    const SurfaceOpacity& opacity = surface.opacity;
    if (opacity.blends != (peeling.opaque_depth != nullptr)) continue;
    if (opacity.value == 0.0f) continue;
    const GlProgram& used = program(surface, before != nullptr);
    set_uniform(used, "to_clip", input.to_clip);
    set_uniform(used, "to_world", input.to_world);
    set_uniform(used, "normal_to_world", input.normal_to_world);
    if (program_set != &used) {
      set_uniform(used, "eye", input.eye);
      set_lights(used, input);
    }
    if (program_set != &used || material_set != input.material) {
      set_material(used, *input.material);
      if (surface.variant.textured) {
        set_texture(used, "surface_texture", 0, textures_.at(input.material));
      }
      if (surface.variant.holed) {
        set_texture(used, "opacity_texture", 1, opacities_.at(input.material));
        set_uniform(used, "least_texel", least_texel(opacity));
      }
      if (opacity.blends) {
        set_uniform(used, "surface_opacity", opacity.value);
        set_uniform(used, "cuts_out", opacity.cuts_out ? 1 : 0);
      }
    }
    if (opacity.blends) set_texture(used, "opaque_depth", 3, *peeling.opaque_depth);
    if (before != nullptr) {
      set_texture(used, "layer_before", 2, *before);
      set_uniform(used, "first_triangle", first_triangle);
      first_triangle += static_cast<int>(input.mesh->indices.size() / 3);
    }
    if (mesh_set != input.mesh) {
      const std::vector<Mesh>& meshes = before != nullptr ? unshared_meshes_ : meshes_;
      const Mesh& mesh = meshes[static_cast<std::size_t>(input.mesh - scene_.meshes.data())];
      set_attribute(0, mesh.positions, 3);
      set_attribute(1, mesh.normals, 3);
      set_attribute(2, mesh.uvs, 2);
      set_attribute(3, mesh.colours, 3);
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh.indices);
    }
    set_state(surface.state);
    program_set = &used;
    material_set = input.material;
    mesh_set = input.mesh;
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(input.mesh->indices.size()), GL_UNSIGNED_INT,
                   nullptr);
  }
  for (const GLuint attribute : {0u, 1u, 2u, 3u}) glDisableVertexAttribArray(attribute);
}

Image GlScene::draw_velocity(const Instant& shown, const MotionSpan& span, int width, int height) {
  const GlTarget target = make_target(std::array{Format::rg16f}, width, height, true);
  const GlProgram whole = link_program(context_, shaders_, "velocity.vert", "velocity.frag");
  const GlProgram holed =
      link_program(context_, shaders_, "velocity.vert", "velocity.frag", "#define CUT_OUT\n");
  bind(target);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  for (const VelocityDraw& what : velocity_draws(scene_, shown, span, width, height)) {
    const VelocityInput& input = what.input;
    const bool has_holes = what.opacity.texture != nullptr;
    const GlProgram& used = has_holes ? holed : whole;
    set_uniform(used, "shown_to_clip", input.shown);
    set_uniform(used, "later_to_clip", input.to);
    set_uniform(used, "earlier_to_clip", input.from);
    set_uniform(used, "half_size_px", input.half_size_px);
    set_uniform(used, "least_w", input.least_w);
    if (has_holes) {
      set_texture(used, "opacity_texture", 0, opacities_.at(what.material));
      set_uniform(used, "least_texel", least_texel(what.opacity));
    }
    GlBuffer positions, indices;  // the background's
    const Mesh* mesh = nullptr;
    if (what.material != nullptr) {
      mesh = &meshes_[static_cast<std::size_t>(input.mesh - scene_.meshes.data())];
      set_attribute(2, mesh->uvs, 2);
    } else {
      positions = make_buffer(GL_ARRAY_BUFFER, input.mesh->positions);
      indices = make_buffer(GL_ELEMENT_ARRAY_BUFFER, input.mesh->indices);
      glDisableVertexAttribArray(2);
    }
    set_attribute(0, mesh != nullptr ? mesh->positions : positions, 3);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, mesh != nullptr ? mesh->indices : indices);
    set_state(what.state);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(input.mesh->indices.size()), GL_UNSIGNED_INT,
                   nullptr);
  }
  glDepthMask(GL_TRUE);
  for (const GLuint attribute : {0u, 2u}) glDisableVertexAttribArray(attribute);
  return read_colour(target, 0);
}

GlTarget make_scene_target(int width, int height) {
  return make_target(std::array{Format::rgba16f}, width, height, true);
}

}  // namespace softfocus
