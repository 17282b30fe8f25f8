#include "scenes/load/pipeline_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "dof/shaders.h"
#include "raster/numbers/hash.h"
#include "raster/numbers/parameter_text.h"
#include "scenes/files/decimal.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/files/texture_file.h"
#include "scenes/load/parse_expression.h"
#include "scenes/load/shader_file.h"
#include "scenes/load/toml_reading.h"

namespace softfocus {
namespace {

constexpr std::size_t kMostPipelineBytes = std::size_t{1} << 20;
constexpr int kMostPasses = 256;
constexpr double kLargestNumber = 1e30;
constexpr Range kAnyNumber{-kLargestNumber, kLargestNumber};

constexpr std::array kFormats{
    Choice<Format>{"r8", Format::r8},           Choice<Format>{"rgba8", Format::rgba8},
    Choice<Format>{"srgb8", Format::srgb8},     Choice<Format>{"rg16f", Format::rg16f},
    Choice<Format>{"rgba16f", Format::rgba16f}, Choice<Format>{"r32f", Format::r32f},
    Choice<Format>{"rgba32f", Format::rgba32f}};
constexpr std::array kFilters{Choice<Filter>{"nearest", Filter::nearest},
                              Choice<Filter>{"bilinear", Filter::bilinear},
                              Choice<Filter>{"trilinear", Filter::trilinear}};
constexpr std::array kWraps{Choice<Wrap>{"clamp", Wrap::clamp_to_edge},
                            Choice<Wrap>{"repeat", Wrap::repeat},
                            Choice<Wrap>{"mirror", Wrap::mirrored_repeat}};
constexpr std::array kTexels{Choice<bool>{"linear", false}, Choice<bool>{"srgb", true}};

/// What is read into, with the folder that names are of.
struct Reading {
  OpenedPipeline opened{};
  std::filesystem::path folder{};
  std::vector<std::string> names{};  ///< of values
  Hash hash{};

  Pipeline& pipeline() { return opened.pipeline; }
};

std::string place_in(const Section& section) {
  const auto line = section.table != nullptr ? section.table->source().begin.line : 0;
  return section.file + ":" + std::to_string(std::max<toml::source_index>(line, 1));
}

bool is_name(std::string_view text) {
  return !text.empty() && (text[0] < '0' || text[0] > '9') &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '_';
         });
}

void read_parameters(Section& top, Pipeline& pipeline) {
  for (auto& [name, section] : read_named_sections(top, "parameters")) {
    const std::vector<std::string> known = value_names(pipeline);
    if (!is_name(name) || std::find(known.begin(), known.end(), name) != known.end()) {
      fail_at(section, "",
              "a value has that name already, or it is no word of letters, digits "
              "and _; another name would be right");
    }
    PipelineParameter parameter{.name = name, .summary = read_text(section, "summary", "")};
    const std::vector<double> range =
        read_numbers(section, "range", {-kLargestNumber, kLargestNumber}, 2, kAnyNumber);
    parameter.least = range[0];
    parameter.most = range[1];
    if (!(parameter.least <= parameter.most)) {
      fail_at(section, "range", "begins behind its end; [least, most] would be right");
    }
    parameter.is_whole = read_flag(section, "whole", false);
    if (!has_key(section, "default")) {
      fail_at(section, "default", "is missing; a number would be right");
    }
    parameter.value = read_number(section, "default", 0.0, {parameter.least, parameter.most});
    if (parameter.is_whole && parameter.value != std::floor(parameter.value)) {
      fail_at(section, "default", "has a fraction; a whole number would be right");
    }
    finish_section(section);
    pipeline.parameters.push_back(std::move(parameter));
  }
}

/// Codes as they stand in the file, the lowest row first.
Texture as_codes(const Texture& texture) {
  const Image& from = texture.levels[0];
  Image codes = make_image(Format::rgba8, from.width, from.height);
  for (int y = 0; y < from.height; ++y) {
    const auto texels = row<std::uint8_t>(from, y);
    std::copy(texels.begin(), texels.end(), row<std::uint8_t>(codes, from.height - 1 - y).begin());
  }
  return make_texture(std::move(codes));
}

