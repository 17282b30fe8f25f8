#pragma once
// GL's objects as values that clean up after themselves, and the ways between them and
// softfocus' images. Nothing here converts a number: what goes up and comes back are
// the image's own bits.

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "raster/images/sampler.h"
#include "raster/shaders/lower_spirv.h"
#include "tools/gl/driver/api.h"
#include "tools/gl/driver/context.h"
#include "tools/gl/shaders.h"

namespace softfocus {

/// Owner of one GL name.
template <void (*destroy)(GLuint)>
class GlName {
 public:
  GlName() = default;
  explicit GlName(GLuint name) : name_(name) {}
  GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlName& operator=(GlName&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlName() {
    if (name_ != 0) destroy(name_);
  }
  operator GLuint() const { return name_; }  // NOLINT(google-explicit-constructor)

 private:
  GLuint name_ = 0;
};

inline void destroy_texture(GLuint name) { glDeleteTextures(1, &name); }
inline void destroy_buffer(GLuint name) { glDeleteBuffers(1, &name); }
inline void destroy_framebuffer(GLuint name) { glDeleteFramebuffers(1, &name); }

using GlTexture = GlName<destroy_texture>;
using GlBuffer = GlName<destroy_buffer>;
using GlFramebuffer = GlName<destroy_framebuffer>;

/// One of its context's programs, which end with the context.
struct GlProgram {
  GLuint name = 0;
  operator GLuint() const { return name; }  // NOLINT(google-explicit-constructor)
};

/// A texture with all its levels; one level is sampled without mipmaps. Cubes are seamless from
/// then on, as OpenGL ES has them.
GlTexture upload(const Texture& texture, const Sampler& sampler);
/// An image for texelFetch.
GlTexture upload(const Image& image);
/// Replaces all levels but the first by what the driver makes of it.
void generate_levels(const GlTexture& texture);
/// A level as an image of the texture's format; the size is the level's.
Image read_level(const GlTexture& texture, Format format, int level, int width, int height);

/// A target of drawing: colour textures of one size, and a depth buffer on request.
struct GlTarget {
  int width = 0;
  int height = 0;
  int samples = 1;
  std::vector<Format> formats;
  GlFramebuffer framebuffer;
  std::vector<GlTexture> colour;
  GlTexture depth;
};
GlTarget make_target(std::span<const Format> formats, int width, int height, bool with_depth,
                     int samples = 1);
/// Binds the target and its viewport.
void bind(const GlTarget& target);
Image read_colour(const GlTarget& target, std::size_t index);
/// The same of a target of several samples, as raster/pipeline/multisample.h has them.
Image read_samples(const GlContext& context, const GlTarget& target, std::size_t index);
/// The means of its first colour's samples, as the driver makes them.
Image read_resolved(const GlTarget& target);
/// Copies its first colour into a texture of its size and format, as programs had to before there
/// were frame-buffer objects.
void copy_colour(const GlTarget& target, const GlTexture& to);
/// By way of a shader: WebGL2 reads no depth. Of several samples as read_samples().
Image read_depth(const GlContext& context, const GlTarget& target);
/// Returns when all that draws into it has been done: its first pixel is there. A browser's
/// glFinish() does not wait.
void wait_for(const GlTarget& target);

/// Compiles and links two of the project's shaders (tools/gl/shaders.h). `defines` come
/// after the version line. A context has one program of one text: its uniforms are as the last user
/// left them. Throws ShaderError with the driver's first message.
GlProgram link_program(const GlContext& context, const Shaders& shaders, std::string_view vertex,
                       std::string_view fragment, const std::string& defines = {});

/// The same of texts that have their version; `files` are for errors.
GlProgram link_texts(const GlContext& context, const ShaderSource& vertex,
                     const ShaderSource& fragment);

/// Uniforms of the program in use; one that the compiler dropped is passed over.
void set_uniform(const GlProgram& program, const char* name, int value);
void set_uniform(const GlProgram& program, const char* name, float value);
void set_uniform(const GlProgram& program, const char* name, glm::ivec2 value);
void set_uniform(const GlProgram& program, const char* name, glm::vec2 value);
void set_uniform(const GlProgram& program, const char* name, glm::vec3 value);
void set_uniform(const GlProgram& program, const char* name, glm::vec4 value);
void set_uniform(const GlProgram& program, const char* name, std::span<const float> values);
void set_uniform(const GlProgram& program, const char* name, const glm::mat3& value);
void set_uniform(const GlProgram& program, const char* name, const glm::mat4& value);
/// By its words, as ShaderUniforms has them.
void set_uniform(const GlProgram& program, const ShaderUniform& of,
                 std::span<const std::uint32_t> words);
/// How a texture is sampled from now on.
void set_sampler(const GlTexture& texture, const Sampler& sampler,
                 TextureShape shape = TextureShape::flat);
/// Binds a texture to a unit and the sampler uniform to it.
void set_texture(const GlProgram& program, const char* name, int unit, const GlTexture& texture,
                 TextureShape shape = TextureShape::flat);

/// One triangle over the whole target, for programs with fullscreen.vert.
void draw_fullscreen(const GlTarget& target, const GlProgram& program);
/// Two triangles over it, for programs with fullscreen.vert and AS_QUAD defined: the 2x2 pixels
/// that GPUs shade together are shaded twice along the diagonal.
void draw_fullscreen_quad(const GlTarget& target, const GlProgram& program);

}  // namespace softfocus
