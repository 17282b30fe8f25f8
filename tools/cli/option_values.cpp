#include "tools/cli/option_values.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "raster/images/image.h"
#include "raster/numbers/parameter_text.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/load_scene.h"
#include "scenes/parameters.h"
#include "tools/cli/errors.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, std::string_view wanted) {
  throw UsageError(std::string{option} + " '" + std::string{text} + "': give " +
                   std::string{wanted});
}

std::optional<int> whole(std::string_view text) {
  int value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

}  // namespace

void refuse_name(std::string_view option, const std::string& text,
                 const std::vector<std::string>& there, const std::string& also) {
  std::string list;
  for (const std::string& name : there) list += (list.empty() ? "" : ", ") + name;
  throw UsageError(std::string{option} + " '" + text + "': there are " + list + also +
                   did_you_mean(text, there));
}

void add_once(const std::string& option, const std::string& text, const std::string& name,
              std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    throw UsageError(option + " '" + text + "': '" + name + "' stands there twice");
  }
  names.push_back(name);
}

std::vector<std::string> listed_names(const std::string& option, const std::string& text,
                                      const std::vector<std::string>& known) {
  std::vector<std::string> names;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::string name = text.substr(start, end - start);
    start = end + 1;
    if (name.empty()) {
      throw UsageError(std::string{option}.append(" '").append(text).append(
          "': give names with a comma between two"));
    }
    add_once(option, text, name, names);
    if (!known.empty() && std::find(known.begin(), known.end(), name) == known.end()) {
      refuse_name(option, name, known);
    }
  }
  return names;
}

std::vector<std::string> known_scenes() { return names_in(list_scenes(scene_search_path({}))); }

void add_scene_argument(CLI::App& parser, std::string& scene) {
  add_argument(parser, "SCENE",
               "Name of a scene (softfocus scenes), random:SEED, a .toml, .gltf, .glb, .obj, .ply "
               "or .stl file",
               scene);
  offer(parser, "SCENE", known_scenes);
}

void add_scene_path(CLI::App& parser, std::vector<std::filesystem::path>& directories) {
  add_repeatable_value(
      parser, "--scene-path", "DIR", "Directory to look for scenes in first; may be repeated",
      [&directories](const std::string& name) {
        std::error_code unreadable;
        if (!std::filesystem::is_directory(name, unreadable)) {
          throw UsageError("--scene-path '" + name + "': give a directory that exists");
        }
        directories.emplace_back(name);
      });
}

void add_size(CLI::App& parser, PictureSize& size) {
  add_value(parser, "--size", "WxH",
            "Width and height in pixels (default: " + size_text(size) + ")",
            [&size](const std::string& text) { size = parse_size("--size", text); });
}

void add_multisample(CLI::App& parser, int& samples) {
  add_value(parser, "--multisample", "1|4|8",
            "Samples of a pixel: several make edges smooth, each side at its own depth (default: " +
                std::to_string(samples) + (samples > 1 ? " where edges have a place)" : ")"),
            [&samples](const std::string& text) {
              if (text != "1" && text != "4" && text != "8") {
                throw UsageError("--multisample '" + text + "' is not 1, 4 or 8");
              }
              samples = text[0] - '0';
            });
}

void add_frame(CLI::App& parser, double& frame) {
  using parameter::kFrame;
  add_value(parser, "--frame", std::string{kFrame.type},
            std::string{kFrame.summary} + " (" + range_text(kFrame) + "; default: 0)",
            [&frame](const std::string& text) {
              frame = parse_number("--frame", text, kFrame.least, kFrame.most, wanted_text(kFrame));
            });
}

double parse_number(std::string_view option, const std::string& text, double least, double most,
                    std::string_view wanted) {
  // strtod alone would take "inf", "nan", hexadecimal and leading blanks. It follows
  // the C library's locale, which this program leaves at "C".
  const bool decimal = !text.empty() && text.find_first_not_of("0123456789+-.eE") == text.npos;
  char* end = nullptr;
  const double value = decimal ? std::strtod(text.c_str(), &end) : 0.0;
  const bool whole_text = decimal && end == text.c_str() + text.size();
  if (!whole_text || !std::isfinite(value) || value < least || value > most) {
    refuse(option, text, wanted);
  }
  return value;
}

int parse_whole(std::string_view option, const std::string& text, int least, int most,
                std::string_view wanted) {
  const auto value = whole(text);
  if (!value || *value < least || *value > most) refuse(option, text, wanted);
  return *value;
}

PictureSize parse_size(std::string_view option, const std::string& text) {
  const auto cross = text.find_first_of("xX");
  const auto side = [&](std::string_view part) {
    const auto value = whole(part);
    if (!value || *value < 1 || *value > kMaxImageSize) {
      refuse(option, text,
             "WIDTHxHEIGHT in pixels, each 1 to " + std::to_string(kMaxImageSize) +
                 ", such as 1024x768");
    }
    return *value;
  };
  const std::string_view all = text;
  if (cross == text.npos) return {side(""), 0};
  return {side(all.substr(0, cross)), side(all.substr(cross + 1))};
}

std::string size_text(PictureSize size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

Pixel parse_pixel(std::string_view option, const std::string& text) {
  const std::string_view all = text;
  const auto comma = all.find(',');
  const auto x = whole(all.substr(0, comma));
  const auto y = comma == all.npos ? std::nullopt : whole(all.substr(comma + 1));
  if (!x || !y) refuse(option, text, "a pixel as X,Y, such as 512,384, or centre");
  return {*x, *y};
}

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return text;
}

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string count_text(int count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string exact_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace softfocus