void read_textures(Section section, Reading& reading) {
  Pipeline& pipeline = reading.pipeline();
  if (section.table == nullptr) return;
  for (const auto& [key, node] : *section.table) {
    const std::string name{key.str()};
    const std::filesystem::path file = reading.folder / read_text(section, name, "");
    try {
      Texture texture = load_texture(file);
      add_to_hash(reading.hash, hash_image(texture.levels[0]));
      pipeline.textures.push_back(pipeline.by_codes ? as_codes(texture) : std::move(texture));
    } catch (const SceneError& error) {
      fail_at(section, name, error.what());
    }
    pipeline.texture_names.push_back(name);
    reading.opened.files.push_back(file.string());
  }
}

void add_text_to_hash(Hash& hash, std::string_view text) {
  for (const char c : text) add_to_hash(hash, static_cast<std::uint8_t>(c));
}

/// A file of the folder, or one of ours.
OpenedShader open_in_folder(const std::filesystem::path& folder, const std::string& name,
                            const ShaderReading& reading) {
  const std::filesystem::path file = folder / name;
  std::error_code error;
  if (!std::filesystem::exists(file, error)) {
    if (const std::string_view ours = shader_text(name); !ours.empty()) {
      return open_shader_text(name, "#version 400\n#line 1\n" + std::string{ours}, reading);
    }
  }
  return open_shader(file, reading);
}

OpenedShader open_pass_shader(Section& section, const std::filesystem::path& folder,
                              const ShaderOpener& open) {
  const std::string name = read_text(section, "shader", "");
  ShaderReading reading = read_shader_keys(section, folder);
  reading.convention =
      read_choice(section, "convention", GlslConvention::recognised, kGlslConventions);
  try {
    return open(name, reading);
  } catch (const SceneError& fault) {
    fail_at(section, "shader", fault.what());
  }
}

Expression read_expression(Section& section, std::string_view key, const toml::node& node,
                           const Reading& reading) {
  if (node.is_number()) return constant_expression(*node.value<double>());
  if (node.is_boolean()) return constant_expression(*node.value<bool>() ? 1.0 : 0.0);
  if (!node.is_string()) {
    fail_at(section, key, "is neither a number nor a text; 2 or \"2 * focus_m\" would be right");
  }
  try {
    return parse_expression(*node.value<std::string>(), reading.names);
  } catch (const ExpressionError& error) {
    fail_at(section, key, error.what());
  }
}

std::optional<Expression> find_expression(Section& section, std::string_view key,
                                          const Reading& reading) {
  const toml::node* node = find_key(section, key);
  if (node == nullptr) return {};
  return read_expression(section, key, *node, reading);
}

/// The uniforms of a pass: numbers, expressions, or arrays of them.
void read_uniforms(Section section, const Reading& reading, PipelinePass& pass) {
  if (section.table == nullptr) return;
  const std::vector<ShaderUniform>& all = pass.shader.uniforms.all;
  for (const auto& [key, node] : *section.table) {
    const std::string name{key.str()};
    const auto at = std::find_if(all.begin(), all.end(), [&](const ShaderUniform& of) {
      return of.name == name && !is_texture(of);
    });
    if (at == all.end()) {
      std::vector<std::string> names;
      for (const ShaderUniform& of : all) {
        if (!is_texture(of)) names.push_back(of.name);
      }
      fail_at(section, name,
              "the shader has no uniform of that name; there " +
                  (names.empty() ? "is none" : "are " + list_words(names)) +
                  did_you_mean(name, names));
    }
    PipelineUniform uniform{.number = static_cast<std::size_t>(at - all.begin())};
    if (const toml::array* array = node.as_array()) {
      for (const toml::node& value : *array) {
        uniform.values.push_back(read_expression(section, name, value, reading));
      }
    } else {
      uniform.values.push_back(read_expression(section, name, node, reading));
    }
    const std::size_t count = uniform.values.size();
    if (count != 1 && count != at->words) {
      fail_at(section, name,
              "has " + std::to_string(count) + " numbers; " + std::to_string(at->words) +
                  " would be right");
    }
    pass.uniforms.push_back(std::move(uniform));
  }
}

