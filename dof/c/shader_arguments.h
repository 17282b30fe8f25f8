#pragma once
// What C programs hand over to shaders, checked: texels, samplers, vertices, targets. All throw
// BadArgument.

#include <cstdint>
#include <string>
#include <vector>

#include "dof/c/settings.h"
#include "raster/images/image_view.h"
#include "raster/shaders/shader.h"

namespace softfocus {

/// Texels to read for that sampler, slice by slice.
std::vector<ImageView> read_slices(const std::string& name, const softfocus_texels* texels,
                                   const ShaderUniform& sampler);

/// How a texture is sampled, without the texture.
ShaderTexture read_sampler(const softfocus_sampler* sampler);

struct ReadVertices {
  std::vector<VertexAttribute> attributes{};  ///< location by location
  std::vector<std::uint32_t> indices{};
  std::uint32_t count = 0;
};

/// Vertices for a vertex shader.
ReadVertices read_vertices(const softfocus_vertices* vertices, const SpirvModule& shader);

struct ReadPass {
  std::vector<ImageView> targets{};  ///< by location
  Profile profile{};
  std::uint64_t budget = ShaderPass{}.budget;
};

ReadPass read_pass(const softfocus_pass* pass);

}  // namespace softfocus
