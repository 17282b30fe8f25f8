#include "tools/report/report.h"

#include <fstream>
#include <iterator>
#include <string>

#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"

namespace softfocus {

/// tools/report/report.html with its style sheet and script; the build makes it.
extern const std::string_view kReportTemplate;

std::string report_page(const Json& report) {
  constexpr std::string_view kPlace = "id=\"results\">";
  const std::size_t place = kReportTemplate.find(kPlace) + kPlace.size();
  std::string page{kReportTemplate.substr(0, place)};
  for (const char c : json_text(report)) {
    // Markup in a text, such as "</script>", would end the results. Only texts have this sign.
    if (c == '<') {
      page += "\\u003c";
    } else {
      page += c;
    }
  }
  page += kReportTemplate.substr(place + std::string_view{"null"}.size());
  return page;
}

Json json_list(const std::vector<Json>& values) {
  Json list = Json::array();
  for (const Json& value : values) list.push_back(value);
  return list;
}

std::string command_text(const std::vector<std::string>& words) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:";
  std::string text;
  for (const std::string& word : words) {
    text += text.empty() ? "" : " ";
    if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string{"'\\''"} : std::string{c};
    text += '\'';
  }
  return text;
}

std::string joined_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

void make_directory(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  // Another process may have made it in the meantime.
  std::error_code no_directory;
  if (error && !std::filesystem::is_directory(directory, no_directory)) {
    throw FileError("cannot make the directory '" + directory.string() + "': " + error.message() +
                    "; give -o a place that can be written to");
  }
}

void write_text(const std::filesystem::path& file, std::string_view text) {
  WholeFile whole{file};
  whole.write(text);
  whole.commit();
}

void write_json(const std::filesystem::path& file, const Json& json) {
  // A file's name need not be UTF-8, but JSON must be.
  write_text(file, json_text(json, 1) + "\n");
}

std::optional<Json> read_json(const std::filesystem::path& file) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) return {};  // a device need not end
  std::ifstream stream{file, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{stream}, {}};
  auto json = parse_json(text);
  if (json && !json->is_object()) json.reset();
  return json;
}

}  // namespace softfocus
