#include "tools/gl/objects.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"

namespace softfocus {
namespace {

struct PixelFormat {
  GLenum internal;
  GLenum layout;
  GLenum type;
};

PixelFormat pixel_format(Format format) {
  switch (format) {
    case Format::r8: return {GL_R8, GL_RED, GL_UNSIGNED_BYTE};
    case Format::rgba8: return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::srgb8: return {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case Format::rgba16f: return {GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
    case Format::r32f: return {GL_R32F, GL_RED, GL_FLOAT};
    case Format::rgba32f: return {GL_RGBA32F, GL_RGBA, GL_FLOAT};
    case Format::rg16f: return {GL_RG16F, GL_RG, GL_HALF_FLOAT};
  }
  return {};
}

GLint wrap_mode(Wrap wrap) {
  switch (wrap) {
    case Wrap::repeat: return GL_REPEAT;
    case Wrap::mirrored_repeat: return GL_MIRRORED_REPEAT;
    case Wrap::clamp_to_edge: return GL_CLAMP_TO_EDGE;
  }
  return GL_REPEAT;
}

GLint minification(Filter filter) {
  switch (filter) {
    case Filter::nearest: return GL_NEAREST_MIPMAP_NEAREST;
    case Filter::bilinear: return GL_LINEAR_MIPMAP_NEAREST;
    case Filter::trilinear: return GL_LINEAR_MIPMAP_LINEAR;
  }
  return GL_NEAREST;
}

// Rows without the padding that ours have.
std::vector<std::byte> packed(const Image& image) {
  const std::size_t row_bytes =
      static_cast<std::size_t>(image.width) * bytes_per_texel(image.format);
  std::vector<std::byte> bytes(row_bytes * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const auto at = static_cast<std::size_t>(y);
    std::copy_n(image.bytes.data() + at * image.stride_bytes, row_bytes,
                bytes.data() + at * row_bytes);
  }
  return bytes;
}

Image unpacked(const std::vector<std::byte>& bytes, Format format, int width, int height) {
  Image image = make_image(format, width, height);
  const std::size_t row_bytes = static_cast<std::size_t>(width) * bytes_per_texel(format);
  for (int y = 0; y < height; ++y) {
    const auto at = static_cast<std::size_t>(y);
    std::copy_n(bytes.data() + at * row_bytes, row_bytes,
                image.bytes.data() + at * image.stride_bytes);
  }
  return image;
}

std::vector<std::byte> room_for(Format format, int width, int height) {
  return std::vector<std::byte>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                bytes_per_texel(format));
}

// Textures are made and read in a unit that no program uses, so that what is bound for
// a draw stays bound.
void bind_for_work(GLuint texture, GLenum target = GL_TEXTURE_2D) {
  glActiveTexture(GL_TEXTURE15);
  glBindTexture(target, texture);
}

GlTexture new_texture(GLenum target = GL_TEXTURE_2D) {
  GLuint name = 0;
  glGenTextures(1, &name);
  bind_for_work(name, target);
  return GlTexture{name};
}

void set_parameter(GLenum parameter, GLint value, GLenum target = GL_TEXTURE_2D) {
  glTexParameteri(target, parameter, value);
}

GLenum target_of(TextureShape shape) {
  switch (shape) {
    case TextureShape::flat: return GL_TEXTURE_2D;
    case TextureShape::array: return GL_TEXTURE_2D_ARRAY;
    case TextureShape::volume: return GL_TEXTURE_3D;
    case TextureShape::cube: return GL_TEXTURE_CUBE_MAP;
  }
  return GL_TEXTURE_2D;
}

// WebGL's, once: a driver that hung, or a browser that needs the GPU.
constexpr GLenum kContextLost = 0x9242;

void check_error(const char* doing) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  while (glGetError() != GL_NO_ERROR) {
  }
  const char* what = error == GL_OUT_OF_MEMORY                   ? "out of memory"
                     : error == GL_INVALID_FRAMEBUFFER_OPERATION ? "incomplete framebuffer"
                     : error == kContextLost                     ? "its context is lost"
                     : error == GL_INVALID_VALUE                 ? "invalid value"
                     : error == GL_INVALID_ENUM                  ? "invalid enum"
                                                                 : "invalid operation";
  throw DriverError(std::string(doing) + ": GL says " + what);
}

GlTexture empty_texture(GLenum internal, GLenum layout, GLenum type, int width, int height) {
  GlTexture texture = new_texture();
  glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internal), width, height, 0, layout, type,
               nullptr);
  set_parameter(GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  set_parameter(GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  set_parameter(GL_TEXTURE_MAX_LEVEL, 0);
  return texture;
}

// WebGL2 reads bytes and floats in fours, and in one format more of the driver's choice.
bool can_be_read_as(const PixelFormat& as) {
  if (!kIsWebGl || (as.layout == GL_RGBA && as.type != GL_HALF_FLOAT)) return true;
  GLint layout = 0, type = 0;
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &layout);
  glGetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &type);
  return static_cast<GLenum>(layout) == as.layout && static_cast<GLenum>(type) == as.type;
}

