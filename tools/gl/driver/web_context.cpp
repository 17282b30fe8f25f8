#include <emscripten/em_js.h>
#include <emscripten/html5_webgl.h>

#include "tools/gl/driver/api.h"
#include "tools/gl/driver/context.h"

// A canvas of the worker's own, under a name for emscripten's functions. Nothing is drawn into it.
EM_JS(int, softfocus_make_canvas, (), {
  if (typeof OffscreenCanvas == "undefined") return 0;
  specialHTMLTargets["!softfocus"] = new OffscreenCanvas(1, 1);
  return 1;
});

namespace softfocus {
namespace {

constexpr GLenum kUnmaskedRenderer = 0x9246;

std::string string_of(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

EMSCRIPTEN_WEBGL_CONTEXT_HANDLE make_context() {
  EmscriptenWebGLContextAttributes attributes;
  emscripten_webgl_init_context_attributes(&attributes);
  attributes.alpha = false;
  attributes.depth = false;
  attributes.antialias = false;
  attributes.powerPreference = EM_WEBGL_POWER_PREFERENCE_HIGH_PERFORMANCE;
  attributes.majorVersion = 2;
  attributes.enableExtensionsByDefault = false;
  return emscripten_webgl_create_context("!softfocus", &attributes);
}

}  // namespace

GlContext::GlContext(const Driver& /*driver*/, std::optional<int> /*threads*/,
                     const Profile& /*profile*/, const std::filesystem::path& /*spirv*/) {
  if (softfocus_make_canvas() == 0) {
    throw DriverError("no WebGL2 here: workers of this browser have no OffscreenCanvas");
  }
  const EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = make_context();
  if (context <= 0) {
    throw DriverError("no WebGL2 here: the browser has none, or it is switched off");
  }
  context_ = static_cast<int>(context);
  emscripten_webgl_make_context_current(context);
  const auto enable = [&](const char* extension) {
    return emscripten_webgl_enable_extension(context, extension) != 0;
  };
  if (!enable("EXT_color_buffer_float")) {
    close();
    throw DriverError("WebGL2 is here without EXT_color_buffer_float: it draws into no floats");
  }
  enable("EXT_float_blend");
  has_linear_varyings_ = enable("NV_shader_noperspective_interpolation");
  // Browsers that hide the GPU's name give one of their own.
  if (enable("WEBGL_debug_renderer_info")) renderer_ = string_of(kUnmaskedRenderer);
  if (renderer_.empty()) renderer_ = string_of(GL_RENDERER);
  version_ = string_of(GL_VERSION);
  if (constexpr std::string_view kName = "OpenGL "; version_.starts_with(kName)) {
    version_.erase(0, kName.size());
  }
  shader_header_ = "#version 300 es\n";
  shader_header_ += has_linear_varyings_
                        ? "#extension GL_NV_shader_noperspective_interpolation : require\n"
                        : "#define noperspective\n";
  shader_header_ +=
      "precision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
      "#define precise\n";
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glDisable(GL_DITHER);
}

void GlContext::close() {
  for (const auto& linked : programs_) glDeleteProgram(linked.second);
  if (context_ != 0) emscripten_webgl_destroy_context(context_);
  context_ = 0;
}

bool GlContext::is_lost() const { return emscripten_is_webgl_context_lost(context_) != 0; }

GlContext::~GlContext() { close(); }

}  // namespace softfocus
