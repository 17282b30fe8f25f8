#pragma once
// OpenGL without a display: a context on one driver, current in the thread that made it, by EGL
// (egl_context.cpp), on the emulated GPU (context.cpp) or in a browser by WebGL2 (web_context.cpp).
// No window, no default framebuffer: everything is drawn into textures.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "raster/numbers/profile.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

class EmulatedContext;

/// Whether this build opens the machine's drivers.
bool has_egl();

class GlContext {
 public:
  /// Opens the driver, setting the environment in which it is found: only the first
  /// driver of a process counts. `threads` is for llvmpipe and the emulated GPU; without it, they
  /// take all of the machine's. `profile` is what the emulated GPU draws by; `spirv` a folder that
  /// it writes what it compiles to, and a build without glslang reads from. Throws DriverError if
  /// there is no EGL, no such driver, or if its GL is older than 3.3. In a browser there is one
  /// driver, whatever `driver` says.
  explicit GlContext(const Driver& driver, std::optional<int> threads = {},
                     const Profile& profile = {}, const std::filesystem::path& spirv = {});
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const std::string& renderer() const { return renderer_; }  ///< GL_RENDERER
  const std::string& version() const { return version_; }    ///< GL_VERSION

  /// The beginning of every shader: its version, the precision that GLSL ES needs, and a meaning
  /// for `precise`, which GLSL has from 4.00 on.
  const std::string& shader_header() const { return shader_header_; }

  /// Whether varyings can be linear in the window, as WebGL2's need not: without it,
  /// `noperspective` means nothing to shaders.
  bool has_linear_varyings() const { return has_linear_varyings_; }

  /// Whether shaders can compute in binary64: OpenGL 4.0, or GL_ARB_gpu_shader_fp64.
  bool has_doubles() const { return has_doubles_; }

  /// What has been linked here, by its source: a driver takes longer to compile than to draw.
  std::map<std::string, unsigned>& programs() const { return programs_; }

  /// Whether a browser has taken the driver away: nothing works from then on.
  bool is_lost() const;

 private:
#ifdef SOFTFOCUS_WEBGL
  int context_ = 0;
#else
  void* display_ = nullptr;  // EGL's
  void* context_ = nullptr;
  std::unique_ptr<EmulatedContext> emulated_;
#endif
  bool has_linear_varyings_ = true;
  bool has_doubles_ = false;
  std::string renderer_;
  std::string version_;
  std::string shader_header_;
  mutable std::map<std::string, unsigned> programs_;

#ifndef SOFTFOCUS_WEBGL
  void open_by_egl(const Driver& driver, std::optional<int> threads);
  bool open(void* display);
#endif
  void close();
};

#ifndef SOFTFOCUS_WEBGL
inline bool GlContext::is_lost() const { return false; }
#endif

}  // namespace softfocus