/// Where a pass's textures come from: "picture", or { from = "picture", filter = "nearest" }.
void read_inputs(Section section, const Reading& reading, PipelinePass& pass) {
  if (section.table == nullptr) return;
  const Pipeline& pipeline = reading.opened.pipeline;
  for (const auto& [key, node] : *section.table) {
    const std::string name{key.str()};
    const std::vector<ShaderUniform>& all = pass.shader.uniforms.all;
    const auto at = std::find_if(all.begin(), all.end(), [&](const ShaderUniform& of) {
      return of.name == name && is_texture(of);
    });
    if (at == all.end()) {
      std::vector<std::string> names;
      for (const ShaderUniform& of : all) {
        if (is_texture(of)) names.push_back(of.name);
      }
      fail_at(section, name,
              "the shader has no texture of that name; there " +
                  (names.empty() ? "is none" : "are " + list_words(names)) +
                  did_you_mean(name, names));
    }
    std::string from;
    Sampler sampler = PipelineInput{}.sampler;
    if (node.is_table()) {
      Section input = read_section(section, name);
      from = read_text(input, "from", "");
      sampler.filter = read_choice(input, "filter", sampler.filter, kFilters);
      sampler.wrap_u = sampler.wrap_v = sampler.wrap_w =
          read_choice(input, "wrap", sampler.wrap_u, kWraps);
      finish_section(input);
    } else {
      from = read_text(section, name, "");
    }
    std::optional<PipelineInput> input = source_named(pipeline, from.empty() ? name : from);
    if (!input && from.empty()) input = PipelineInput{};
    if (!input) {
      std::vector<std::string> names = source_names(pipeline);
      fail_at(section, name,
              "'" + from + "' is not there; there are " + list_words(names) +
                  did_you_mean(from, names));
    }
    input->texture = pass.shader.uniforms.words[at->first];
    input->sampler = sampler;
    pass.inputs.push_back(*input);
  }
}

std::vector<Format> read_formats(Section& section, std::size_t count, Format standard) {
  const toml::node* node = find_key(section, "format");
  if (node == nullptr) return std::vector<Format>(count, standard);
  if (!node->is_array()) {
    return std::vector<Format>(count, read_choice(section, "format", standard, kFormats));
  }
  std::vector<Format> formats;
  for (const std::string& name : read_texts(section, "format")) {
    const auto at = std::find_if(kFormats.begin(), kFormats.end(),
                                 [&](const Choice<Format>& of) { return of.name == name; });
    if (at == kFormats.end()) fail_at(section, "format", "'" + name + "' is no format");
    formats.push_back(at->value);
  }
  if (formats.size() != count) {
    fail_at(section, "format",
            "has " + std::to_string(formats.size()) + " names; " + std::to_string(count) +
                ", one an output, would be right");
  }
  return formats;
}

void read_size(Section& section, const Reading& reading, PipelinePass& pass) {
  if (has_key(section, "scale")) {
    const double scale = read_number(section, "scale", 1.0, {1e-4, 64.0});
    for (Expression* side : {&pass.width, &pass.height}) {
      side->steps.push_back({.number = scale});
      side->steps.push_back({.op = ExpressionOp::multiply});
      side->steps.push_back({.op = ExpressionOp::ceil});
    }
  }
  if (auto width = find_expression(section, "width", reading)) pass.width = std::move(*width);
  if (auto height = find_expression(section, "height", reading)) pass.height = std::move(*height);
  if (auto turns = find_expression(section, "turns", reading)) pass.turns = std::move(*turns);
}

