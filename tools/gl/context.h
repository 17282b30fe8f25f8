#pragma once
// OpenGL without a display: an EGL context on one driver, current in the thread that
// made it. No window, no default framebuffer: everything is drawn into textures.

#include <epoxy/egl.h>

#include <optional>
#include <string>

#include "tools/gl/driver.h"

namespace softfocus {

class GlContext {
 public:
  /// Opens the driver, setting the environment in which it is found: only the first
  /// driver of a process counts. `threads` is for llvmpipe; without it, it takes all of the
  /// machine's. Throws DriverError if there is no EGL, no such driver, or if its
  /// GL is older than 3.3.
  explicit GlContext(const Driver& driver, std::optional<int> threads = {});
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const std::string& renderer() const { return renderer_; }  ///< GL_RENDERER
  const std::string& version() const { return version_; }    ///< GL_VERSION

  /// What every shader begins with: its version, and a meaning for `precise`, which
  /// GLSL has from 4.00 on.
  const std::string& shader_header() const { return shader_header_; }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string renderer_;
  std::string version_;
  std::string shader_header_;

  bool open(EGLDisplay display);
  void close();
};

}  // namespace softfocus
