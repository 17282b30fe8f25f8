// softfocus scenes | methods | effects | profiles: what there is, a line each.

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "raster/effects/effect.h"
#include "raster/numbers/profile.h"
#include "scenes/files/file_bytes.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/load/load_scene.h"
#include "scenes/load/pipeline_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/gl/shaders.h"
#include "tools/options/method_options.h"

namespace softfocus {
namespace {

using Row = std::vector<std::string>;

/// A list of objects with these keys, a row each.
void print_json(const std::vector<Row>& rows, const Row& keys) {
  Json list = Json::array();
  for (const Row& row : rows) {
    Json object = Json::object();
    for (std::size_t i = 0; i < keys.size(); ++i) object[keys[i]] = row[i];
    list.push_back(std::move(object));
  }
  std::cout << json_text(list, 2) << '\n';
}

/// Columns two blanks apart, the last one ragged.
void print_aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  for (const Row& row : rows) {
    for (std::size_t i = 0; i + 1 < row.size(); ++i) {
      std::cout << row[i] << std::string(widths[i] - row[i].size() + 2, ' ');
    }
    std::cout << row.back() << '\n';
  }
}

std::shared_ptr<bool> add_json_flag(CLI::App& parser) {
  auto json = std::make_shared<bool>(false);
  add_flag(parser, "--json", "Print JSON", *json);
  return json;
}

Json parameter_json(std::string_view name, std::string_view summary, double least, double most,
                    double preset) {
  return {
      {"name", name}, {"summary", summary}, {"least", least}, {"most", most}, {"default", preset}};
}

Row parameter_row(std::string_view name, std::string_view summary, double least, double most,
                  double preset) {
  return {"  " + std::string{name} + "=" + short_number(preset),
          (summary.empty() ? "" : std::string{summary} + ", ") + short_number(least) + " to " +
              short_number(most)};
}

int list_parameters(const std::string& file, bool json) {
  if (!is_pipeline_name(file)) {
    throw UsageError("'" + file + "' is no pipeline; FILE.toml would be right (docs/shaders.md)");
  }
  const Pipeline pipeline = read_pipeline(file).pipeline;
  Json list = Json::array();
  std::vector<Row> rows{{file, pipeline.summary}};
  for (const PipelineParameter& of : pipeline.parameters) {
    list.push_back(parameter_json(of.name, of.summary, of.least, of.most, of.value));
    rows.push_back(parameter_row(of.name, of.summary, of.least, of.most, of.value));
  }
  if (json) {
    std::cout << json_text(list, 2) << '\n';
  } else {
    print_aligned(rows);
  }
  return kDone;
}

Json effects_json() {
  Json list = Json::array();
  for (const Effect& effect : effects()) {
    Json parameters = Json::array();
    for (const Parameter& parameter : effect.parameters) {
      parameters.push_back(parameter_json(parameter.name, parameter.summary, parameter.least,
                                          parameter.most, parameter.preset));
    }
    list.push_back({{"name", effect.name},
                    {"summary", effect.summary},
                    {"parameters", std::move(parameters)}});
  }
  return list;
}

}  // namespace

Command add_scenes_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "scenes", "List the scenes: name, title");
  const auto path = std::make_shared<std::vector<std::filesystem::path>>();
  add_scene_path(*parser, *path);
  const auto json = add_json_flag(*parser);
  return {parser, [path, json] {
            std::vector<Row> rows;
            for (const SceneListing& scene : list_scenes(scene_search_path(*path))) {
              rows.push_back({scene.name, scene.title});
            }
            if (*json) {
              print_json(rows, {"name", "title"});
              return kDone;
            }
            rows.push_back({"random:SEED", "A scene drawn from the number SEED, 0 to 2^64 - 1"});
            print_aligned(rows);
            return kDone;
          }};
}

