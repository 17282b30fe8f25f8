#pragma once
// The project's GLSL. The files lie beside the C++ that they mirror, and are compiled
// into the program; a user's files can replace some of them.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

struct Shader {
  std::string_view name;    ///< the file's name without its folder: "two_pass.frag"
  std::string_view source;  ///< as it stands in the project
};

/// Every shader, by name. Defined in a file that the build makes.
const std::vector<Shader>& built_in_shaders();

/// The methods that have a shader: two-pass and one-pass; pinhole needs none.
bool has_shader(std::string_view method);

/// The sources of shaders: the user's, by name, then the built-in ones.
struct Shaders {
  std::map<std::string, std::string, std::less<>> own;
  std::filesystem::path folder;  ///< of the user's; empty if there are none
};

/// The shaders in a folder: those of the built-in ones' names, and any *.glsl that they
/// include. Throws SceneError if a file cannot be read, if a .vert or .frag replaces
/// no built-in one, or if the folder has no shaders.
Shaders read_shaders(const std::filesystem::path& folder);

/// What a compiler gets, and the files that it is of, by the number that a #line directive has.
struct ShaderSource {
  std::string text;
  std::vector<std::string> files;
};

/// A shader's text with every line `#include "NAME"` replaced by that shader's, and #line
/// directives, so that a compiler's message has the file's own line. Throws DriverError if there
/// is no such name, ShaderError if a shader includes itself.
ShaderSource shader_source(const Shaders& shaders, std::string_view name);

/// The first error in a compiler's log, with its file's name for the number: "1:12(3): error: no"
/// becomes "weights.glsl:12(3): error: no".
std::string first_error(std::string_view log, const std::vector<std::string>& files);

/// The shaders that a frame is drawn by and, but for pinhole, filtered by: `render --gl`.
std::vector<std::string_view> frame_shaders(std::string_view method);

/// Whether some of the user's shaders differ from the built-in ones, and none of these has a part
/// in the shaders named, includes and all.
bool has_no_part(const Shaders& shaders, const std::vector<std::string_view>& names);

}  // namespace softfocus
