#include "tools/report/report_files.h"

#include <fstream>
#include <iterator>
#include <string>

#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"

namespace softfocus {

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
