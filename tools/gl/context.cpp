#include "tools/gl/context.h"

#include <dlfcn.h>
#include <epoxy/gl.h>

#include <array>
#include <cstdlib>
#include <initializer_list>
#include <string_view>

namespace softfocus {
namespace {

// libepoxy ends the program when it finds no library; asked first, a line can say so.
void require_library(std::initializer_list<const char*> any_of, const char* package) {
  for (const char* name : any_of) {
    if (::dlopen(name, RTLD_NOW | RTLD_GLOBAL) != nullptr) return;
  }
  throw DriverError(std::string("no ") + *any_of.begin() + " on this machine; Debian's package " +
                    package + " has it");
}

bool has_word(const char* words, std::string_view word) {
  if (words == nullptr) return false;
  const std::string all = ' ' + std::string(words) + ' ';
  return all.find(' ' + std::string(word) + ' ') != std::string::npos;
}

bool is_software(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    if (renderer.find(name) != std::string::npos) return true;
  }
  return false;
}

// Only the first driver of a process counts: Mesa reads these once.
void set_environment(const Driver& driver) {
  for (const auto& [name, value] : driver.environment) {
    if (value != nullptr) {
      ::setenv(name, value, 1);
    } else {
      ::unsetenv(name);
    }
  }
}

struct GlVersion {
  int major;
  int minor;
};

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

bool GlContext::open(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    return false;
  }
  display_ = display;
  if (eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) return false;
  for (const GlVersion version : {GlVersion{4, 5}, GlVersion{4, 0}, GlVersion{3, 3}}) {
    const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                           version.major,
                                           EGL_CONTEXT_MINOR_VERSION,
                                           version.minor,
                                           EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                           EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                           EGL_NONE};
    context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context_ == EGL_NO_CONTEXT) continue;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE)
      return false;
    renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    version_ = reinterpret_cast<const char*>(glGetString(GL_VERSION));
    shader_header_ =
        version.major >= 4
            ? "#version " + std::to_string(version.major * 100 + version.minor * 10) + " core\n"
            : "#version 330 core\n#define precise\n";
    return true;
  }
  return false;
}

void GlContext::close() {
  if (display_ == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  eglTerminate(display_);
  display_ = EGL_NO_DISPLAY;
  context_ = EGL_NO_CONTEXT;
}

GlContext::GlContext(const Driver& driver) {
  require_library({"libEGL.so.1"}, "libegl1");
  require_library({"libOpenGL.so.0", "libGL.so.1"}, "libgl1");
  set_environment(driver);
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (!driver.renderer.empty()) {
    if (!has_word(extensions, "EGL_MESA_platform_surfaceless")) {
      throw DriverError(
          "EGL has no EGL_MESA_platform_surfaceless; Debian's packages "
          "libegl-mesa0 and libgl1-mesa-dri have the software drivers");
    }
    if (!open(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY,
                                       nullptr))) {
      close();
      throw DriverError(
          "no OpenGL 3.3 core context from Mesa; Debian's package "
          "libgl1-mesa-dri has its drivers");
    }
    if (!renderer_.starts_with(driver.renderer)) {
      const std::string got = renderer_;
      close();
      throw DriverError("EGL gave '" + got + "' instead");
    }
  } else {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (has_word(extensions, "EGL_EXT_device_enumeration") ||
        has_word(extensions, "EGL_EXT_device_base")) {
      eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
    }
    std::string seen;
    for (EGLint i = 0; i < count && context_ == EGL_NO_CONTEXT; ++i) {
      const bool opened = open(eglGetPlatformDisplayEXT(
          EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], nullptr));
      if (opened && !is_software(renderer_)) break;
      if (opened) seen += (seen.empty() ? "" : ", ") + renderer_;
      close();
    }
    if (context_ == EGL_NO_CONTEXT) {
      throw DriverError("EGL lists no hardware GPU with OpenGL 3.3" +
                        (seen.empty() ? "" : " (only " + seen + ")"));
    }
  }
  set_defaults();
}

GlContext::~GlContext() { close(); }

}  // namespace softfocus