Command add_methods_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "methods", "List the depth-of-field methods: name, needs, summary");
  const auto pipeline = std::make_shared<std::string>();
  add_optional_argument(*parser, "PIPELINE.toml", "A pipeline, to list its parameters instead",
                        *pipeline);
  const auto json = add_json_flag(*parser);
  return {parser, [pipeline, json] {
            if (!pipeline->empty()) return list_parameters(*pipeline, *json);
            std::vector<Row> rows;
            for (const Method& method : methods()) {
              rows.push_back({std::string{method.name}, std::string{method.needs},
                              std::string{method.summary}});
            }
            for (const LensViewMethod& method : lens_view_methods()) {
              const char* lack = method.missing.empty() ? "" : " (not in this build)";
              rows.push_back({std::string{method.name}, std::string{method.needs},
                              std::string{method.summary} + lack});
            }
            rows.push_back({std::string{kAutoMethod}, "the scene",
                            "the cheapest of these that the scene needs for an error"});
            if (*json) {
              print_json(rows, {"name", "needs", "summary"});
            } else {
              print_aligned(rows);
            }
            return kDone;
          }};
}

Command add_effects_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "effects", "List the effects, each with its keys");
  const auto json = add_json_flag(*parser);
  return {parser, [json] {
            if (*json) {
              std::cout << json_text(effects_json(), 2) << '\n';
              return kDone;
            }
            std::vector<Row> rows;
            for (const Effect& effect : effects()) {
              rows.push_back({std::string{effect.name}, std::string{effect.summary}});
              for (const Parameter& parameter : effect.parameters) {
                rows.push_back(parameter_row(parameter.name, parameter.summary, parameter.least,
                                             parameter.most, parameter.preset));
              }
            }
            print_aligned(rows);
            return kDone;
          }};
}

Command add_profiles_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "profiles", "List whose arithmetic can be repeated: name, summary");
  const auto json = add_json_flag(*parser);
  return {parser, [json] {
            std::vector<Row> rows;
            for (const NamedProfile& profile : profiles()) {
              rows.push_back({std::string{profile.name}, std::string{profile.summary}});
            }
            if (*json) {
              print_json(rows, {"name", "summary"});
            } else {
              print_aligned(rows);
            }
            return kDone;
          }};
}

// softfocus shaders: the project's GLSL, to read, to change and to lift.

namespace {

// A file of another content may be the user's own work: it stays, and nothing is written.
void refuse_to_replace(const std::filesystem::path& folder) {
  for (const Shader& shader : built_in_shaders()) {
    const std::filesystem::path name = folder / shader.name;
    if (!std::filesystem::exists(name)) continue;
    if (read_file_bytes(name, shader.source.size() + 1) == shader.source) continue;
    throw FileError(name.string() +
                    ": is there and differs from the program's; give another folder");
  }
}

int write_shaders(const std::filesystem::path& folder) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(folder, unknown)) {
    throw UsageError("-o '" + folder.string() + "': there is no such folder");
  }
  refuse_to_replace(folder);
  for (const Shader& shader : built_in_shaders()) {
    WholeFile file{folder / shader.name};
    file.write(shader.source);
    file.commit();
  }
  return kDone;
}

}  // namespace

Command add_shaders_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "shaders", "List the GLSL shaders, or write them out");
  const auto folder = std::make_shared<std::optional<std::string>>();
  add_value(*parser, "-o,--output", "DIR", "Write every shader into this folder",
            [folder](const std::string& text) { *folder = text; });
  const auto json = std::make_shared<bool>(false);
  add_flag(*parser, "--json", "Print the list as JSON", *json);
  return {parser, [folder, json] {
            if (*folder) return write_shaders(**folder);
            if (*json) {
              Json list = Json::array();
              for (const Shader& shader : built_in_shaders()) {
                list.push_back({{"name", shader.name}});
              }
              std::cout << json_text(list, 2) << '\n';
              return kDone;
            }
            for (const Shader& shader : built_in_shaders()) std::cout << shader.name << '\n';
            return kDone;
          }};
}

}  // namespace softfocus