// Rounds nothing: the floats were halves, or single channels, before they were read.
Image narrowed(const Image& floats, Format format) {
  Image image = make_image(format, floats.width, floats.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      store_texel(image, x, y, load_texel(floats, x, y), {});
    }
  }
  return image;
}

Image read_bound_framebuffer(Format format, int width, int height) {
  const PixelFormat as = pixel_format(format);
  if (!can_be_read_as(as)) {
    return narrowed(read_bound_framebuffer(Format::rgba32f, width, height), format);
  }
  std::vector<std::byte> bytes = room_for(format, width, height);
  glReadPixels(0, 0, width, height, as.layout, as.type, bytes.data());
  check_error("reading a picture back");
  return unpacked(bytes, format, width, height);
}

GlFramebuffer new_framebuffer() {
  GLuint name = 0;
  glGenFramebuffers(1, &name);
  glBindFramebuffer(GL_FRAMEBUFFER, name);
  return GlFramebuffer{name};
}

GLuint compile(GLenum stage, const std::string& source, const std::vector<std::string>& files) {
  const GLuint shader = glCreateShader(stage);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  std::array<char, 4096> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  throw ShaderError(first_error(log.data(), files));
}

GLint location(const GlProgram& program, const char* name) {
  glUseProgram(program);
  return glGetUniformLocation(program, name);
}

}  // namespace

namespace {

/// A level of the texture that is bound to `target`.
void upload_level(GLenum target, GLint level, const Image& image) {
  const PixelFormat format = pixel_format(image.format);
  glTexImage2D(target, level, static_cast<GLint>(format.internal), image.width, image.height, 0,
               format.layout, format.type, packed(image).data());
}

/// Layers or slices.
void upload_slices(GLenum target, const Texture& texture, std::size_t level) {
  const Image& first = texture.levels[level];
  const PixelFormat format = pixel_format(first.format);
  const int count = slice_count(texture, level);
  const auto number = static_cast<GLint>(level);
  glTexImage3D(target, number, static_cast<GLint>(format.internal), first.width, first.height,
               count, 0, format.layout, format.type, nullptr);
  for (int i = 0; i < count; ++i) {
    glTexSubImage3D(target, number, 0, 0, i, first.width, first.height, 1, format.layout,
                    format.type, packed(slice_level(texture, i, level)).data());
  }
}

}  // namespace

GlTexture upload(const Texture& texture, const Sampler& sampler) {
  const GLenum target = target_of(texture.shape);
  GlTexture name = new_texture(target);
  for (std::size_t level = 0; level < texture.levels.size(); ++level) {
    const auto number = static_cast<GLint>(level);
    if (texture.shape == TextureShape::flat) {
      upload_level(target, number, texture.levels[level]);
    } else if (texture.shape == TextureShape::cube) {
      for (int face = 0; face < 6; ++face) {
        upload_level(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), number,
                     slice_level(texture, face, level));
      }
    } else {
      upload_slices(target, texture, level);
    }
  }
