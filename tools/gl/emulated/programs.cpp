// Shaders, programs and uniforms of the emulated driver.

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "raster/numbers/hash.h"
#include "raster/shaders/glsl/glsl.h"
#include "scenes/files/file_bytes.h"
#include "tools/gl/emulated/emulated_gl.h"

namespace softfocus {
namespace {

constexpr std::size_t kVertex = 0, kFragment = 1;

void copy_log(const std::string& log, GLsizei room, GLsizei* length, GLchar* to) {
  const std::size_t count = std::min(log.size(), static_cast<std::size_t>(std::max(room, 1)) - 1);
  std::memcpy(to, log.data(), count);
  to[count] = '\0';
  if (length != nullptr) *length = static_cast<GLsizei>(count);
}

// `#line 3 1` gives a file by its number, which a compiler with names, as ours, takes for its own
// numbering. As a name, and a number again in the log, it comes through.
constexpr char kFile = 'f';

std::string with_named_files(std::string text) {
  constexpr std::string_view kDirective = "\n#line ";
  for (std::size_t at = 0; (at = text.find(kDirective, at)) != text.npos; at += kDirective.size()) {
    const std::size_t end = std::min(text.find('\n', at + 1), text.size());
    const std::size_t file = text.find(' ', at + kDirective.size()) + 1;
    if (file == 0 || file >= end || text.find_first_not_of("0123456789", file) < end) continue;
    text.insert(end, 1, '"');
    text.insert(file, std::string{'"', kFile});
  }
  return text;
}

void link(EmulatedProgram& program) {
  ShaderPair pair =
      make_shader_pair(program.stages[kVertex].words, program.stages[kFragment].words);
  program.stages[kVertex].shader = std::move(pair.vertex);
  program.stages[kFragment].shader = std::move(pair.fragment);
  for (EmulatedStage& stage : program.stages) {
    stage.uniforms = stage.shader.uniforms.words;
    stage.is_late.assign(stage.uniforms.size(), true);
    for (const ShaderUniform& uniform : stage.shader.uniforms.all) {
      for (std::uint32_t i = 0; i < uniform.words && is_texture(uniform); ++i) {
        stage.uniforms[uniform.first + i] = 0;
        stage.is_late[uniform.first + i] = false;
      }
    }
  }
}

/// The uniform of that name, from `element` on; without words if there is none.
EmulatedUniform uniform_of(const EmulatedProgram& program, std::string_view name,
                           std::uint32_t element) {
  EmulatedUniform found;
  for (std::size_t i = 0; i < program.stages.size(); ++i) {
    const ShaderUniform* const of = find_uniform(program.stages[i].shader, name);
    if (of == nullptr || element >= std::max(of->count, 1u)) continue;
    const std::uint32_t before = of->words / std::max(of->count, 1u) * element;
    found.first[i] = of->first + before;
    found.words = of->words - before;
    found.each = is_texture(*of) ? of->words / std::max(of->count, 1u) : 1;
    found.is_boolean = of->kind == SpirvKind::boolean;
  }
  return found;
}

template <class Number>
void set_uniforms(GLint at, GLsizei count, const Number* values) {
  if (at < 0) return;
  EmulatedProgram& program = emulated::program_in_use();
  const EmulatedUniform& to = program.uniforms[static_cast<std::size_t>(at)];
  for (std::uint32_t i = 0; i < std::min(static_cast<std::uint32_t>(count) * to.each, to.words);
       ++i) {
    const Number value = values[i / to.each];
    const std::uint32_t word =
        to.is_boolean ? (value != Number{} ? ~0u : 0u) : std::bit_cast<std::uint32_t>(value);
    for (std::size_t stage = 0; stage < program.stages.size(); ++stage) {
      if (to.first[stage]) program.stages[stage].uniforms[*to.first[stage] + i] = word;
    }
  }
}

}  // namespace

EmulatedProgram& emulated::program_in_use() { return gl().programs[gl().program]; }

std::shared_ptr<const ShaderProgram> emulated::compiled(EmulatedStage& stage, bool for_any) {
  constexpr std::size_t kMostKept = 16;
  auto& known = stage.compiled[for_any ? 1 : 0];
  std::vector<std::uint32_t> key = stage.uniforms;
  for (std::size_t i = 0; i < key.size() && for_any; ++i) {
    if (stage.is_late[i]) key[i] = 0;
  }
  for (const EmulatedStage::Compiled& one : known) {
    if (one.uniforms == key) return one.program;
  }
  if (known.size() == kMostKept) known.clear();
  const std::vector<bool> none;
  auto made = std::make_shared<const ShaderProgram>(
      compile_shader(stage.shader, stage.uniforms, for_any ? stage.is_late : none));
  known.push_back({std::move(key), made});
  return made;
}

std::vector<std::uint32_t> emulated::spirv_of(ShaderStage stage, const std::string& text,
                                              const std::string& name) {
  Hash hash;
  add_to_hash(hash, static_cast<std::uint8_t>(stage));
  for (const char c : text) add_to_hash(hash, static_cast<std::uint8_t>(c));
  const std::filesystem::path file = gl().spirv / (std::to_string(hash.value) + ".spv");
  if (!missing_glsl().empty()) {
    if (!std::filesystem::exists(file)) {
      throw ShaderError("a program with glslang has not written " + file.string());
    }
    const std::string bytes = read_file_bytes(file, sizeof(std::uint32_t) * kMostSpirvWords);
    return spirv_words(std::as_bytes(std::span{bytes}));
  }
  std::vector<std::uint32_t> words =
      compile_glsl(
          {.stage = stage, .name = name, .text = text, .convention = GlslConvention::plain},
          [](const std::string&) { return std::nullopt; })
          .words;
  if (!gl().spirv.empty()) {
    std::filesystem::create_directories(gl().spirv);
    std::ofstream stream{file, std::ios::binary};
    stream.write(reinterpret_cast<const char*>(words.data()),
                 static_cast<std::streamsize>(words.size() * sizeof(std::uint32_t)));
    if (!stream.flush()) throw ShaderError("cannot write " + file.string());
  }
  return words;
}

// NOLINTBEGIN(readability-identifier-naming): OpenGL's names
namespace emulated {

GLuint CreateShader(GLenum stage) {
  const GLuint name = ++gl().last_name;
  gl().shaders[name].stage =
      stage == GL_VERTEX_SHADER ? ShaderStage::vertex : ShaderStage::fragment;
  return name;
}
void DeleteShader(GLuint shader) { gl().shaders.erase(shader); }

void ShaderSource(GLuint shader, GLsizei count, const GLchar* const* texts,
                  const GLint* /*lengths*/) {
  std::string& text = gl().shaders[shader].text;
  text.clear();
  for (GLsizei i = 0; i < count; ++i) text += texts[i];
}

void CompileShader(GLuint name) {
  EmulatedShader& shader = gl().shaders[name];
  try {
    shader.words = spirv_of(shader.stage, with_named_files(shader.text), "0");
  } catch (const ShaderError& refused) {
    shader.log = refused.what();
    if (shader.log.starts_with(kFile)) shader.log.erase(0, 1);
  }
}
void GetShaderiv(GLuint shader, GLenum /*what*/, GLint* value) {
  *value = gl().shaders[shader].words.empty() ? GL_FALSE : GL_TRUE;
}
void GetShaderInfoLog(GLuint shader, GLsizei room, GLsizei* length, GLchar* log) {
  copy_log(gl().shaders[shader].log, room, length, log);
}

GLuint CreateProgram() {
  const GLuint name = ++gl().last_name;
  gl().programs[name];
  return name;
}
void DeleteProgram(GLuint program) { gl().programs.erase(program); }
void AttachShader(GLuint program, GLuint name) {
  const EmulatedShader& shader = gl().shaders[name];
  gl().programs[program].stages[shader.stage == ShaderStage::vertex ? kVertex : kFragment].words =
      shader.words;
}
void LinkProgram(GLuint name) {
  EmulatedProgram& program = gl().programs[name];
  try {
    link(program);
    program.is_linked = true;
  } catch (const ShaderError& refused) {
    program.log = refused.what();
  }
}
void GetProgramiv(GLuint program, GLenum /*what*/, GLint* value) {
  *value = gl().programs[program].is_linked ? GL_TRUE : GL_FALSE;
}
void GetProgramInfoLog(GLuint program, GLsizei room, GLsizei* length, GLchar* log) {
  copy_log(gl().programs[program].log, room, length, log);
}
void UseProgram(GLuint program) { gl().program = program; }

GLint GetAttribLocation(GLuint program, const GLchar* name) {
  for (const ShaderPort& port : inputs_of(*gl().programs[program].stages[kVertex].shader.module)) {
    if (port.name == name) return port.location;
  }
  return -1;
}

GLint GetUniformLocation(GLuint name, const GLchar* text) {
  EmulatedProgram& program = gl().programs[name];
  const std::string_view whole = text;
  if (const auto known = program.locations.find(whole); known != program.locations.end()) {
    return known->second;
  }
  EmulatedUniform found = uniform_of(program, whole, 0);
  if (const std::size_t bracket = whole.rfind('['); found.words == 0 && bracket != whole.npos) {
    const auto element = static_cast<std::uint32_t>(std::strtoul(text + bracket + 1, nullptr, 10));
    found = uniform_of(program, whole.substr(0, bracket), element);
  }
  const GLint location = found.words == 0 ? -1 : static_cast<GLint>(program.uniforms.size());
  if (location >= 0) program.uniforms.push_back(found);
  program.locations.emplace(whole, location);
  return location;
}

void Uniform1f(GLint at, GLfloat x) { set_uniforms(at, 1, &x); }
void Uniform2f(GLint at, GLfloat x, GLfloat y) { set_uniforms(at, 2, std::array{x, y}.data()); }
void Uniform3f(GLint at, GLfloat x, GLfloat y, GLfloat z) {
  set_uniforms(at, 3, std::array{x, y, z}.data());
}
void Uniform4f(GLint at, GLfloat x, GLfloat y, GLfloat z, GLfloat w) {
  set_uniforms(at, 4, std::array{x, y, z, w}.data());
}
void Uniform1i(GLint at, GLint x) { set_uniforms(at, 1, &x); }
void Uniform2i(GLint at, GLint x, GLint y) { set_uniforms(at, 2, std::array{x, y}.data()); }

#define SOFTFOCUS_GL_VECTORS(SUFFIX, TYPE)                                                  \
  void Uniform1##SUFFIX(GLint at, GLsizei n, const TYPE* v) { set_uniforms(at, n, v); }     \
  void Uniform2##SUFFIX(GLint at, GLsizei n, const TYPE* v) { set_uniforms(at, 2 * n, v); } \
  void Uniform3##SUFFIX(GLint at, GLsizei n, const TYPE* v) { set_uniforms(at, 3 * n, v); } \
  void Uniform4##SUFFIX(GLint at, GLsizei n, const TYPE* v) { set_uniforms(at, 4 * n, v); }
SOFTFOCUS_GL_VECTORS(fv, GLfloat)
SOFTFOCUS_GL_VECTORS(iv, GLint)
SOFTFOCUS_GL_VECTORS(uiv, GLuint)
#undef SOFTFOCUS_GL_VECTORS

// Column by column, as words are; nothing asks for them transposed.
#define SOFTFOCUS_GL_MATRICES(SUFFIX, NUMBERS)                                  \
  void UniformMatrix##SUFFIX##fv(GLint at, GLsizei n, GLboolean /*transposed*/, \
                                 const GLfloat* v) {                            \
    set_uniforms(at, (NUMBERS)*n, v);                                           \
  }
SOFTFOCUS_GL_MATRICES(2, 4)
SOFTFOCUS_GL_MATRICES(2x3, 6)
SOFTFOCUS_GL_MATRICES(2x4, 8)
SOFTFOCUS_GL_MATRICES(3x2, 6)
SOFTFOCUS_GL_MATRICES(3, 9)
SOFTFOCUS_GL_MATRICES(3x4, 12)
SOFTFOCUS_GL_MATRICES(4x2, 8)
SOFTFOCUS_GL_MATRICES(4x3, 12)
SOFTFOCUS_GL_MATRICES(4, 16)
#undef SOFTFOCUS_GL_MATRICES

}  // namespace emulated
// NOLINTEND(readability-identifier-naming)

}  // namespace softfocus