void read_pass(Section& section, OpenedShader opened, Reading& reading) {
  Pipeline& pipeline = reading.pipeline();
  PipelinePass& pass = add_pass(pipeline, place_in(section), make_shader(std::move(opened.words)));
  pass.text = std::move(opened.text);
  add_constants(pass, opened.parameters);
  pass.name = read_text(section, "name", "");
  pass.target_names = read_texts(section, "outputs");
  constexpr std::size_t kMostOutputs = 8;
  if (pass.target_names.size() > kMostOutputs) {
    fail_at(section, "outputs", "are more than 8; fewer would be right");
  }
  pass.targets =
      read_formats(section, std::max<std::size_t>(pass.target_names.size(), 1), pass.targets[0]);
  read_size(section, reading, pass);
  read_inputs(read_section(section, "inputs"), reading, pass);
  read_uniforms(read_section(section, "uniforms"), reading, pass);
  finish_section(section);
}

}  // namespace

void add_constants(PipelinePass& pass, const std::vector<GlslParameter>& parameters) {
  const std::vector<ShaderUniform>& all = pass.shader.uniforms.all;
  for (const GlslParameter& parameter : parameters) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_it =
          all[i].name == parameter.name || all[i].name.ends_with("." + parameter.name);
      if (!is_it || is_texture(all[i]) || parameter.value.empty()) continue;
      PipelineUniform uniform{.number = i};
      for (const double value : parameter.value) {
        uniform.values.push_back(constant_expression(value));
      }
      pass.uniforms.push_back(std::move(uniform));
    }
  }
}

OpenedPipeline read_pipeline(const std::filesystem::path& file) {
  const auto open = [&](const std::string& name, const ShaderReading& reading) {
    return open_in_folder(file.parent_path(), name, reading);
  };
  const std::string name = file.string();
  OpenedPipeline opened = read_pipeline(read_file_text(file, kMostPipelineBytes), name, open);
  opened.files.insert(opened.files.begin(), name);
  return opened;
}

OpenedPipeline read_pipeline(const std::string& text, const std::string& name,
                             const ShaderOpener& open) {
  const toml::table table = parse_toml(text, name, "docs/shaders.md");
  const std::filesystem::path file{name};
  Reading reading{.folder = file.parent_path()};
  add_text_to_hash(reading.hash, text);
  Section top{&table, name, "", {}};
  Pipeline& pipeline = reading.pipeline();
  pipeline.name = name;
  pipeline.summary = read_text(top, "summary", "passes of " + file.filename().string());
  read_parameters(top, pipeline);
  reading.names = value_names(pipeline);
  std::vector<Section> passes = read_sections(top, "pass");
  if (passes.empty()) {
    fail_at(top, "pass", "is missing; [[pass]] with shader = \"FILE\" would be right");
  }
  if (passes.size() > kMostPasses) fail_at(top, "pass", "are more than 256; fewer would be right");
  std::vector<OpenedShader> shaders;
  for (Section& section : passes) {
    if (!has_key(section, "shader")) {
      fail_at(section, "shader", "is missing; the name of a fragment shader would be right");
    }
    shaders.push_back(open_pass_shader(section, reading.folder, open));
    OpenedShader& shader = shaders.back();
    for (const std::uint32_t word : shader.words) add_to_hash(reading.hash, word);
    std::move(shader.files.begin(), shader.files.end(), std::back_inserter(reading.opened.files));
    std::move(shader.warnings.begin(), shader.warnings.end(),
              std::back_inserter(reading.opened.warnings));
  }
  pipeline.by_codes =
      read_choice(top, "texels", shaders.front().convention != GlslConvention::plain, kTexels);
  read_textures(read_section(top, "textures"), reading);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    read_pass(passes[i], std::move(shaders[i]), reading);
  }
  finish_section(top);
  finish_pipeline(pipeline, "their sources in [pass.inputs] would be right");
  pipeline.hash = reading.hash.value;
  return std::move(reading.opened);
}

