#include "tools/gl/driver/lavapipe.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <vector>

#include "tools/gl/driver/driver.h"

namespace softfocus {
namespace {

using Paths = std::vector<std::filesystem::path>;

// The paths of a list such as "/usr/local/share:/usr/share"; `otherwise` stands for a variable that
// is not set.
Paths paths_in(const char* variable, const std::string& otherwise) {
  const char* const set = std::getenv(variable);
  std::istringstream list{set != nullptr && *set != '\0' ? set : otherwise};
  Paths paths;
  for (std::string path; std::getline(list, path, ':');) {
    if (!path.empty()) paths.emplace_back(path);
  }
  return paths;
}

bool is_lavapipe(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  std::error_code unknown;
  return name.starts_with("lvp_icd") && name.ends_with(".json") &&
         std::filesystem::exists(file, unknown);
}

Paths user_files() {
  Paths files;
  for (const char* variable : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"}) {
    const Paths named = paths_in(variable, "");
    std::copy_if(named.begin(), named.end(), std::back_inserter(files), is_lavapipe);
  }
  return files;
}

// A machine with two word sizes has a file for each. The loader takes what fits the process.
Paths files_in(const Paths& folders) {
  Paths files;
  for (const std::filesystem::path& folder : folders) {
    std::error_code unknown;
    for (const auto& entry : std::filesystem::directory_iterator{folder, unknown}) {
      if (is_lavapipe(entry.path())) files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Paths standard_folders() {
  const char* const home = std::getenv("HOME");
  Paths roots =
      paths_in("XDG_DATA_HOME", home != nullptr ? std::string{home} + "/.local/share" : "");
  for (const auto& root : paths_in("XDG_DATA_DIRS", "/usr/local/share:/usr/share")) {
    roots.push_back(root);
  }
  roots.emplace_back("/etc");
  for (auto& root : roots) root /= "vulkan/icd.d";
  return roots;
}

std::string joined(const Paths& paths, const char* between) {
  std::string text;
  for (const auto& path : paths) text += (text.empty() ? "" : between) + path.string();
  return text;
}

}  // namespace

std::string lavapipe_files() {
  Paths files = user_files();
  if (!files.empty()) return joined(files, ":");
  const Paths folders = standard_folders();
  files = files_in(folders);
  if (files.empty()) {
    throw DriverError("no lvp_icd*.json in " + joined(folders, ", ") +
                      "; Debian's package mesa-vulkan-drivers has it");
  }
  return joined(files, ":");
}

}  // namespace softfocus
