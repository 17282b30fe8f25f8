#include "tools/goldens/manifest.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "scenes/files/decimal.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/toml_reading.h"
#include "tools/cli/errors.h"
#include "tools/pictures/image_file.h"

namespace softfocus {
namespace {

constexpr std::string_view kHeading = "[[golden]]";

bool is_file_name(std::string_view text) {
  return !text.empty() && text.front() != '.' && text.front() != '-' &&
         text.find_first_not_of(
             "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") == text.npos;
}

bool is_hash(std::string_view text) {
  return text.size() == 18 && text.starts_with("0x") &&
         text.find_first_not_of("0123456789abcdef", 2) == text.npos;
}

std::optional<std::string> optional_text(Section& section, std::string_view key) {
  if (!has_key(section, key)) return {};
  return read_text(section, key, "");
}

std::optional<double> optional_number(Section& section, std::string_view key, Range range) {
  if (!has_key(section, key)) return {};
  return read_number(section, key, 0.0, range);
}

std::optional<int> optional_whole(Section& section, std::string_view key, int most) {
  if (!has_key(section, key)) return {};
  return read_whole_number(section, key, 0, 0, most);
}

bool is_same_place(const std::filesystem::path& a, const std::filesystem::path& b) {
  return a.lexically_normal() == b.lexically_normal();
}

Tolerance read_tolerance(Section& section) {
  Tolerance tolerance;
  tolerance.max_half_ulps = optional_whole(section, "max_ulps", 65535);
  tolerance.max_flip = optional_number(section, "max_flip", {0.0, 1.0});
  tolerance.max_error = optional_number(section, "max_error", {0.0, 1e6});
  const toml::node* pixels = find_key(section, "max_pixels");
  if (pixels != nullptr && pixels->is_string()) {
    const std::string text = read_text(section, "max_pixels", "");
    const std::optional<double> percent =
        text.ends_with('%') ? decimal_to_double(text.substr(0, text.size() - 1)) : std::nullopt;
    if (!percent || !(*percent >= 0.0 && *percent <= 100.0)) {
      fail_at(section, "max_pixels",
              "is no share; a number of pixels, or \"0.1%\", would be right");
    }
    tolerance.max_pixels = percent;
    tolerance.is_percent = true;
  } else {
    tolerance.max_pixels = optional_number(section, "max_pixels", {0.0, 1e12});
  }
  tolerance.max_difference = optional_number(section, "max_difference", {0.0, 1e6});
  tolerance.search_px = optional_whole(section, "search", 8);
  if ((tolerance.max_difference || tolerance.search_px) && !tolerance.max_pixels) {
    tolerance.max_pixels = 0.0;
  }
  return tolerance;
}

void check_maker(const Section& section, const Golden& golden) {
  const int makers = (golden.scene.empty() ? 0 : 1) + (golden.pipeline.empty() ? 0 : 1) +
                     (golden.shader.empty() ? 0 : 1) + (golden.command.empty() ? 0 : 1);
  if (makers != 1) {
    fail_at(section, "name",
            "has " + std::string{makers == 0 ? "nothing that makes it" : "several makers"} +
                "; one of scene, pipeline, shader and command would be right");
  }
  const bool applies = !golden.pipeline.empty() || !golden.shader.empty();
  if (applies && golden.input.empty()) {
    fail_at(section, "input", "is missing; the picture of the pipeline or shader would be right");
  }
  if (!applies && !golden.input.empty()) {
    fail_at(section, "input", "is of pipelines and shaders; without it would be right");
  }
  if (golden.command.empty()) return;
  if (!golden.options.empty()) {
    fail_at(section, "options",
            "is of scenes, pipelines and shaders; words in the command would be "
            "right");
  }
  if (!has_out(golden) && !golden.command.starts_with("softfocus ")) {
    fail_at(section, "command", "has no {out}, the file that it is to write; one would be right");
  }
}

Golden read_golden(Section& section) {
  Golden golden;
  golden.name = read_text(section, "name", "");
  if (!is_file_name(golden.name)) {
    fail_at(section, "name",
            "is no name for files; letters, digits, '.', '_' and '-' would be right, the first "
            "a letter, a digit or '_'");
  }
  golden.scene = read_text(section, "scene", "");
  golden.pipeline = read_text(section, "pipeline", "");
  golden.shader = read_text(section, "shader", "");
  golden.input = read_text(section, "input", "");
  golden.command = read_text(section, "command", "");
  golden.options = read_text(section, "options", "");
  check_maker(section, golden);
  golden.hash = optional_text(section, "hash");
  golden.was = read_texts(section, "was");
  std::vector<std::string> hashes = golden.was;
  if (golden.hash) hashes.push_back(*golden.hash);
  if (!std::all_of(hashes.begin(), hashes.end(), is_hash)) {
    fail_at(section, "hash", "is no hash; 0x and 16 digits of 0 to 9 and a to f would be right");
  }
  golden.picture = optional_text(section, "picture");
  if (golden.picture && !format_by_extension(*golden.picture)) {
    fail_at(
        section, "picture",
        "has an ending that is not known; .png, .npy, .exr, .pfm, .hdr or .tiff would be right");
  }
  if (golden.picture && is_same_place(*golden.picture, golden.input)) {
    fail_at(section, "picture", "is the input, too; a file of its own would be right");
  }
  golden.tolerance = read_tolerance(section);
  if (has_limits(golden.tolerance) && !golden.picture) {
    fail_at(section, "picture", "is missing; what the tolerance is of would be right");
  }
  finish_section(section);
  return golden;
}

std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n') {
      result += "\\n";
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string list_of(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + toml_text(text);
  return "[" + list + "]";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::string_view without_blanks(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  return begin == line.npos ? std::string_view{} : line.substr(begin);
}

bool has_line_key(std::string_view line, std::string_view key) {
  line = without_blanks(line);
  if (!line.starts_with(key)) return false;
  return without_blanks(line.substr(key.size())).starts_with('=');
}

// Whether it is the heading of a golden, whatever its blanks.
bool is_heading(std::string_view line) {
  std::string letters;
  for (const char c : line.substr(0, line.find('#'))) {
    if (c != ' ' && c != '\t' && c != '\r') letters += c;
  }
  return letters == kHeading;
}

// Whether a line gives that name, in quotes of either kind.
bool gives_name(std::string_view line, const std::string& name) {
  if (!has_line_key(line, "name")) return false;
  const std::string_view value = without_blanks(line.substr(line.find('=') + 1));
  return value.starts_with(toml_text(name)) || value.starts_with("'" + name + "'");
}

// The lines of a golden's table: from the one after its heading to before the next heading.
struct TableLines {
  std::size_t begin, end;
};

std::optional<TableLines> table_of(const std::vector<std::string>& lines, const std::string& name) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!is_heading(lines[i])) continue;
    std::size_t end = i + 1;
    while (end < lines.size() && !without_blanks(lines[end]).starts_with('[')) ++end;
    for (std::size_t line = i + 1; line < end; ++line) {
      if (gives_name(lines[line], name)) return TableLines{i + 1, end};
    }
  }
  return {};
}

