// State and draws of the emulated driver.

#include <algorithm>
#include <bit>
#include <cstring>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "raster/pipeline/render_pass.h"
#include "raster/shaders/draw_shaders.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/emulated/emulated_gl.h"

namespace softfocus {
namespace {

using emulated::compiled;

std::vector<ShaderTexture> textures_of(const EmulatedStage& stage) {
  std::vector<ShaderTexture> textures(kEmulatedUnits);
  for (std::size_t i = 0; i < stage.uniforms.size(); ++i) {
    if (stage.is_late[i] || stage.uniforms[i] >= textures.size()) continue;
    const std::size_t unit = stage.uniforms[i];
    const auto found = emulated::gl().textures.find(emulated::gl().units[unit]);
    if (found == emulated::gl().textures.end() || found->second.texture.levels.empty()) continue;
    textures[unit] = {.texture = &found->second.texture, .sampler = found->second.sampler};
  }
  return textures;
}

RenderTargets bound_targets() {
  const EmulatedFramebuffer& bound = emulated::gl().framebuffers[emulated::gl().framebuffer];
  RenderTargets targets;
  for (std::size_t i = 0; i < bound.colour.size(); ++i) {
    targets.colour[i] = emulated::image_of(bound.colour[i]);
  }
  targets.depth = emulated::image_of(bound.depth);
  return targets;
}

std::vector<VertexAttribute> given_attributes() {
  std::vector<VertexAttribute> given;
  int location = 0;
  for (const EmulatedAttribute& of : emulated::gl().attributes) {
    if (of.is_enabled) {
      // A draw without vertices may have a buffer without bytes.
      const std::vector<std::byte>& buffer = emulated::gl().buffers[of.buffer];
      given.push_back({.location = location,
                       .components = of.components,
                       .first = buffer.empty() ? nullptr : buffer.data() + of.offset,
                       .stride = of.stride});
    }
    ++location;
  }
  return given;
}

DrawState draw_state() {
  const EmulatedGl& gl = emulated::gl();
  DrawState state;
  state.cull = gl.culls ? gl.faces : Cull::none;
  state.front_face = gl.front;
  state.depth.reset();
  if (gl.tests_depth) state.depth = gl.depth;
  for (ColourState& colour : state.colour) {
    if (gl.blends) colour.blend = BlendState{gl.blend, gl.blend};
  }
  return state;
}

void draw_triangles(const ShaderDraw& draw, const std::vector<std::uint32_t>& indices,
                    std::uint32_t vertex_count) {
  EmulatedGl& gl = emulated::gl();
  RenderPass pass;
  pass.targets = bound_targets();
  pass.profile = gl.profile;
  draw_shaders(pass, draw_state(), indices, vertex_count, draw);
  finish(pass, gl.pool);
}

/// Whether the three vertices are a triangle over the whole target, whose varyings are the place in
/// it, and pixels neither tested nor blended: then they are shaded in rows, with run_shader()'s
/// place, so that a pipeline has the bits that it has without a driver.
bool is_fullscreen(const ShaderDraw& draw, std::uint32_t vertex_count) {
  EmulatedGl& gl = emulated::gl();
  if (vertex_count != 3 || gl.tests_depth || gl.blends || gl.culls) return false;
  std::vector<ShaderVarying> varyings;
  for (const ShaderProgram::Input& of : draw.fragment->inputs) {
    const bool is_varying = of.input.builtin < 0;
    const bool is_place = of.input.builtin == static_cast<int>(SpirvBuiltin::frag_coord);
    if (of.input.uniform >= 0 || is_place) continue;
    if (!is_varying || of.input.is_flat || of.input.is_whole) return false;
    varyings.push_back({of.input.location, of.input.component});
  }
  std::array<glm::vec4, 3> corners{};
  std::vector<std::uint32_t> values(3 * varyings.size());
  run_vertices(*draw.vertex,
               {.vertex_count = 3,
                .attributes = draw.attributes,
                .textures = draw.vertex_textures,
                .varyings = varyings,
                .positions = corners,
                .values = values,
                .profile = gl.profile,
                .uniforms = draw.vertex_uniforms},
               gl.pool);
  constexpr std::array kPlaces{glm::vec4{0, 0, 0, 1}, glm::vec4{2, 0, 0, 1}, glm::vec4{0, 2, 0, 1}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const glm::vec4& place = kPlaces[i / varyings.size()];
    const float value = std::bit_cast<float>(values[i]);
    if (value != place[varyings[i % varyings.size()].component]) return false;
  }
  return corners ==
         std::array{glm::vec4{-1, -1, 0, 1}, glm::vec4{3, -1, 0, 1}, glm::vec4{-1, 3, 0, 1}};
}

void run_over_targets(EmulatedStage& fragment, const ShaderDraw& draw) {
  const RenderTargets to = bound_targets();
  std::array<ImageView, kMaxColourTargets> targets{};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (to.colour[i] != nullptr) targets[i] = *to.colour[i];
  }
  run_shader(*compiled(fragment, false),
             {.textures = draw.fragment_textures,
              .targets = targets,
              .profile = emulated::gl().profile,
              .budget = draw.budget},
             emulated::gl().pool);
}

/// Gives the vertex shader's outputs as they come.
ShaderProgram given_outputs(const std::vector<ShaderVarying>& varyings) {
  std::string head = "#version 450\nlayout(location = 0) in vec4 position;\n";
  std::string body = "void main() {\n  gl_Position = position;\n";
  for (std::size_t i = 0; i < varyings.size(); ++i) {
    const std::string number = std::to_string(i);
    head += "layout(location = " + std::to_string(i + 1) + ") in float given" + number + ";\n";
    head += "layout(location = " + std::to_string(varyings[i].location) +
            ", component = " + std::to_string(varyings[i].component) + ") flat out float gives" +
            number + ";\n";
    body += "  gives" + number + " = given" + number + ";\n";
  }
  const UserShader shader =
      make_shader(emulated::spirv_of(ShaderStage::vertex, head + body + "}\n", "points"));
  return compile_shader(shader, shader.uniforms.words);
}

/// Points of one pixel: each as the square of the pixel that its place is in.
void draw_points(ShaderDraw draw, std::uint32_t count) {
  EmulatedGl& gl = emulated::gl();
  std::vector<ShaderVarying> varyings;
  for (const ShaderProgram::Input& of : draw.fragment->inputs) {
    if (of.input.uniform < 0 && of.input.builtin < 0) {
      varyings.push_back({of.input.location, of.input.component});
    }
  }
  std::vector<glm::vec4> places(count);
  std::vector<std::uint32_t> values(count * varyings.size());
  run_vertices(*draw.vertex,
               {.vertex_count = count,
                .attributes = draw.attributes,
                .textures = draw.vertex_textures,
                .varyings = varyings,
                .positions = places,
                .values = values,
                .profile = gl.profile,
                .uniforms = draw.vertex_uniforms},
               gl.pool);

  const Rectangle area = target_area(bound_targets());
  const glm::vec2 size{area.x_end, area.y_end};
  const std::size_t numbers = 4 + varyings.size();  // of a vertex
  std::vector<std::uint32_t> vertices, indices;
  vertices.reserve(4 * count * numbers);
  indices.reserve(6 * std::size_t{count});
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec4& place = places[i];
    const auto is_within = [&](float x) { return -place.w <= x && x <= place.w; };
    if (!is_within(place.x) || !is_within(place.y) || !is_within(place.z)) continue;
    const glm::vec2 pixel = glm::floor((glm::vec2{place} / place.w * 0.5f + 0.5f) * size);
    const auto first = static_cast<std::uint32_t>(vertices.size() / numbers);
    for (const glm::vec2 corner : {glm::vec2{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
      const glm::vec2 at = (pixel + corner) / size * 2.0f - 1.0f;
      for (const float number : {at.x, at.y, place.z / place.w, 1.0f}) {
        vertices.push_back(std::bit_cast<std::uint32_t>(number));
      }
      for (std::size_t k = 0; k < varyings.size(); ++k) {
        vertices.push_back(values[i * varyings.size() + k]);
      }
    }
    for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) indices.push_back(first + corner);
  }
  const auto* const bytes = reinterpret_cast<const std::byte*>(vertices.data());
  const std::size_t stride = 4 * numbers;
  draw.attributes = {{.location = 0, .components = 4, .first = bytes, .stride = stride}};
  for (std::size_t i = 0; i < varyings.size(); ++i) {
    draw.attributes.push_back({.location = static_cast<int>(i + 1),
                               .components = 1,
                               .first = bytes + 4 * (4 + i),
                               .stride = stride});
  }
  draw.vertex = std::make_shared<const ShaderProgram>(given_outputs(varyings));
  draw.vertex_uniforms.clear();
  draw_triangles(draw, indices, static_cast<std::uint32_t>(vertices.size() / numbers));
}

void switch_to(GLenum what, bool on) {
  EmulatedGl& gl = emulated::gl();
  if (what == GL_DEPTH_TEST) gl.tests_depth = on;
  if (what == GL_CULL_FACE) gl.culls = on;
  if (what == GL_BLEND) gl.blends = on;
}

/// `indices`: numbers of vertices, by threes.
void draw_listed_vertices(GLenum mode, const std::vector<std::uint32_t>& indices,
                          std::uint32_t vertex_count) {
  EmulatedGl& gl = emulated::gl();
  const Rectangle area = target_area(bound_targets());
  const auto [x, y, width, height] = gl.viewport;
  const bool is_whole = gl.viewport == std::array{0, 0, area.x_end, area.y_end};
  EmulatedProgram& program = emulated::program_in_use();
  auto& [vertex, fragment] = program.stages;
  const ShaderDraw draw{.vertex = compiled(vertex, true),
                        .fragment = compiled(fragment, true),
                        .vertex_uniforms = vertex.uniforms,
                        .fragment_uniforms = fragment.uniforms,
                        .attributes = given_attributes(),
                        .vertex_textures = textures_of(vertex),
                        .fragment_textures = textures_of(fragment),
                        .clip_space = ShaderClipSpace::y_down,
                        .viewport = Rectangle{x, y, x + width, y + height}};
  if (mode == GL_POINTS) {
    if (is_whole) return draw_points(draw, vertex_count);
    throw DriverError("points in a viewport that is not the target; the target would be right");
  }
  if (is_whole && is_fullscreen(draw, vertex_count)) return run_over_targets(fragment, draw);
  draw_triangles(draw, indices, vertex_count);
}

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): OpenGL's names
namespace emulated {

void DrawArrays(GLenum mode, GLint /*first*/, GLsizei count) {
  std::vector<std::uint32_t> indices;
  const auto vertices = static_cast<std::uint32_t>(count);
  if (mode == GL_TRIANGLES) {
    for (std::uint32_t i = 0; i < vertices / 3 * 3; ++i) indices.push_back(i);
  } else if (mode == GL_TRIANGLE_STRIP) {
    for (std::uint32_t i = 2; i < vertices; ++i) {
      const std::uint32_t turned = i & 1;
      indices.insert(indices.end(), {i - 2 + turned, i - 1 - turned, i});
    }
  }
  draw_listed_vertices(mode, indices, vertices);
}

void DrawElements(GLenum mode, GLsizei count, GLenum /*type*/, const void* offset) {
  const std::vector<std::byte>& bytes = gl().buffers[gl().element_buffer];
  std::vector<std::uint32_t> indices(static_cast<std::size_t>(count));
  std::memcpy(indices.data(), bytes.data() + reinterpret_cast<std::uintptr_t>(offset),
              indices.size() * sizeof(std::uint32_t));
  const auto last = std::max_element(indices.begin(), indices.end());
  if (last != indices.end()) draw_listed_vertices(mode, indices, *last + 1);
}

void EnableVertexAttribArray(GLuint location) { gl().attributes.at(location).is_enabled = true; }
void DisableVertexAttribArray(GLuint location) { gl().attributes.at(location).is_enabled = false; }
void VertexAttribPointer(GLuint location, GLint components, GLenum /*type*/,
                         GLboolean /*is_normalized*/, GLsizei stride, const void* offset) {
  EmulatedAttribute& to = gl().attributes.at(location);
  to.buffer = gl().array_buffer;
  to.components = components;
  to.offset = reinterpret_cast<std::uintptr_t>(offset);
  to.stride = static_cast<std::size_t>(stride != 0 ? stride : 4 * components);
}
void GenVertexArrays(GLsizei /*count*/, GLuint* names) { *names = 1; }
void BindVertexArray(GLuint /*array*/) {}

void Enable(GLenum what) { switch_to(what, true); }
void Disable(GLenum what) { switch_to(what, false); }
void DepthFunc(GLenum test) {
  gl().depth.test = test == GL_ALWAYS ? Compare::always : Compare::less;
}
void DepthMask(GLboolean writes) { gl().depth.write = writes != GL_FALSE; }
void CullFace(GLenum faces) { gl().faces = faces == GL_BACK ? Cull::back : Cull::front; }
// Counter-clockwise to OpenGL, whose row 0 is the lowest, is clockwise to us.
void FrontFace(GLenum winding) {
  gl().front =
      winding == GL_CW ? softfocus::FrontFace::counter_clockwise : softfocus::FrontFace::clockwise;
}
void BlendFunc(GLenum source, GLenum destination) {
  if (source != GL_ONE || destination != GL_ONE) gl().error = GL_INVALID_ENUM;
  gl().blend.source = gl().blend.destination = BlendFactor::one;
}
void BlendEquation(GLenum equation) {
  gl().blend.op = equation == GL_MAX ? BlendOp::maximum : BlendOp::add;
}
void Viewport(GLint x, GLint y, GLsizei width, GLsizei height) {
  gl().viewport = {x, y, width, height};
}

void PixelStorei(GLenum /*what*/, GLint /*value*/) {}  // rows come without gaps
void Finish() {}                                       // all is done at once
GLenum GetError() { return std::exchange(gl().error, GL_NO_ERROR); }
void GetIntegerv(GLenum what, GLint* values) {
  values[0] = kMaxImageSize;
  if (what == GL_MAX_VIEWPORT_DIMS) values[1] = kMaxImageSize;
}
const GLubyte* GetString(GLenum name) {
  return reinterpret_cast<const GLubyte*>(name == GL_RENDERER ? "softfocus" : "4.5");
}

}  // namespace emulated
// NOLINTEND(readability-identifier-naming)

}  // namespace softfocus
