#pragma once
// A surface by a user's shaders: what they are given of the scene, by name (docs/shaders.md).

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "raster/shaders/draw_shaders.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

/// A texture that a shader reads.
struct ShaderSurfaceTexture {
  std::uint32_t texture = 0;  ///< of the scene's
  Sampler sampler{};
  bool is_there = false;
};

struct SurfaceShader {
  std::shared_ptr<const ShaderProgram> program{};
  ShaderUniforms uniforms{};                     ///< their words as the scene's file sets them
  std::vector<ShaderSurfaceTexture> textures{};  ///< by their numbers
};

/// A material's, linked.
struct SurfaceShaders {
  SurfaceShader vertex{}, fragment{};
  std::vector<ShaderPort> attributes{};
};

/// Where a surface stands, in binary64 as draws have it.
struct ShaderSurfaceMatrices {
  glm::dmat4 to_world{1.0}, world_to_eye{1.0}, eye_to_clip{1.0};
  double frame = 0.0;
};

/// What the usual vertex shader is, in GLSL.
std::string_view usual_surface_vertex();

/// The words that the scene gives while it is drawn, of all of a shader's. Throws ShaderError if
/// one of its uniforms has another type.
std::vector<bool> late_words(const ShaderUniforms& uniforms);

/// Throws ShaderError if an attribute of a vertex shader is none that meshes have.
void check_attributes(std::span<const ShaderPort> attributes);

/// A draw with all that the shaders ask for but textures. `width` and `height` are the target's.
ShaderDraw shader_draw(const SurfaceShaders& shaders, const SurfaceVertexInput& input,
                       const ShaderSurfaceMatrices& matrices, int width, int height);

}  // namespace softfocus