bool is_empty_line(std::string_view line) {
  line = without_blanks(line);
  return line.empty() || line.front() == '#';
}

// Sets a key of one line in a table, or adds it behind the last one.
void set_key(std::vector<std::string>& lines, TableLines& table, std::string_view key,
             const std::string& value) {
  const std::string line = std::string{key} + " = " + value;
  for (std::size_t i = table.begin; i < table.end; ++i) {
    if (!has_line_key(lines[i], key)) continue;
    lines[i] = line;
    return;
  }
  std::size_t place = table.end;
  while (place > table.begin && is_empty_line(lines[place - 1])) --place;
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(place), line);
  ++table.end;
}

}  // namespace

std::vector<Golden> parse_goldens(const std::string& text, const std::filesystem::path& file) {
  const toml::table table = parse_toml(text, file.string(), "docs/goldens.md has an example");
  Section top{&table, file.string(), "", {}};
  std::vector<Golden> goldens;
  std::set<std::string> names, pictures;
  for (Section& section : read_sections(top, "golden")) {
    goldens.push_back(read_golden(section));
    if (!names.insert(goldens.back().name).second) {
      fail_at(section, "name", "is another golden's too; a name of its own would be right");
    }
    const std::optional<std::string>& picture = goldens.back().picture;
    if (picture &&
        !pictures.insert(std::filesystem::path{*picture}.lexically_normal().string()).second) {
      fail_at(section, "picture", "is another golden's too; a file of its own would be right");
    }
  }
  finish_section(top);
  return goldens;
}

std::string maker_of(const Golden& golden) {
  if (!golden.scene.empty()) return "scene " + golden.scene;
  if (!golden.pipeline.empty()) return "pipeline " + golden.pipeline;
  if (!golden.shader.empty()) return "shader " + golden.shader;
  return golden.command;
}

std::string with_golden(const std::string& text, const Golden& golden,
                        const std::filesystem::path& file) {
  std::vector<std::string> lines = lines_of(text);
  std::optional<TableLines> table = table_of(lines, golden.name);
  if (!table) {
    if (!lines.empty() && !lines.back().empty()) lines.emplace_back();
    lines.emplace_back(kHeading);
    lines.push_back("name = " + toml_text(golden.name));
    const std::array<std::pair<const char*, const std::string&>, 6> keys{
        {{"scene", golden.scene},
         {"pipeline", golden.pipeline},
         {"shader", golden.shader},
         {"input", golden.input},
         {"command", golden.command},
         {"options", golden.options}}};
    for (const auto& [key, value] : keys) {
      if (!value.empty()) lines.push_back(std::string{key} + " = " + toml_text(value));
    }
    table = TableLines{lines.size() - 1, lines.size()};
  }
  if (golden.hash) set_key(lines, *table, "hash", toml_text(*golden.hash));
  if (!golden.was.empty()) set_key(lines, *table, "was", list_of(golden.was));
  if (golden.picture) set_key(lines, *table, "picture", toml_text(*golden.picture));
  std::string result;
  for (const std::string& line : lines) result += line + "\n";
  // A text over several lines, say, may look like keys.
  std::vector<Golden> wanted = parse_goldens(text, file);
  const auto place = std::find_if(wanted.begin(), wanted.end(),
                                  [&](const Golden& other) { return other.name == golden.name; });
  const bool is_new = place == wanted.end();
  if (is_new) {
    wanted.push_back(golden);
  } else {
    *place = golden;
  }
  bool is_right = false;
  try {
    is_right = parse_goldens(result, file) == wanted;
  } catch (const SceneError&) {
    if (is_new) throw;  // it says what is wrong with what is added
  }
  if (!is_right) {
    throw UsageError(
        "'" + file.string() + "': golden '" + golden.name +
        "' cannot be changed there line by line" +
        (golden.hash ? "; write hash = " + toml_text(*golden.hash) + " yourself" : ""));
  }
  return result;
}

}  // namespace softfocus