#ifndef SOFTFOCUS_WEBGL
  if (texture.shape == TextureShape::cube) glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
#endif
  set_parameter(GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(texture.levels.size()) - 1, target);
  set_sampler(name, sampler, texture.shape);
  check_error("uploading a texture");
  return name;
}

GlTexture upload(const Image& image) {
  return upload(make_texture(image), {Filter::nearest, Wrap::clamp_to_edge, Wrap::clamp_to_edge});
}

void generate_levels(const GlTexture& texture) {
  bind_for_work(texture);
  set_parameter(GL_TEXTURE_MAX_LEVEL, 1000);
  glGenerateMipmap(GL_TEXTURE_2D);
  check_error("generating mipmaps");
}

Image read_level(const GlTexture& texture, Format format, int level, int width, int height) {
  const GlFramebuffer framebuffer = new_framebuffer();
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, level);
  return read_bound_framebuffer(format, width, height);
}

GlTarget make_target(std::span<const Format> formats, int width, int height, bool with_depth,
                     int samples) {
  GlTarget target{width, height, samples, {formats.begin(), formats.end()}, {}, {}, {}};
  const auto attach = [&](GLenum to, const PixelFormat& as) {
#ifndef SOFTFOCUS_WEBGL
    if (samples > 1) {
      GlTexture texture = new_texture(GL_TEXTURE_2D_MULTISAMPLE);
      glTexImage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, samples, as.internal, width, height,
                              GL_TRUE);
      glFramebufferTexture2D(GL_FRAMEBUFFER, to, GL_TEXTURE_2D_MULTISAMPLE, texture, 0);
      return texture;
    }
#endif
    GlTexture texture = empty_texture(as.internal, as.layout, as.type, width, height);
    glFramebufferTexture2D(GL_FRAMEBUFFER, to, GL_TEXTURE_2D, texture, 0);
    return texture;
  };
  target.framebuffer = new_framebuffer();
  std::vector<GLenum> buffers;
  for (const Format format : formats) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size()));
    target.colour.push_back(attach(buffers.back(), pixel_format(format)));
  }
  if (with_depth) {
    target.depth =
        attach(GL_DEPTH_ATTACHMENT, {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT});
  }
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw DriverError("the driver cannot draw into " + std::to_string(width) + "x" +
                      std::to_string(height) + " textures of the format asked for");
  }
  return target;
}

void bind(const GlTarget& target) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glViewport(0, 0, target.width, target.height);
}

Image read_colour(const GlTarget& target, std::size_t index) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(index));
  return read_bound_framebuffer(target.formats[index], target.width, target.height);
}

void copy_colour(const GlTarget& target, const GlTexture& to) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, to);
  glCopyTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 0, 0, target.width, target.height);
  check_error("copying a target into a texture");
}

namespace {

#ifndef SOFTFOCUS_WEBGL
Image read_texture_samples(const GlContext& context, const GlTarget& target,
                           const GlTexture& texture, Format format) {
  const GlProgram program =
      link_program(context, {}, "fullscreen.vert", "store.frag", "#define SAMPLES\n");
  const GlTarget copy = make_target(std::array{format}, target.width, target.height, false);
  Image all = make_image(format, target.width, target.height * target.samples);
  for (int s = 0; s < target.samples; ++s) {
    set_uniform(program, "values", 0);
    set_uniform(program, "number", s);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_MULTISAMPLE, texture);
    draw_fullscreen(copy, program);
    const Image one = read_colour(copy, 0);
    for (int y = 0; y < one.height; ++y) {
      std::copy_n(
          one.bytes.data() + static_cast<std::size_t>(y) * one.stride_bytes, one.stride_bytes,
          all.bytes.data() + static_cast<std::size_t>(y * target.samples + s) * all.stride_bytes);
    }
  }
  return all;
}
#endif

}  // namespace

