#include "tools/gl/driver/context.h"

#include "raster/shaders/glsl/glsl.h"
#include "tools/gl/driver/api.h"
#include "tools/gl/emulated/emulated_gl.h"

namespace softfocus {
namespace {

// Hidden state that would differ between drivers is set as softfocus has it.
void set_defaults() {
  GLuint vertex_array = 0;
  glGenVertexArrays(1, &vertex_array);
  glBindVertexArray(vertex_array);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glDisable(GL_DITHER);
}

}  // namespace

GlContext::GlContext(const Driver& driver, std::optional<int> threads, const Profile& profile,
                     const std::filesystem::path& spirv) {
  if (!driver.is_emulated) {
    open_by_egl(driver, threads);
  } else {
    if (spirv.empty() && !missing_glsl().empty()) throw DriverError(std::string{missing_glsl()});
    emulated_ =
        std::make_unique<EmulatedContext>(profile, threads.value_or(hardware_threads()), spirv);
    renderer_ = "softfocus";
    version_ = "4.5";
    shader_header_ = "#version 450 core\n";
    has_doubles_ = true;
  }
  set_defaults();
}

GlContext::~GlContext() { close(); }

}  // namespace softfocus
