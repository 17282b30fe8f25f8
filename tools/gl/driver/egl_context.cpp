
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <unistd.h>

#include "tools/gl/driver/context.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/driver/functions.h"

namespace softfocus {
namespace {

using Paths = std::vector<std::filesystem::path>;

// The paths of a list such as "/usr/local/share:/usr/share"; `otherwise` stands for a variable that
// is not set.
Paths paths_in(const char* variable, const std::string& otherwise) {
  const char* const set = std::getenv(variable);
  std::istringstream list{set != nullptr && *set != '\0' ? set : otherwise};
  Paths paths;
  for (std::string path; std::getline(list, path, ':');) {
    if (!path.empty()) paths.emplace_back(path);
  }
  return paths;
}

bool is_lavapipe(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::error_code unknown;
  return name.starts_with("lvp_icd") && name.ends_with(".json") &&
         std::filesystem::exists(file, unknown);
}

Paths user_files() {
  Paths files;
  for (const char* variable : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {
    const Paths named = paths_in(variable, "");
    std::copy_if(named.begin(), named.end(), std::back_inserter(files), is_lavapipe);
  }
  return files;
}

// A machine with two word sizes has a file for each. The loader takes what fits the process.
Paths files_in(const Paths& folders) {
  Paths files;
  for (const std::filesystem::path& folder : folders) {
    std::error_code unknown;
    for (const auto& entry : std::filesystem::directory_iterator{folder, unknown}) {
      if (is_lavapipe(entry.path())) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Paths standard_folders() {
  const char* const home = std::getenv("HOME");
  Paths roots =
      paths_in("XDG_DATA_HOME", home != nullptr ? std::string{home} + "/.local/share" : "");
  for (const auto& root : paths_in("XDG_DATA_DIRS", "/usr/local/share:/usr/share")) {
    roots.push_back(root);
  }
  roots.emplace_back("/etc");
  for (auto& root : roots) root /= "vulkan/icd.d";
  return roots;
}

std::string joined(const Paths& paths, const char* between) {
  std::string text;
  for (const auto& path : paths) text += (text.empty() ? "" : between) + path.string();
  return text;
}

/// The files (lvp_icd.json, lvp_icd.x86_64.json ...) by which Vulkan's loader finds lavapipe, for
/// VK_ICD_FILENAMES: those that the user's VK_DRIVER_FILES or VK_ICD_FILENAMES name, else those in
/// the loader's standard folders. Throws DriverError if there is none.
std::string lavapipe_files() {
  Paths files = user_files();
  if (!files.empty()) return joined(files, ":");
  const Paths folders = standard_folders();
  files = files_in(folders);
  if (files.empty()) {
    throw DriverError("no lvp_icd*.json in " + joined(folders, ", ") +
                      "; Debian's package mesa-vulkan-drivers has it");
  }
  return joined(files, ":");
}

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

bool is_software_renderer(const std::string& renderer) {
  for (const char* name : {"llvmpipe", "softpipe", "swrast", "SwiftShader", "Software"}) {
    if (renderer.find(name) != std::string::npos) return true;
  }
  return false;
}

// Mesa reads its variables once: only the first driver of a process counts. Whatever
// the user has set would change what a software driver computes, and goes; all but
// where drivers are found. No shader compiled for another CPU comes out of a cache.
void set_environment(const Driver& driver, std::optional<int> threads) {
  static constexpr std::array<std::string_view, 13> kPrefixes{
      "MESA_", "GALLIUM_", "GALLIVM_", "LP_",   "DRAW_", "SOFTPIPE_", "NIR_",
      "ST_",   "TGSI_",    "LIBGL_",   "ZINK_", "LVP_",  "VK_"};
  const std::string vulkan_files = driver.on_lavapipe ? lavapipe_files() : "";
  std::vector<std::string> names;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const std::string_view name = text.substr(0, text.find('='));
    if (name == "LIBGL_DRIVERS_PATH") continue;
    for (const std::string_view prefix : kPrefixes) {
      if (name.starts_with(prefix)) names.emplace_back(name);
    }
  }
  for (const std::string& name : names) ::unsetenv(name.c_str());
  ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  ::setenv("GALLIUM_DRIVER", std::string(driver.gallium_driver).c_str(), 1);
  if (!vulkan_files.empty()) {
    ::setenv("VK_ICD_FILENAMES", vulkan_files.c_str(), 1);
    // Mesa's layer that picks a device asks for displays, and libwayland complains if there is
    // none.
    ::setenv("NODEVICE_SELECT", "1", 1);
  }
  if (threads) {
    // Beside the calling one, which then waits; 0: the calling one does it all.
    const int beside = *threads == 1 ? 0 : *threads;
    ::setenv("LP_NUM_THREADS", std::to_string(beside).c_str(), 1);
  }
  if (!driver.cpu_caps.empty()) {
    ::setenv("GALLIUM_OVERRIDE_CPU_CAPS", std::string(driver.cpu_caps).c_str(), 1);
  }
}

// By way of libepoxy's names, which are variables: the first call looks the driver's function up.
#define SOFTFOCUS_GL_CALL(RESULT, NAME, PARAMETERS, ARGUMENTS) \
  RESULT call##NAME PARAMETERS { return gl##NAME ARGUMENTS; }
SOFTFOCUS_GL_FUNCTIONS(SOFTFOCUS_GL_CALL)
#undef SOFTFOCUS_GL_CALL

#define SOFTFOCUS_GL_FILL(RESULT, NAME, PARAMETERS, ARGUMENTS) .NAME = call##NAME,
constexpr GlFunctions kEpoxyFunctions{SOFTFOCUS_GL_FUNCTIONS(SOFTFOCUS_GL_FILL)};
#undef SOFTFOCUS_GL_FILL

struct GlVersion {
  int major;
  int minor;
};

std::string string_of(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text != nullptr ? reinterpret_cast<const char*>(text) : "unnamed";
}

}  // namespace

bool has_egl() { return true; }

bool GlContext::open(void* display) {
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) {
    return false;
  }
  display_ = display;
  current_gl() = &kEpoxyFunctions;
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
    renderer_ = string_of(GL_RENDERER);
    version_ = string_of(GL_VERSION);
    shader_header_ =
        version.major >= 4
            ? "#version " + std::to_string(version.major * 100 + version.minor * 10) + " core\n"
            : "#version 330 core\n#define precise\n";
    has_doubles_ = version.major >= 4 || epoxy_has_gl_extension("GL_ARB_gpu_shader_fp64");
    // llvmpipe of Mesa 25 would add an offset to alpha, by a pixel's place among 2x2.
    if (epoxy_has_gl_extension("GL_NV_alpha_to_coverage_dither_control")) {
      glAlphaToCoverageDitherControlNV(GL_ALPHA_TO_COVERAGE_DITHER_DISABLE_NV);
    }
    return true;
  }
  // Whatever there is, to say what is too old.
  context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, nullptr);
  if (context_ != EGL_NO_CONTEXT &&
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE) {
    renderer_ = string_of(GL_RENDERER);
    version_ = string_of(GL_VERSION);
  }
  return false;
}

void GlContext::close() {
  if (display_ == EGL_NO_DISPLAY) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  // Without eglTerminate: Mesa would unload its driver and leave memory behind that no
  // leak checker can then put a name to. The process's end closes the display.
  display_ = EGL_NO_DISPLAY;
  context_ = EGL_NO_CONTEXT;
}

void GlContext::open_by_egl(const Driver& driver, std::optional<int> threads) {
  require_library({"libEGL.so.1"}, "libegl1");
  require_library({"libOpenGL.so.0", "libGL.so.1"}, "libgl1");
  if (driver.on_lavapipe) require_library({"libvulkan.so.1"}, "libvulkan1");
  if (is_software(driver)) set_environment(driver, threads);
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  if (is_software(driver)) {
    if (!has_word(extensions, "EGL_MESA_platform_surfaceless")) {
      throw DriverError(
          "EGL has no EGL_MESA_platform_surfaceless; Debian's packages "
          "libegl-mesa0 and libgl1-mesa-dri have the software drivers");
    }
    if (!open(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY,
                                       nullptr))) {
      close();
      if (!version_.empty()) {
        throw DriverError(renderer_ + " has OpenGL " + version_ + "; 3.3 core is needed");
      }
      throw DriverError(
          "no OpenGL context from Mesa; Debian's package libgl1-mesa-dri has its drivers");
    }
    if (!renderer_.starts_with(driver.gallium_driver)) {
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
      if (opened && !is_software_renderer(renderer_)) break;
      if (!version_.empty()) {
        seen += (seen.empty() ? "" : ", ") + renderer_ + (opened ? "" : " with " + version_);
      }
      version_.clear();
      close();
    }
    if (context_ == EGL_NO_CONTEXT) {
      throw DriverError("EGL lists no hardware GPU with OpenGL 3.3" +
                        (seen.empty() ? "" : " (only " + seen + ")"));
    }
  }
}

}  // namespace softfocus
