#include "tools/gl/shadows_on_gl.h"

#include <array>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

struct ShadowVertex {
  glm::vec2 position;
  float receiver;
};

std::vector<ShadowVertex> vertices_of(const MaskDraws& draws, std::uint8_t bit) {
  std::vector<ShadowVertex> vertices;
  for (const MaskDraws::Part& part : draws.parts) {
    for (const MaskTriangle& triangle : part.triangles) {
      if (triangle.bit != bit) continue;
      for (const glm::vec2& corner : triangle.corners) {
        vertices.push_back({corner, static_cast<float>(triangle.receiver)});
      }
    }
  }
  return vertices;
}

GlBuffer upload(const std::vector<ShadowVertex>& vertices) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  GlBuffer buffer{name};
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(ShadowVertex)),
               vertices.data(), GL_STATIC_DRAW);
  return buffer;
}

}  // namespace

GlShadows make_gl_shadows(const GlContext& context, const Shaders& shaders, const MaskDraws& draws,
                          int lights, int width, int height) {
  GlShadows made{
      width, height, link_program(context, shaders, "shadow.vert", "shadow.frag"), {}, {}};
  Image receivers = make_image(Format::r32f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto to = row<float>(receivers, y);
    for (std::size_t x = 0; x < to.size(); ++x) {
      const std::uint32_t receiver =
          draws.receivers[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + x];
      to[x] = receiver == kShowsNone ? -1.0f : static_cast<float>(receiver);
    }
  }
  made.receivers = upload(receivers);
  for (int i = 0; i < lights; ++i) {
    const auto vertices = vertices_of(draws, static_cast<std::uint8_t>(1u << i));
    made.lights.push_back({upload(vertices), static_cast<GLsizei>(vertices.size()),
                           make_target(std::array{Format::r32f}, width, height, false)});
  }
  return made;
}

void draw(const GlShadows& shadows) {
  for (const GlShadows::OfLight& light : shadows.lights) {
    bind(light.target);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    glUseProgram(shadows.program);
    set_texture(shadows.program, "receivers", 0, shadows.receivers);
    glBindBuffer(GL_ARRAY_BUFFER, light.vertices);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(ShadowVertex), nullptr);
    glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(ShadowVertex),
                          // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset
                          reinterpret_cast<const void*>(sizeof(glm::vec2)));
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glDrawArrays(GL_TRIANGLES, 0, light.count);
    glDisableVertexAttribArray(0);
    glDisableVertexAttribArray(1);
  }
}

std::vector<std::uint8_t> read_mask(const GlShadows& shadows, std::span<const std::uint8_t> dark) {
  std::vector<std::uint8_t> mask{dark.begin(), dark.end()};
  for (std::size_t i = 0; i < shadows.lights.size(); ++i) {
    const Image drawn = read_colour(shadows.lights[i].target, 0);
    const auto bit = static_cast<std::uint8_t>(1u << i);
    for (int y = 0; y < shadows.height; ++y) {
      const auto from = row<float>(drawn, y);
      std::uint8_t* to =
          mask.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(shadows.width);
      for (std::size_t x = 0; x < from.size(); ++x) {
        if (from[x] != 0.0f) to[x] = static_cast<std::uint8_t>(to[x] | bit);
      }
    }
  }
  return mask;
}

}  // namespace softfocus
