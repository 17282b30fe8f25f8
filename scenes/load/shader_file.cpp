#include "scenes/load/shader_file.h"

#include <optional>
#include <span>
#include <utility>

#include "raster/shaders/shader_error.h"
#include "scenes/files/file_bytes.h"
#include "scenes/load/toml_reading.h"

namespace softfocus {
namespace {

constexpr std::size_t kMostShaderBytes = std::size_t{1} << 24;
constexpr std::size_t kMostIncludeFolders = 64;

bool is_spirv(const std::string& bytes) {
  return bytes.starts_with("\x03\x02\x23\x07") || bytes.starts_with("\x07\x23\x02\x03");
}

std::optional<std::string> read_include(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  return read_file_bytes(path, kMostGlslBytes);
}

std::map<std::string, std::string> read_defines(const Section& section) {
  std::map<std::string, std::string> defines;
  if (section.table == nullptr) return defines;
  for (const auto& [key, node] : *section.table) {
    const std::string name{key.str()};
    std::string& value = defines[name];
    if (const auto flag = node.value_exact<bool>()) {
      value = *flag ? "1" : "0";
    } else if (const auto number = node.value_exact<std::int64_t>()) {
      value = std::to_string(*number);
    } else if (const auto text = node.value_exact<std::string>()) {
      value = *text;
    } else {
      fail_at(section, name, "is no text; a text, a whole number, true or false would be right");
    }
    if (const std::string fault = definition_fault(name, value); !fault.empty()) {
      fail_at(section, name, fault);
    }
  }
  return defines;
}

}  // namespace

ShaderReading read_shader_keys(Section& section, const std::filesystem::path& folder) {
  ShaderReading reading{.defines = read_defines(read_section(section, "defines"))};
  for (const std::string& from : read_texts(section, "include")) {
    const std::filesystem::path path = folder / from;
    std::error_code error;
    if (!std::filesystem::is_directory(path, error)) {
      fail_at(section, "include", "'" + from + "' is no folder");
    }
    reading.include_folders.push_back(path.string());
  }
  if (reading.include_folders.size() > kMostIncludeFolders) {
    fail_at(section, "include", "has more than 64 folders; fewer would be right");
  }
  return reading;
}

OpenedShader open_shader(const std::filesystem::path& file, const ShaderReading& reading) {
  check_no_pipe(file);
  std::string bytes = read_file_bytes(file, kMostShaderBytes);
  if (!is_spirv(bytes)) return open_shader_text(file.string(), std::move(bytes), reading);
  const bool has_more = !reading.defines.empty() || !reading.include_folders.empty();
  if (has_more && !reading.is_of_several) {
    throw ShaderError(file.string() +
                      ": it is SPIR-V, which is compiled already; macros and include folders are "
                      "for GLSL and HLSL");
  }
  OpenedShader opened;
  opened.words = spirv_words(std::as_bytes(std::span{bytes}));
  opened.files.push_back(file.string());
  return opened;
}

OpenedShader open_shader_text(std::string name, std::string text, const ShaderReading& reading) {
  if (!missing_glsl().empty()) throw ShaderError(name + ": " + std::string{missing_glsl()});
  const GlslSource source{.stage = reading.stage,
                          .name = std::move(name),
                          .text = std::move(text),
                          .convention = reading.convention,
                          .defines = reading.defines,
                          .include_folders = reading.include_folders};
  CompiledGlsl compiled = compile_glsl(source, read_include);
  OpenedShader opened{std::move(compiled.words),      compiled.convention,
                      std::move(compiled.parameters), std::move(compiled.warnings),
                      std::move(compiled.text),       std::move(compiled.files)};
  opened.files.push_back(source.name);
  return opened;
}

}  // namespace softfocus