#ifndef SOFTFOCUS_WEBGL
Image read_samples(const GlContext& context, const GlTarget& target, std::size_t index) {
  return read_texture_samples(context, target, target.colour[index], target.formats[index]);
}

Image read_resolved(const GlTarget& target) {
  const GlTarget resolved =
      make_target(std::array{target.formats[0]}, target.width, target.height, false);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved.framebuffer);
  glBlitFramebuffer(0, 0, target.width, target.height, 0, 0, target.width, target.height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  check_error("resolving samples");
  return read_colour(resolved, 0);
}
#endif

Image read_depth(const GlContext& context, const GlTarget& target) {
#ifndef SOFTFOCUS_WEBGL
  if (target.samples > 1) {
    return read_texture_samples(context, target, target.depth, Format::r32f);
  }
#endif
  const GlProgram program = link_program(context, {}, "fullscreen.vert", "store.frag");
  const GlTarget copy = make_target(std::array{Format::r32f}, target.width, target.height, false);
  set_texture(program, "values", 0, target.depth);
  draw_fullscreen(copy, program);
  return read_colour(copy, 0);
}

void wait_for(const GlTarget& target) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glReadBuffer(GL_COLOR_ATTACHMENT0);
  read_bound_framebuffer(target.formats[0], 1, 1);
}

namespace {

GlProgram link_sources(const GlContext& context, const std::array<ShaderSource, 2>& sources) {
  unsigned& known = context.programs()[sources[0].text + sources[1].text];
  if (known != 0) return {known};
  const GlProgram program{glCreateProgram()};
  for (const std::size_t i : {0u, 1u}) {
    const GLenum stage = i == 0 ? GL_VERTEX_SHADER : GL_FRAGMENT_SHADER;
    const GLuint shader = compile(stage, sources[i].text, sources[i].files);
    glAttachShader(program, shader);
    glDeleteShader(shader);  // with the program
  }
  glLinkProgram(program);
  GLint good = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good != GL_TRUE) {
    std::array<char, 512> log{};
    glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    const std::string complaint = log.data();
    throw ShaderError("linking " + sources[0].files[0] + " and " + sources[1].files[0] + ": " +
                      complaint.substr(0, complaint.find('\n')));
  }
  known = program;
  return program;
}

}  // namespace

GlProgram link_program(const GlContext& context, const Shaders& shaders, std::string_view vertex,
                       std::string_view fragment, const std::string& defines) {
  std::array sources{shader_source(shaders, vertex), shader_source(shaders, fragment)};
  for (ShaderSource& source : sources) {
    source.text.insert(0, context.shader_header() + defines);
  }
  return link_sources(context, sources);
}

GlProgram link_texts(const GlContext& context, const ShaderSource& vertex,
                     const ShaderSource& fragment) {
  return link_sources(context, {vertex, fragment});
}

void set_uniform(const GlProgram& program, const char* name, int value) {
  glUniform1i(location(program, name), value);
}
void set_uniform(const GlProgram& program, const char* name, float value) {
  glUniform1f(location(program, name), value);
}
void set_uniform(const GlProgram& program, const char* name, glm::ivec2 value) {
  glUniform2i(location(program, name), value.x, value.y);
}
void set_uniform(const GlProgram& program, const char* name, glm::vec2 value) {
  glUniform2f(location(program, name), value.x, value.y);
}
void set_uniform(const GlProgram& program, const char* name, glm::vec3 value) {
  glUniform3f(location(program, name), value.x, value.y, value.z);
}
void set_uniform(const GlProgram& program, const char* name, glm::vec4 value) {
  glUniform4f(location(program, name), value.x, value.y, value.z, value.w);
}
void set_uniform(const GlProgram& program, const char* name, std::span<const float> values) {
  glUniform1fv(location(program, name), static_cast<GLsizei>(values.size()), values.data());
}
void set_uniform(const GlProgram& program, const char* name, const glm::mat3& value) {
  glUniformMatrix3fv(location(program, name), 1, GL_FALSE, &value[0][0]);
}
void set_uniform(const GlProgram& program, const char* name, const glm::mat4& value) {
  glUniformMatrix4fv(location(program, name), 1, GL_FALSE, &value[0][0]);
}

