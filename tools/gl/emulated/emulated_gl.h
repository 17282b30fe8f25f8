#pragma once
// The emulated GPU as an OpenGL driver: as much of OpenGL as tools/gl calls, over raster/. Shaders
// are compiled and run as anybody's (raster/shaders), by a profile that is given. Row 0 of a
// texture is OpenGL's lowest, so that nothing is turned over.
//
// Left out, and refused by an error: points in viewports other than the whole target.

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec4.hpp>

#include "raster/images/sampler.h"
#include "raster/pipeline/state.h"
#include "raster/shaders/link_shaders.h"
#include "raster/threads/parallel.h"
#include "tools/gl/driver/api.h"

namespace softfocus {

inline constexpr std::size_t kEmulatedUnits = 16;

struct EmulatedTexture {
  Texture texture{};
  Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
};

struct EmulatedFramebuffer {
  struct Attached {
    GLuint texture = 0;
    int level = 0;
  };
  std::array<Attached, kMaxColourTargets> colour{};
  Attached depth{};
  std::size_t read = 0;
};

struct EmulatedShader {
  ShaderStage stage{};
  std::string text{}, log{};
  std::vector<std::uint32_t> words{};  ///< SPIR-V; none: it was refused
};

/// A stage of a program.
struct EmulatedStage {
  std::vector<std::uint32_t> words{};  ///< SPIR-V of what is attached
  UserShader shader{};                 ///< linked
  std::vector<std::uint32_t> uniforms{};
  std::vector<bool> is_late{};  ///< of the uniforms, all but the numbers of textures
  struct Compiled {
    std::vector<std::uint32_t> uniforms{};  ///< that it was compiled for
    std::shared_ptr<const ShaderProgram> program{};
  };
  /// For all uniforms, and for those that are not late. Searched by ==: on big-endian machines
  /// libstdc++'s < of std::vectors of words compares too few bytes.
  std::vector<Compiled> compiled[2]{};
};

/// A uniform, from an element of an array on.
struct EmulatedUniform {
  std::array<std::optional<std::uint32_t>, 2> first{};  ///< its word in either stage
  std::uint32_t words = 0;
  std::uint32_t each = 1;  ///< words that have the same number: a texture and its sampler
  bool is_boolean = false;
};

struct EmulatedProgram {
  std::array<EmulatedStage, 2> stages{};  ///< vertex, fragment
  std::string log{};
  bool is_linked = false;
  std::vector<EmulatedUniform> uniforms{};  ///< by location
  std::map<std::string, GLint, std::less<>> locations{};
};

struct EmulatedAttribute {
  bool is_enabled = false;
  GLuint buffer = 0;
  int components = 4;
  std::size_t offset = 0, stride = 0;
};

struct EmulatedGl {
  EmulatedGl(const Profile& of, int threads, std::filesystem::path folder)
      : profile(of), pool(threads), spirv(std::move(folder)) {}

  Profile profile;
  ThreadPool pool;
  std::filesystem::path spirv;  ///< of what is compiled; empty: none is kept
  GLenum error = GL_NO_ERROR;
  GLuint last_name = 0;

  std::map<GLuint, EmulatedTexture> textures{};
  std::map<GLuint, std::vector<std::byte>> buffers{};
  std::map<GLuint, EmulatedFramebuffer> framebuffers{};
  std::map<GLuint, EmulatedShader> shaders{};
  std::map<GLuint, EmulatedProgram> programs{};

  std::size_t unit = 0;
  std::array<GLuint, kEmulatedUnits> units{};
  GLuint framebuffer = 0, array_buffer = 0, element_buffer = 0, program = 0;
  std::array<EmulatedAttribute, 16> attributes{};

  bool tests_depth = false, culls = false, blends = false;
  DepthState depth{};
  Cull faces = Cull::back;
  FrontFace front = FrontFace::clockwise;  ///< as seen with row 0 on top
  BlendEquation blend{BlendFactor::one, BlendFactor::zero, BlendOp::add};
  glm::vec4 clear_colour{0.0f};
  float clear_depth = 1.0f;
  std::array<int, 4> viewport{};
};

/// Opened for the calls of this thread until it is destroyed.
class EmulatedContext {
 public:
  EmulatedContext(const Profile& profile, int threads, const std::filesystem::path& spirv);
  ~EmulatedContext();
  EmulatedContext(const EmulatedContext&) = delete;
  EmulatedContext& operator=(const EmulatedContext&) = delete;

 private:
  std::unique_ptr<EmulatedGl> gl_;
};

// NOLINTBEGIN(readability-identifier-naming): OpenGL's names
namespace emulated {

/// The context that is current.
EmulatedGl& gl();
/// The program in use.
EmulatedProgram& program_in_use();
/// A stage for its uniforms as they are, or for any: then they are given as it runs, slower.
std::shared_ptr<const ShaderProgram> compiled(EmulatedStage& stage, bool for_any);
/// The SPIR-V of a text, by the name in its errors. Throws ShaderError.
std::vector<std::uint32_t> spirv_of(ShaderStage stage, const std::string& text,
                                    const std::string& name);
/// The level of a texture that is attached, or null.
Image* image_of(const EmulatedFramebuffer::Attached& attached);

#define SOFTFOCUS_GL_DECLARE(RESULT, NAME, PARAMETERS, ARGUMENTS) RESULT NAME PARAMETERS;
SOFTFOCUS_GL_FUNCTIONS(SOFTFOCUS_GL_DECLARE)
#undef SOFTFOCUS_GL_DECLARE

}  // namespace emulated
// NOLINTEND(readability-identifier-naming)

}  // namespace softfocus
