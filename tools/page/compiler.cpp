// GLSL's compiler as a WebAssembly module of its own, which the page loads with its tab.

#include <exception>
#include <string>

#include "raster/shaders/glsl/glsl.h"
#include "tools/page/compiled_shader.h"

namespace {

std::string& reply() {
  static std::string the_reply;
  return the_reply;
}

}  // namespace

extern "C" {

/// Compiles a fragment shader, both texts in UTF-8 that end with a 0. Returns JSON that ends with a
/// 0: compiled_json(), or {"error": "NAME:LINE: ..."}.
const char* softfocus_compile(const char* name, const char* text) {
  const softfocus::GlslSource source{.name = name, .text = text};
  try {
    const auto none = [](const std::string&) { return std::optional<std::string>{}; };
    reply() = json_text(softfocus::compiled_json(softfocus::compile_glsl(source, none)));
  } catch (const std::exception& error) {
    reply() = json_text(softfocus::Json{{"error", error.what()}});
  }
  return reply().c_str();
}
}
