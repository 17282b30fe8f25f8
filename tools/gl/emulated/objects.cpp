// Textures, buffers and framebuffers of the emulated driver, and what comes out of them.

#include <algorithm>
#include <cstring>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/passes/draw_mipmaps.h"
#include "raster/pipeline/merge.h"
#include "tools/gl/emulated/emulated_gl.h"

namespace softfocus {
namespace {

EmulatedGl*& current_emulated() {
  thread_local EmulatedGl* current = nullptr;
  return current;
}

const GlFunctions& emulated_functions() {
#define SOFTFOCUS_GL_FILL(RESULT, NAME, PARAMETERS, ARGUMENTS) .NAME = emulated::NAME,
  static constexpr GlFunctions kFunctions{SOFTFOCUS_GL_FUNCTIONS(SOFTFOCUS_GL_FILL)};
#undef SOFTFOCUS_GL_FILL
  return kFunctions;
}

std::optional<Format> format_of(GLenum internal) {
  switch (internal) {
    case GL_R8: return Format::r8;
    case GL_RGBA8: return Format::rgba8;
    case GL_SRGB8_ALPHA8: return Format::srgb8;
    case GL_RGBA16F: return Format::rgba16f;
    case GL_RG16F: return Format::rg16f;
    case GL_R32F:
    case GL_DEPTH_COMPONENT32F: return Format::r32f;
    case GL_RGBA32UI:  // bit by bit
    case GL_RGBA32F: return Format::rgba32f;
    default: return {};
  }
}

template <class Object>
void name_objects(std::map<GLuint, Object>& objects, GLsizei count, GLuint* names) {
  for (GLsizei i = 0; i < count; ++i) {
    names[i] = ++emulated::gl().last_name;
    objects[names[i]];
  }
}

template <class Object>
void erase_objects(std::map<GLuint, Object>& objects, GLsizei count, const GLuint* names) {
  for (GLsizei i = 0; i < count; ++i) objects.erase(names[i]);
}

EmulatedTexture& bound_texture() {
  EmulatedGl& gl = emulated::gl();
  return gl.textures[gl.units[gl.unit]];
}

EmulatedFramebuffer& bound_framebuffer() {
  return emulated::gl().framebuffers[emulated::gl().framebuffer];
}

std::size_t row_bytes_of(const Image& image, int width) {
  return static_cast<std::size_t>(width) * bytes_per_texel(image.format);
}

std::byte* texel_at(Image& image, int x, int y) {
  return image.bytes.data() + static_cast<std::size_t>(y) * image.stride_bytes +
         row_bytes_of(image, x);
}

/// A level of a layer, slice or face of the texture that is bound.
Image& slice_at(int slice, GLint level) {
  Texture& texture = bound_texture().texture;
  const auto number = static_cast<std::size_t>(slice), at = static_cast<std::size_t>(level);
  if (texture.behind.size() < number) texture.behind.resize(number);
  std::vector<Image>& levels = slice == 0 ? texture.levels : texture.behind[number - 1].levels;
  if (levels.size() <= at) levels.resize(at + 1);
  return levels[at];
}

/// Null, and an error of GL, if it cannot be.
Image* new_slice(int slice, GLint level, GLint format, GLsizei width, GLsizei height) {
  const std::optional<Format> as = format_of(static_cast<GLenum>(format));
  if (!as || width > kMaxImageSize || height > kMaxImageSize) {
    emulated::gl().error = as ? GL_INVALID_VALUE : GL_INVALID_ENUM;
    return nullptr;
  }
  Image& image = slice_at(slice, level);
  image = make_image(*as, width, height);
  return &image;
}

/// Rows without gaps.
void put_rows(Image& image, const std::byte* from) {
  const std::size_t row_bytes = row_bytes_of(image, image.width);
  for (int y = 0; y < image.height; ++y, from += row_bytes) {
    std::memcpy(texel_at(image, 0, y), from, row_bytes);
  }
}

bool holds(const Image* image, int x, int y, int width, int height) {
  return image != nullptr && x >= 0 && y >= 0 && width <= image->width - x &&
         height <= image->height - y;
}

}  // namespace

const GlFunctions*& current_gl() {
  thread_local const GlFunctions* current = nullptr;
  return current;
}

EmulatedContext::EmulatedContext(const Profile& profile, int threads,
                                 const std::filesystem::path& spirv)
    : gl_(std::make_unique<EmulatedGl>(profile, threads, spirv)) {
  current_emulated() = gl_.get();
  current_gl() = &emulated_functions();
}

EmulatedContext::~EmulatedContext() { current_emulated() = nullptr; }

EmulatedGl& emulated::gl() { return *current_emulated(); }

Image* emulated::image_of(const EmulatedFramebuffer::Attached& attached) {
  const auto found = gl().textures.find(attached.texture);
  if (found == gl().textures.end()) return nullptr;
  std::vector<Image>& levels = found->second.texture.levels;
  const auto level = static_cast<std::size_t>(attached.level);
  return level < levels.size() ? &levels[level] : nullptr;
}

// NOLINTBEGIN(readability-identifier-naming): OpenGL's names
namespace emulated {

// --- textures ---

void GenTextures(GLsizei count, GLuint* names) { name_objects(gl().textures, count, names); }
void DeleteTextures(GLsizei count, const GLuint* names) {
  erase_objects(gl().textures, count, names);
}
void ActiveTexture(GLenum unit) { gl().unit = (unit - GL_TEXTURE0) % kEmulatedUnits; }
void BindTexture(GLenum /*target*/, GLuint texture) { gl().units[gl().unit] = texture; }

void TexImage2D(GLenum target, GLint level, GLint format, GLsizei width, GLsizei height,
                GLint /*border*/, GLenum /*layout*/, GLenum /*type*/, const void* data) {
  const bool is_face = target != GL_TEXTURE_2D;
  bound_texture().texture.shape = is_face ? TextureShape::cube : TextureShape::flat;
  const int slice = is_face ? static_cast<int>(target - GL_TEXTURE_CUBE_MAP_POSITIVE_X) : 0;
  Image* const image = new_slice(slice, level, format, width, height);
  if (image != nullptr && data != nullptr) put_rows(*image, static_cast<const std::byte*>(data));
}

// Its shaders fetch no samples.
void TexImage2DMultisample(GLenum /*target*/, GLsizei /*samples*/, GLenum /*format*/,
                           GLsizei /*width*/, GLsizei /*height*/, GLboolean /*is_fixed*/) {
  gl().error = GL_INVALID_ENUM;
}
void BlitFramebuffer(GLint /*x*/, GLint /*y*/, GLint /*x_end*/, GLint /*y_end*/, GLint /*to_x*/,
                     GLint /*to_y*/, GLint /*to_x_end*/, GLint /*to_y_end*/, GLbitfield /*buffers*/,
                     GLenum /*filter*/) {
  gl().error = GL_INVALID_ENUM;
}

void TexImage3D(GLenum target, GLint level, GLint format, GLsizei width, GLsizei height,
                GLsizei depth, GLint /*border*/, GLenum /*layout*/, GLenum /*type*/,
                const void* /*data*/) {
  bound_texture().texture.shape =
      target == GL_TEXTURE_3D ? TextureShape::volume : TextureShape::array;
  for (int slice = 0; slice < depth; ++slice) new_slice(slice, level, format, width, height);
}

void TexSubImage3D(GLenum /*target*/, GLint level, GLint /*x*/, GLint /*y*/, GLint z, GLsizei width,
                   GLsizei height, GLsizei depth, GLenum /*layout*/, GLenum /*type*/,
                   const void* data) {
  Image& image = slice_at(z, level);
  if (depth != 1 || width != image.width || height != image.height) {
    gl().error = GL_INVALID_VALUE;  // whole slices, one by one, are what is asked for
    return;
  }
  put_rows(image, static_cast<const std::byte*>(data));
}

void TexParameteri(GLenum /*target*/, GLenum what, GLint value) {
  Sampler& sampler = bound_texture().sampler;
  const auto wrap = [&] {
    return value == GL_REPEAT            ? Wrap::repeat
           : value == GL_MIRRORED_REPEAT ? Wrap::mirrored_repeat
                                         : Wrap::clamp_to_edge;
  };
  switch (what) {
    case GL_TEXTURE_WRAP_S: sampler.wrap_u = wrap(); return;
    case GL_TEXTURE_WRAP_T: sampler.wrap_v = wrap(); return;
    case GL_TEXTURE_WRAP_R: sampler.wrap_w = wrap(); return;
    case GL_TEXTURE_MIN_FILTER:
      sampler.filter = value == GL_LINEAR_MIPMAP_LINEAR ? Filter::trilinear
                       : value == GL_NEAREST || value == GL_NEAREST_MIPMAP_NEAREST
                           ? Filter::nearest
                           : Filter::bilinear;
      return;
    // The other filter is as ours, which has one for both; the last level is the last there is.
    default: return;
  }
}

void GenerateMipmap(GLenum /*target*/) {
  Texture& texture = bound_texture().texture;
  if (texture.shape != TextureShape::flat) return generate_sliced_mipmaps(texture, gl().profile);
  texture.levels.resize(1);
  generate_mipmaps_as(texture, gl().profile);
}

// --- buffers ---

void GenBuffers(GLsizei count, GLuint* names) { name_objects(gl().buffers, count, names); }
void DeleteBuffers(GLsizei count, const GLuint* names) {
  erase_objects(gl().buffers, count, names);
}
void BindBuffer(GLenum target, GLuint buffer) {
  (target == GL_ARRAY_BUFFER ? gl().array_buffer : gl().element_buffer) = buffer;
}
void BufferData(GLenum target, GLsizeiptr size, const void* data, GLenum /*usage*/) {
  const auto* bytes = static_cast<const std::byte*>(data);
  gl().buffers[target == GL_ARRAY_BUFFER ? gl().array_buffer : gl().element_buffer].assign(
      bytes, bytes + size);
}

// --- framebuffers ---

void GenFramebuffers(GLsizei count, GLuint* names) {
  name_objects(gl().framebuffers, count, names);
}
void DeleteFramebuffers(GLsizei count, const GLuint* names) {
  erase_objects(gl().framebuffers, count, names);
}
void BindFramebuffer(GLenum /*target*/, GLuint framebuffer) { gl().framebuffer = framebuffer; }

void FramebufferTexture2D(GLenum /*target*/, GLenum attachment, GLenum /*kind*/, GLuint texture,
                          GLint level) {
  EmulatedFramebuffer& to = bound_framebuffer();
  if (attachment == GL_DEPTH_ATTACHMENT) {
    to.depth = {texture, level};
  } else {
    to.colour.at(attachment - GL_COLOR_ATTACHMENT0) = {texture, level};
  }
}

// Outputs go to the colours by their numbers, which is what is asked for.
void DrawBuffers(GLsizei /*count*/, const GLenum* /*buffers*/) {}
void ReadBuffer(GLenum buffer) { bound_framebuffer().read = buffer - GL_COLOR_ATTACHMENT0; }

GLenum CheckFramebufferStatus(GLenum /*target*/) {
  return image_of(bound_framebuffer().colour[0]) != nullptr ? GL_FRAMEBUFFER_COMPLETE
                                                            : GL_INVALID_FRAMEBUFFER_OPERATION;
}

void ReadPixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum /*layout*/, GLenum /*type*/,
                void* data) {
  Image* const from = image_of(bound_framebuffer().colour.at(bound_framebuffer().read));
  if (!holds(from, x, y, width, height)) {
    gl().error = GL_INVALID_FRAMEBUFFER_OPERATION;
    return;
  }
  const std::size_t row_bytes = row_bytes_of(*from, width);
  auto* to = static_cast<std::byte*>(data);
  for (int i = 0; i < height; ++i, to += row_bytes) {
    std::memcpy(to, texel_at(*from, x, y + i), row_bytes);
  }
}

void CopyTexSubImage2D(GLenum /*target*/, GLint level, GLint to_x, GLint to_y, GLint x, GLint y,
                       GLsizei width, GLsizei height) {
  Image* const from = image_of(bound_framebuffer().colour.at(bound_framebuffer().read));
  Image* const to = image_of({gl().units[gl().unit], level});
  if (!holds(from, x, y, width, height) || !holds(to, to_x, to_y, width, height) ||
      from->format != to->format) {
    gl().error = GL_INVALID_VALUE;
    return;
  }
  for (int i = 0; i < height; ++i) {
    std::memcpy(texel_at(*to, to_x, to_y + i), texel_at(*from, x, y + i),
                row_bytes_of(*from, width));
  }
}

// --- clearing ---

void ClearColor(GLfloat r, GLfloat g, GLfloat b, GLfloat a) { gl().clear_colour = {r, g, b, a}; }
void ClearDepth(GLdouble depth) { gl().clear_depth = static_cast<float>(depth); }

void ClearBufferfv(GLenum buffer, GLint number, const GLfloat* value) {
  const EmulatedFramebuffer& framebuffer = bound_framebuffer();
  if (buffer == GL_DEPTH) {
    Image* const image = image_of(framebuffer.depth);
    if (image != nullptr && gl().depth.write) clear_image(*image, glm::vec4{*value}, gl().profile);
    return;
  }
  Image* const image = image_of(framebuffer.colour.at(static_cast<std::size_t>(number)));
  if (image == nullptr) return;
  clear_image(*image, {value[0], value[1], value[2], value[3]}, gl().profile);
}

void Clear(GLbitfield buffers) {
  const glm::vec4 colour = gl().clear_colour;
  const float depth = gl().clear_depth;
  for (GLint i = 0; i < kMaxColourTargets && (buffers & GL_COLOR_BUFFER_BIT) != 0; ++i) {
    ClearBufferfv(GL_COLOR, i, &colour.x);
  }
  if ((buffers & GL_DEPTH_BUFFER_BIT) != 0) ClearBufferfv(GL_DEPTH, 0, &depth);
}

}  // namespace emulated
// NOLINTEND(readability-identifier-naming)

}  // namespace softfocus
