#pragma once
// A user's fragment shaders on a picture: `apply --shader`.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "raster/images/image.h"
#include "raster/shaders/glsl/glsl.h"
#include "raster/shaders/shader.h"
#include "tools/cli/parser.h"

namespace softfocus {

struct ShaderOptions {
  std::vector<std::string> files{};            ///< GLSL or SPIR-V, one after the other
  std::vector<std::string> settings{};         ///< NAME=NUMBER,...
  std::vector<std::string> textures{};         ///< NAME=FILE
  std::optional<std::string> pipeline{};       ///< behind them
  std::optional<GlslConvention> convention{};  ///< none: recognised
  std::map<std::string, std::string> defines{};
  std::vector<std::string> include_folders{};
};

/// Adds --shader, --pipeline, --set, --texture, --convention, --define and --include.
void add_shader_options(CLI::App& parser, ShaderOptions& options);

/// The files of the shaders, of their textures and of the pipeline.
std::vector<std::string> shader_inputs(const ShaderOptions& options);

/// The picture, RGBA16F with its depth in alpha, behind the shaders. A shader by a convention gets
/// and gives sRGB codes of 8 bits, the lowest row first, as a browser has them; others get and give
/// the picture as it is. The depth stays. Throws UsageError, FileError, SceneError,
/// ShaderError.
Image with_shaders(const ShaderOptions& options, Image picture, const Profile& profile,
                   ThreadPool& pool);

}  // namespace softfocus
