#pragma once
// A draw whose stages are a user's shaders: draw() (pipeline/draw.h) with the shaders run over
// lanes. Clipping, set-up, interpolation, tests and merge are the pipeline's own, and so are the
// bits.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "raster/pipeline/render_pass.h"
#include "raster/shaders/link_shaders.h"
#include "raster/shaders/shader.h"

namespace softfocus {

/// Which way a vertex shader's y points.
enum class ShaderClipSpace : std::uint8_t {
  /// As in OpenGL: upwards. gl_FragCoord.y counts from the lowest row, and dFdy is upwards.
  y_up,
  /// As in softfocus: downwards, row 0 on top.
  y_down,
};

/// What target 0 gets in place of the fragment shader's colour and alpha.
struct ShaderTexel {
  std::optional<glm::vec3> colour{};
  /// Colour is multiplied by it, and alpha is this.
  std::optional<float> opacity{};
  /// Alpha is clip w, interpolated, or this if it is less.
  std::optional<float> most_w{};
};

struct ShaderDraw {
  /// Linked (link_shaders.h) before they were compiled.
  std::shared_ptr<const ShaderProgram> vertex{}, fragment{};
  /// All words of each, for programs with late ones (compile_shader()).
  std::vector<std::uint32_t> vertex_uniforms{}, fragment_uniforms{};
  std::vector<VertexAttribute> attributes{};  ///< others are 0, 0, 0, 1
  std::vector<ShaderTexture> vertex_textures{}, fragment_textures{};
  ShaderClipSpace clip_space = ShaderClipSpace::y_up;
  std::optional<Rectangle> viewport{};  ///< in the picture; may reach beyond it; none: all of it
  ShaderTexel texel{};
  std::uint64_t budget = std::uint64_t{1} << 24;  ///< as ShaderPass has it
  int lanes = 0;                                  ///< likewise
};

/// Numbers that may go from a vertex shader to a fragment shader.
inline constexpr std::size_t kMostShaderVaryings = 64;

/// Records a draw of indices.size() / 3 triangles. What attributes and `indices` point to, and the
/// textures, must live until finish(), which throws ShaderError if a loop takes more turns than the
/// budget has. Needs what draw() needs. A target that the fragment shader has no output for stays
/// as it is. Throws ShaderError if the shaders exchange too many numbers.
void draw_shaders(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
                  std::uint32_t vertex_count, const ShaderDraw& draw);

}  // namespace softfocus
