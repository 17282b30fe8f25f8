#pragma once
// Numbers of binary64, and flat shapes by number, for shaders: scenes/shadows/doubles.glsl and
// listed.vert.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/gl/objects.h"

namespace softfocus {

/// Throws DriverError if shaders of the driver have no doubles: `what` needs them.
void require_doubles(const GlContext& context, const std::string& what);

/// Two numbers in a texel of words.
glm::uvec4 texel_of_doubles(double first, double second);
glm::uvec2 words_of(double value);

/// A list that runs along the texture's rows; the last one ends in zeros.
GlTexture upload_list(std::vector<glm::uvec4> texels);
/// An image of rows without gaps.
GlTexture upload_words(std::span<const glm::uvec4> texels, int width, int height);

/// A corner of a triangle in normalised device coordinates, and the number of its shape.
struct ListedVertex {
  glm::vec2 position;
  float number;  ///< whole, below 2^24
};

/// Three for each triangle.
struct GlListed {
  GlBuffer buffer;
  GLsizei count = 0;
};
GlListed upload_listed(std::span<const ListedVertex> vertices);

/// All triangles, by the program in use, into the target and viewport that are bound.
void draw_listed(const GlListed& listed);

}  // namespace softfocus