void set_uniform(const GlProgram& program, const ShaderUniform& of,
                 std::span<const std::uint32_t> words) {
  const GLint at = location(program, of.name.c_str());
  const auto count = static_cast<GLsizei>(std::max(of.count, 1u));
  if (of.kind == SpirvKind::floating && of.columns > 1) {
    using Set = void (*)(GLint, GLsizei, const GLfloat*);
    static constexpr Set kSetMatrix[3][3] = {
        {[](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix2fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix2x3fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix2x4fv(l, n, GL_FALSE, v); }},
        {[](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix3x2fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix3fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix3x4fv(l, n, GL_FALSE, v); }},
        {[](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix4x2fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix4x3fv(l, n, GL_FALSE, v); },
         [](GLint l, GLsizei n, const GLfloat* v) { glUniformMatrix4fv(l, n, GL_FALSE, v); }}};
    std::vector<float> values(words.size());
    std::memcpy(values.data(), words.data(), words.size_bytes());
    return kSetMatrix[of.columns - 2][of.rows - 2](at, count, values.data());
  }
  if (of.kind == SpirvKind::floating) {
    std::vector<float> values(words.size());
    std::memcpy(values.data(), words.data(), words.size_bytes());
    switch (of.rows) {
      case 1: return glUniform1fv(at, count, values.data());
      case 2: return glUniform2fv(at, count, values.data());
      case 3: return glUniform3fv(at, count, values.data());
      default: return glUniform4fv(at, count, values.data());
    }
  }
  if (of.kind == SpirvKind::integer && !of.is_signed) {
    switch (of.rows) {
      case 1: return glUniform1uiv(at, count, words.data());
      case 2: return glUniform2uiv(at, count, words.data());
      case 3: return glUniform3uiv(at, count, words.data());
      default: return glUniform4uiv(at, count, words.data());
    }
  }
  std::vector<GLint> values(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) values[i] = std::bit_cast<GLint>(words[i]);
  switch (of.rows) {
    case 1: return glUniform1iv(at, count, values.data());
    case 2: return glUniform2iv(at, count, values.data());
    case 3: return glUniform3iv(at, count, values.data());
    default: return glUniform4iv(at, count, values.data());
  }
}

void set_sampler(const GlTexture& texture, const Sampler& sampler, TextureShape shape) {
  const GLenum target = target_of(shape);
  bind_for_work(texture, target);
  const auto set = [&](GLenum parameter, GLint value) { set_parameter(parameter, value, target); };
  set(GL_TEXTURE_MIN_FILTER, minification(sampler.filter));
  set(GL_TEXTURE_MAG_FILTER, sampler.filter == Filter::nearest ? GL_NEAREST : GL_LINEAR);
  set(GL_TEXTURE_WRAP_S, wrap_mode(sampler.wrap_u));
  set(GL_TEXTURE_WRAP_T, wrap_mode(sampler.wrap_v));
  if (shape == TextureShape::volume) set(GL_TEXTURE_WRAP_R, wrap_mode(sampler.wrap_w));
}

void set_texture(const GlProgram& program, const char* name, int unit, const GlTexture& texture,
                 TextureShape shape) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target_of(shape), texture);
  set_uniform(program, name, unit);
}

namespace {

void draw_over(const GlTarget& target, const GlProgram& program, GLenum mode, GLsizei corners) {
  bind(target);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glUseProgram(program);
  glDrawArrays(mode, 0, corners);
  check_error("a full-screen pass");
}

}  // namespace

void draw_fullscreen(const GlTarget& target, const GlProgram& program) {
  draw_over(target, program, GL_TRIANGLES, 3);
}

void draw_fullscreen_quad(const GlTarget& target, const GlProgram& program) {
  draw_over(target, program, GL_TRIANGLE_STRIP, 4);
}

}  // namespace softfocus
