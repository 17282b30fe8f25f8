#include "tools/page/scene_text.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>

#include "dof/parameters.h"
#include "scenes/files/file_bytes.h"
#include "scenes/load/load_scene.h"
#include "scenes/models/model.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"
#include "tools/page/picture.h"
#include "tools/render/performance_report.h"

namespace softfocus {
namespace {

constexpr std::size_t kLargestText = std::size_t{1} << 24;

struct KeyLine {
  std::string key, value;
};

std::string text_of(double value) { return json_text(value); }

template <class Vector>
std::string text_of(const Vector& v) {
  // Floats become the doubles that they are.
  return json_text(std::vector<double>{static_cast<double>(v.x), static_cast<double>(v.y),
                                       static_cast<double>(v.z)});
}

std::vector<KeyLine> camera_lines(const Camera& camera) {
  return {{"position", text_of(camera.position)},
          {"target", text_of(camera.target)},
          {"up", text_of(camera.up)},
          {"fov_degrees", text_of(camera.fov_y_degrees)},
          {"near_m", text_of(camera.near_m)},
          {"far_m", text_of(camera.far_m)}};
}

std::vector<KeyLine> lens_lines(const UsedLens& used) {
  std::vector<KeyLine> lines;
  lines.reserve(kLensNumbers.size() + 1);
  for (const LensNumber& number : kLensNumbers) {
    lines.push_back({std::string{key_of(number.parameter)}, text_of(used.lens.*number.place)});
  }
  lines.push_back({"coc_scale", text_of(used.coc_scale)});
  return lines;
}

std::string lines_text(const std::vector<KeyLine>& lines) {
  std::string text;
  for (const auto& [key, value] : lines) text.append(key).append(" = ").append(value).append("\n");
  return text;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t\r") + 1);
}

int open_brackets(std::string_view line) {
  line = line.substr(0, line.find('#'));
  return static_cast<int>(std::count(line.begin(), line.end(), '[') -
                          std::count(line.begin(), line.end(), ']'));
}

/// The text with other values in one of its sections, which is added if it is not there.
std::string with_section(const std::string& text, const std::string& section,
                         const std::vector<KeyLine>& values) {
  const auto is_replaced = [&](std::string_view line) {
    const std::string_view key = trimmed(line.substr(0, line.find('=')));
    return line.find('=') != line.npos &&
           std::any_of(values.begin(), values.end(),
                       [&](const KeyLine& value) { return value.key == key; });
  };
  std::istringstream lines{text};
  std::string result;
  bool is_inside = false, is_there = false;
  int depth = 0;  // of an array over several lines that is left out
  for (std::string line; std::getline(lines, line);) {
    const std::string_view words = trimmed(line);
    if (depth > 0) {
      depth += open_brackets(words);
      continue;
    }
    if (words.starts_with('[')) is_inside = words.starts_with("[" + section + "]");
    if (is_inside && is_replaced(words)) {
      depth = open_brackets(words);
      continue;
    }
    result += line + "\n";
    if (is_inside && words.starts_with('[')) {
      result += lines_text(values);
      is_there = true;
    }
  }
  if (!is_there) result += "\n[" + section + "]\n" + lines_text(values);
  return result;
}

std::string light_text(const Light& light) {
  const bool is_point = light.kind == LightKind::point;
  return "\n[[light]]\n" +
         lines_text({{"kind", is_point ? R"("point")" : R"("directional")"},
                     {is_point ? "position" : "direction", text_of(light.position_or_direction)},
                     {"colour", text_of(light.colour)}});
}

std::string model_text(const Opened& opened) {
  const Scene& scene = opened.scene;
  const std::string name = std::filesystem::path{opened.source}.filename().string();
  std::string text = lines_text({{"title", json_text(scene.title)},
                                 {"background", text_of(scene.background)},
                                 {"ambient_light", text_of(scene.ambient_light)}});
  for (const Light& light : scene.lights) text += light_text(light);
  return text + "\n[[object]]\n" + lines_text({{"shape", R"("model")"}, {"file", json_text(name)}});
}

}  // namespace

std::string scene_text(const Opened& opened, const ShownFrame& shown) {
  if (opened.picture) throw UsageError(kNoScene);
  if (opened.stress_case) {
    throw UsageError("a case has no scene's file: its pictures are made for their size");
  }
  if (is_random_scene(opened.source)) {
    throw UsageError(opened.source + " has no file: its number is all there is to it");
  }
  std::string text = is_model_name(opened.source)
                         ? model_text(opened)
                         : read_file_bytes(opened.scene.files.back(), kLargestText);
  // A camera's way stays in the file.
  if (shown.settings.camera || is_model_name(opened.source)) {
    Camera camera = shown.drawn->camera;
    camera.far_m = opened.camera.far_m;  // which the command's --backdrop changes
    text = with_section(text, "camera", camera_lines(camera));
  }
  return shown.lens ? with_section(text, "lens", lens_lines(*shown.lens)) : text;
}

Json command_text(const Opened& opened, const FrameSettings& settings) {
  if (opened.picture || opened.stress_case) return nullptr;
  const Method* filter = settings.method.filter;
  if (filter != nullptr && filter->pipeline != nullptr) return nullptr;
  const bool is_random = is_random_scene(opened.source);
  if (settings.camera && is_random) return nullptr;
  const bool needs_file = settings.camera || opened.source.find('/') != opened.source.npos;
  const auto [width, height] = settings.size;
  std::string text = "softfocus render " + (needs_file ? "scene.toml" : opened.source) +
                     " -o picture.png --json --size " + std::to_string(width) + "x" +
                     std::to_string(height);
  const auto add = [&](const std::string& option, const auto& value) {
    if (!value) return;
    const std::string number = json_text(static_cast<double>(*value));
    text.append(option).append(number.ends_with(".0") ? number.substr(0, number.size() - 2)
                                                      : number);
  };
  if (settings.frame != 0.0) add(" --frame ", std::optional{settings.frame});
  const SceneLook& look = settings.look;
  if (look.shadows)
    text += " --shadows " + std::string{word_for(parameter::kShadowKinds, *look.shadows)};
  if (look.light) {
    const auto number = [](float v) { return json_text(static_cast<double>(v)); };
    text += " --light " + number(look.light->x) + "," + number(look.light->y) + "," +
            number(look.light->z);
  }
  if (!look.textures) text += " --textures off";
  add(" --backdrop ", look.backdrop_m);
  if (look.impostors) {
    text += " --impostors " + std::string{word_for(parameter::kImpostorUses, *look.impostors)};
  }
  const bool is_image = settings.show == Show::image;
  if (is_image && settings.effect) text += " --effect " + *settings.effect;
  text += is_image ? " --method " + std::string{settings.method.name()}
                   : " --show " + std::string{name_of(settings.show)};
  if (is_image && filter != nullptr) text += " --multisample 1";
  if (!is_image && settings.show != Show::coc) return text;
  if (!needs_file) {
    if (settings.focus_at) {
      const auto pixel = [](double part, int count) {
        return std::to_string(std::min(static_cast<int>(part * count), count - 1));
      };
      text += " --autofocus " + pixel(settings.focus_at->x, width) + "," +
              pixel(settings.focus_at->y, height);
    }
    for (const auto& [parameter, place, has_keys] : kLensNumbers) {
      add(" --" + std::string{parameter.name} + " ", settings.lens.given[place]);
    }
    add(" --coc-scale ", settings.lens.coc_scale);
  }
  if (!is_image || settings.method.filter != nullptr) add(" --max-coc ", settings.max_coc_px);
  if (is_image && settings.method.samples_lens()) {
    text += " --samples " + std::to_string(settings.sampling.samples);
  }
  if (!is_image) return text;
  const Aperture aperture = used_aperture(settings);
  const auto add_set = [&](const Parameter& parameter, double value) {
    if (value != parameter.preset)
      add(" --" + std::string{parameter.name} + " ", std::optional{value});
  };
  add_set(parameter::kApertureBlades, aperture.blades);
  add_set(parameter::kApertureTurn, static_cast<double>(aperture.turn_degrees));
  add_set(parameter::kAnamorphic, static_cast<double>(aperture.stretch));
  return text;
}

}  // namespace softfocus
