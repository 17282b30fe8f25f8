#include "tools/report/report.h"

#include <fstream>
#include <iterator>
#include <string>

#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"

namespace softfocus {

namespace {

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string{"\"\""} : std::string{c};
  return result + "\"";
}

std::string csv_field(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_text()) return csv_text(value.text());
  if (!value.is_object()) return json_text(value);
  std::string settings;
  for (const std::string& name : value.names()) {
    const Json& setting = value.at(name);
    settings += (settings.empty() ? "" : ";") + name + "=" +
                (setting.is_text() ? setting.text() : json_text(setting));
  }
  return csv_text(settings);
}

}  // namespace

/// tools/report/report.html with its style sheet and script; the build makes it.
extern const std::string_view kReportTemplate;

std::string page_with(std::string_view page_template, const Json& results) {
  constexpr std::string_view kPlace = "id=\"results\">";
  const std::size_t place = page_template.find(kPlace) + kPlace.size();
  std::string page{page_template.substr(0, place)};
  for (const char c : json_text(results)) {
    // Markup in a text, such as "</script>", would end the results. Only texts have this sign.
    if (c == '<') {
      page += "\\u003c";
    } else {
      page += c;
    }
  }
  page += page_template.substr(place + std::string_view{"null"}.size());
  return page;
}

std::string report_page(const Json& report) { return page_with(kReportTemplate, report); }

Json json_list(const std::vector<Json>& values) {
  Json list = Json::array();
  for (const Json& value : values) list.push_back(value);
  return list;
}

std::string csv_of(const Json& list) {
  std::string text;
  for (const Json& point : list.values()) {
    std::string names, values;
    for (const std::string& name : point.names()) {
      names += (names.empty() ? "" : ",") + name;
      values += (&name == &point.names().front() ? "" : ",") + csv_field(point.at(name));
    }
    if (text.empty()) text = names + "\n";
    text += values + "\n";
  }
  return text;
}

Json report_series(const std::string& name, const char* kind, Json points) {
  return {{"name", name}, {"kind", kind}, {"points", std::move(points)}};
}

Json report_figure(Json& pictures, const std::string& name, const std::string& png,
                   const std::string& about, const std::string& caption) {
  pictures[name] = png;
  return {{"picture", name}, {"caption", caption}, {"about", about}};
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

void prepare_results(const std::filesystem::path& directory,
                     const std::vector<std::filesystem::path>& files) {
  make_directory(directory / "cache");
  for (const auto& file : files) check_writable(file);
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
