#pragma once
// OpenGL's functions as a table: each context fills it with its own, libepoxy's or the emulated
// driver's, and the calls of api.h go to those of the context that is current.

#include <cstddef>
#include <cstdint>

namespace softfocus {

// NOLINTBEGIN(readability-identifier-naming,bugprone-macro-parentheses): OpenGL's names
using GLenum = unsigned;
using GLbitfield = unsigned;
using GLuint = unsigned;
using GLint = int;
using GLsizei = int;
using GLboolean = unsigned char;
using GLubyte = unsigned char;
using GLchar = char;
using GLfloat = float;
using GLdouble = double;
using GLsizeiptr = std::ptrdiff_t;

// Result, name, parameters, arguments.
#define SOFTFOCUS_GL_UNIFORM(X, NAME, TYPE) \
  X(void, Uniform##NAME, (GLint at, GLsizei count, const TYPE* values), (at, count, values))
#define SOFTFOCUS_GL_MATRIX(X, NAME)                                           \
  X(void, UniformMatrix##NAME##fv,                                             \
    (GLint at, GLsizei count, GLboolean is_transposed, const GLfloat* values), \
    (at, count, is_transposed, values))
#define SOFTFOCUS_GL_FUNCTIONS(X)                                                                 \
  X(void, ActiveTexture, (GLenum unit), (unit))                                                   \
  X(void, AttachShader, (GLuint program, GLuint shader), (program, shader))                       \
  X(void, BindBuffer, (GLenum target, GLuint buffer), (target, buffer))                           \
  X(void, BindFramebuffer, (GLenum target, GLuint framebuffer), (target, framebuffer))            \
  X(void, BindTexture, (GLenum target, GLuint texture), (target, texture))                        \
  X(void, BindVertexArray, (GLuint array), (array))                                               \
  X(void, BlendEquation, (GLenum equation), (equation))                                           \
  X(void, BlendFunc, (GLenum source, GLenum destination), (source, destination))                  \
  X(void, BlitFramebuffer,                                                                        \
    (GLint x, GLint y, GLint x_end, GLint y_end, GLint to_x, GLint to_y, GLint to_x_end,          \
     GLint to_y_end, GLbitfield buffers, GLenum filter),                                          \
    (x, y, x_end, y_end, to_x, to_y, to_x_end, to_y_end, buffers, filter))                        \
  X(void, BufferData, (GLenum target, GLsizeiptr size, const void* data, GLenum usage),           \
    (target, size, data, usage))                                                                  \
  X(GLenum, CheckFramebufferStatus, (GLenum target), (target))                                    \
  X(void, Clear, (GLbitfield buffers), (buffers))                                                 \
  X(void, ClearBufferfv, (GLenum buffer, GLint number, const GLfloat* value),                     \
    (buffer, number, value))                                                                      \
  X(void, ClearColor, (GLfloat r, GLfloat g, GLfloat b, GLfloat a), (r, g, b, a))                 \
  X(void, ClearDepth, (GLdouble depth), (depth))                                                  \
  X(void, CompileShader, (GLuint shader), (shader))                                               \
  X(void, CopyTexSubImage2D,                                                                      \
    (GLenum target, GLint level, GLint to_x, GLint to_y, GLint x, GLint y, GLsizei width,         \
     GLsizei height),                                                                             \
    (target, level, to_x, to_y, x, y, width, height))                                             \
  X(GLuint, CreateProgram, (), ())                                                                \
  X(GLuint, CreateShader, (GLenum stage), (stage))                                                \
  X(void, CullFace, (GLenum faces), (faces))                                                      \
  X(void, DeleteBuffers, (GLsizei count, const GLuint* buffers), (count, buffers))                \
  X(void, DeleteFramebuffers, (GLsizei count, const GLuint* framebuffers), (count, framebuffers)) \
  X(void, DeleteProgram, (GLuint program), (program))                                             \
  X(void, DeleteShader, (GLuint shader), (shader))                                                \
  X(void, DeleteTextures, (GLsizei count, const GLuint* textures), (count, textures))             \
  X(void, DepthFunc, (GLenum test), (test))                                                       \
  X(void, DepthMask, (GLboolean writes), (writes))                                                \
  X(void, Disable, (GLenum what), (what))                                                         \
  X(void, DisableVertexAttribArray, (GLuint location), (location))                                \
  X(void, DrawArrays, (GLenum mode, GLint first, GLsizei count), (mode, first, count))            \
  X(void, DrawBuffers, (GLsizei count, const GLenum* buffers), (count, buffers))                  \
  X(void, DrawElements, (GLenum mode, GLsizei count, GLenum type, const void* offset),            \
    (mode, count, type, offset))                                                                  \
  X(void, Enable, (GLenum what), (what))                                                          \
  X(void, EnableVertexAttribArray, (GLuint location), (location))                                 \
  X(void, Finish, (), ())                                                                         \
  X(void, FramebufferTexture2D,                                                                   \
    (GLenum target, GLenum attachment, GLenum kind, GLuint texture, GLint level),                 \
    (target, attachment, kind, texture, level))                                                   \
  X(void, FrontFace, (GLenum winding), (winding))                                                 \
  X(void, GenBuffers, (GLsizei count, GLuint * names), (count, names))                            \
  X(void, GenFramebuffers, (GLsizei count, GLuint * names), (count, names))                       \
  X(void, GenTextures, (GLsizei count, GLuint * names), (count, names))                           \
  X(void, GenVertexArrays, (GLsizei count, GLuint * names), (count, names))                       \
  X(void, GenerateMipmap, (GLenum target), (target))                                              \
  X(GLint, GetAttribLocation, (GLuint program, const GLchar* name), (program, name))              \
  X(GLenum, GetError, (), ())                                                                     \
  X(void, GetIntegerv, (GLenum what, GLint * values), (what, values))                             \
  X(void, GetProgramInfoLog, (GLuint program, GLsizei room, GLsizei * length, GLchar * log),      \
    (program, room, length, log))                                                                 \
  X(void, GetProgramiv, (GLuint program, GLenum what, GLint * value), (program, what, value))     \
  X(void, GetShaderInfoLog, (GLuint shader, GLsizei room, GLsizei * length, GLchar * log),        \
    (shader, room, length, log))                                                                  \
  X(void, GetShaderiv, (GLuint shader, GLenum what, GLint * value), (shader, what, value))        \
  X(const GLubyte*, GetString, (GLenum name), (name))                                             \
  X(GLint, GetUniformLocation, (GLuint program, const GLchar* name), (program, name))             \
  X(void, LinkProgram, (GLuint program), (program))                                               \
  X(void, PixelStorei, (GLenum what, GLint value), (what, value))                                 \
  X(void, ReadBuffer, (GLenum buffer), (buffer))                                                  \
  X(void, ReadPixels,                                                                             \
    (GLint x, GLint y, GLsizei width, GLsizei height, GLenum layout, GLenum type, void* data),    \
    (x, y, width, height, layout, type, data))                                                    \
  X(void, ShaderSource,                                                                           \
    (GLuint shader, GLsizei count, const GLchar* const* texts, const GLint* lengths),             \
    (shader, count, texts, lengths))                                                              \
  X(void, TexImage2D,                                                                             \
    (GLenum target, GLint level, GLint format, GLsizei width, GLsizei height, GLint border,       \
     GLenum layout, GLenum type, const void* data),                                               \
    (target, level, format, width, height, border, layout, type, data))                           \
  X(void, TexImage2DMultisample,                                                                  \
    (GLenum target, GLsizei samples, GLenum format, GLsizei width, GLsizei height,                \
     GLboolean is_fixed),                                                                         \
    (target, samples, format, width, height, is_fixed))                                           \
  X(void, TexImage3D,                                                                             \
    (GLenum target, GLint level, GLint format, GLsizei width, GLsizei height, GLsizei depth,      \
     GLint border, GLenum layout, GLenum type, const void* data),                                 \
    (target, level, format, width, height, depth, border, layout, type, data))                    \
  X(void, TexSubImage3D,                                                                          \
    (GLenum target, GLint level, GLint x, GLint y, GLint z, GLsizei width, GLsizei height,        \
     GLsizei depth, GLenum layout, GLenum type, const void* data),                                \
    (target, level, x, y, z, width, height, depth, layout, type, data))                           \
  X(void, TexParameteri, (GLenum target, GLenum what, GLint value), (target, what, value))        \
  X(void, Uniform1f, (GLint at, GLfloat x), (at, x))                                              \
  X(void, Uniform2f, (GLint at, GLfloat x, GLfloat y), (at, x, y))                                \
  X(void, Uniform3f, (GLint at, GLfloat x, GLfloat y, GLfloat z), (at, x, y, z))                  \
  X(void, Uniform4f, (GLint at, GLfloat x, GLfloat y, GLfloat z, GLfloat w), (at, x, y, z, w))    \
  X(void, Uniform1i, (GLint at, GLint x), (at, x))                                                \
  X(void, Uniform2i, (GLint at, GLint x, GLint y), (at, x, y))                                    \
  SOFTFOCUS_GL_UNIFORM(X, 1fv, GLfloat)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 2fv, GLfloat)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 3fv, GLfloat)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 4fv, GLfloat)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 1iv, GLint)                                                             \
  SOFTFOCUS_GL_UNIFORM(X, 2iv, GLint)                                                             \
  SOFTFOCUS_GL_UNIFORM(X, 3iv, GLint)                                                             \
  SOFTFOCUS_GL_UNIFORM(X, 4iv, GLint)                                                             \
  SOFTFOCUS_GL_UNIFORM(X, 1uiv, GLuint)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 2uiv, GLuint)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 3uiv, GLuint)                                                           \
  SOFTFOCUS_GL_UNIFORM(X, 4uiv, GLuint)                                                           \
  SOFTFOCUS_GL_MATRIX(X, 2)                                                                       \
  SOFTFOCUS_GL_MATRIX(X, 2x3)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 2x4)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 3x2)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 3)                                                                       \
  SOFTFOCUS_GL_MATRIX(X, 3x4)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 4x2)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 4x3)                                                                     \
  SOFTFOCUS_GL_MATRIX(X, 4)                                                                       \
  X(void, UseProgram, (GLuint program), (program))                                                \
  X(void, VertexAttribPointer,                                                                    \
    (GLuint location, GLint components, GLenum type, GLboolean is_normalized, GLsizei stride,     \
     const void* offset),                                                                         \
    (location, components, type, is_normalized, stride, offset))                                  \
  X(void, Viewport, (GLint x, GLint y, GLsizei width, GLsizei height), (x, y, width, height))

struct GlFunctions {
#define SOFTFOCUS_GL_MEMBER(RESULT, NAME, PARAMETERS, ARGUMENTS) RESULT(*NAME) PARAMETERS = nullptr;
  SOFTFOCUS_GL_FUNCTIONS(SOFTFOCUS_GL_MEMBER)
#undef SOFTFOCUS_GL_MEMBER
};
// NOLINTEND(readability-identifier-naming,bugprone-macro-parentheses)

/// Of the context that is current in this thread: OpenGL itself has it so.
const GlFunctions*& current_gl();

}  // namespace softfocus