void set_parameters(Pipeline& pipeline, std::string_view settings) {
  for (std::size_t begin = 0; begin < settings.size();) {
    const std::size_t end = std::min(settings.find(':', begin), settings.size());
    const std::string_view one = settings.substr(begin, end - begin);
    begin = end + 1;
    const std::size_t sign = std::min(one.find('='), one.size());
    const std::string name{one.substr(0, sign)};
    const auto at = std::find_if(pipeline.parameters.begin(), pipeline.parameters.end(),
                                 [&](const PipelineParameter& of) { return of.name == name; });
    std::vector<std::string> names;
    for (const PipelineParameter& of : pipeline.parameters) names.push_back(of.name);
    if (at == pipeline.parameters.end()) {
      throw SceneError(pipeline.name + ": there is no parameter '" + name + "'; there " +
                       (names.empty() ? "is none" : "are " + list_words(names)) +
                       did_you_mean(name, names));
    }
    const auto value =
        sign < one.size() ? decimal_to_double(one.substr(sign + 1)) : std::optional<double>{};
    if (!value || !(*value >= at->least && *value <= at->most) ||
        (at->is_whole && *value != std::floor(*value))) {
      throw SceneError(pipeline.name + ": '" + std::string{one} + "': a " +
                       (at->is_whole ? "whole number" : "number") + " from " +
                       plain_number(at->least) + " to " + plain_number(at->most) +
                       " would be right");
    }
    at->value = *value;
  }
}

namespace {

struct KeptMethod {
  OpenedPipeline opened{};
  std::string name{};
  Method method{};
};

std::size_t end_of_file(std::string_view name) {
  const std::size_t at = name.find(".toml:");
  return at != name.npos ? at + 5 : name.ends_with(".toml") ? name.size() : name.npos;
}

std::mutex& kept_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// Methods are pointers to what lasts, and are named in many places: what is opened is kept.
std::map<std::string, KeptMethod, std::less<>>& kept_methods() {
  static std::map<std::string, KeptMethod, std::less<>> kept;
  return kept;
}

const KeptMethod* kept_method(const Method& method) {
  const std::lock_guard lock(kept_mutex());
  const auto at = kept_methods().find(method.name);
  return at != kept_methods().end() ? &at->second : nullptr;
}

}  // namespace

bool is_pipeline_name(std::string_view name) { return end_of_file(name) != name.npos; }

namespace {

/// With kept_mutex() locked.
const Method* kept_as(const std::string& name, OpenedPipeline opened) {
  KeptMethod& made = kept_methods()[name];
  made.opened = std::move(opened);
  made.name = name;
  made.method = {.name = made.name,
                 .summary = made.opened.pipeline.summary,
                 .needs = "colour and depth",
                 .filter = nullptr,
                 .pipeline = &made.opened.pipeline};
  return &made.method;
}

}  // namespace

const Method* keep_pipeline(OpenedPipeline opened) {
  const std::lock_guard lock(kept_mutex());
  const std::string name = opened.pipeline.name;
  if (const auto at = kept_methods().find(name); at != kept_methods().end()) {
    return &at->second.method;
  }
  return kept_as(name, std::move(opened));
}

const Method* pipeline_method(const std::string& name) {
  const std::lock_guard lock(kept_mutex());
  auto& kept = kept_methods();
  if (const auto at = kept.find(name); at != kept.end()) return &at->second.method;
  const std::size_t end = end_of_file(name);
  OpenedPipeline opened = read_pipeline(name.substr(0, end));
  if (end < name.size()) set_parameters(opened.pipeline, std::string_view{name}.substr(end + 1));
  Hash hash{opened.pipeline.hash};
  for (const PipelineParameter& of : opened.pipeline.parameters) {
    add_to_hash(hash, std::bit_cast<std::uint64_t>(of.value));
  }
  opened.pipeline.hash = hash.value;
  return kept_as(name, std::move(opened));
}

std::vector<std::string> files_of(const Method& method) {
  const KeptMethod* const kept = kept_method(method);
  return kept != nullptr ? kept->opened.files : std::vector<std::string>{};
}

std::vector<std::string> warnings_of(const Method& method) {
  const KeptMethod* const kept = kept_method(method);
  return kept != nullptr ? kept->opened.warnings : std::vector<std::string>{};
}

}  // namespace softfocus
