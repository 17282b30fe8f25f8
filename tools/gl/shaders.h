#pragma once
// The project's GLSL. The files lie beside the C++ that they mirror, and are compiled
// into the program; a folder of the user's can stand in for some of them.

#include <filesystem>
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

/// Where shaders are taken from.
struct Shaders {
  /// Files here take the place of the built-in ones of the same name; may be empty.
  std::filesystem::path folder;

  /// A shader's text with every line `#include "NAME"` replaced by that shader's. A name
  /// that there is not is a DriverError.
  std::string source(std::string_view name) const;
};

}  // namespace softfocus
