#include "tools/gl/doubles_on_gl.h"

#include <algorithm>
#include <bit>

namespace softfocus {

void require_doubles(const GlContext& context, const std::string& what) {
  if (context.has_doubles()) return;
  throw DriverError(what + " needs doubles in shaders, GL_ARB_gpu_shader_fp64, which " +
                    context.renderer() + " does not have");
}

glm::uvec2 words_of(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

glm::uvec4 texel_of_doubles(double first, double second) {
  return {words_of(first), words_of(second)};
}

GlTexture upload_words(std::span<const glm::uvec4> texels, int width, int height) {
  GLuint name = 0;
  glGenTextures(1, &name);
  GlTexture texture{name};
  glActiveTexture(GL_TEXTURE15);  // no program's
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, width, height, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT,
               texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  return texture;
}

GlTexture upload_list(std::vector<glm::uvec4> texels) {
  constexpr std::size_t kAcross = 2048;
  const std::size_t rows = std::max<std::size_t>((texels.size() + kAcross - 1) / kAcross, 1);
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (rows > static_cast<std::size_t>(most)) {
    throw DriverError("a list of " + std::to_string(texels.size()) + " texels; " +
                      std::to_string(static_cast<std::size_t>(most) * kAcross) + " would fit");
  }
  texels.resize(rows * kAcross);
  return upload_words(texels, static_cast<int>(kAcross), static_cast<int>(rows));
}

GlListed upload_listed(std::span<const ListedVertex> vertices) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  GlListed listed{GlBuffer{name}, static_cast<GLsizei>(vertices.size())};
  glBindBuffer(GL_ARRAY_BUFFER, listed.buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_STATIC_DRAW);
  return listed;
}

void draw_listed(const GlListed& listed) {
  glBindBuffer(GL_ARRAY_BUFFER, listed.buffer);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(ListedVertex), nullptr);
  glVertexAttribPointer(1, 1, GL_FLOAT, GL_FALSE, sizeof(ListedVertex),
                        // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset
                        reinterpret_cast<const void*>(sizeof(glm::vec2)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glDrawArrays(GL_TRIANGLES, 0, listed.count);
  glDisableVertexAttribArray(0);
  glDisableVertexAttribArray(1);
}

}  // namespace softfocus
