#include <algorithm>

#include "scenes/load/load_scene.h"

namespace softfocus {
namespace {

// Where an installation that was moved has its scenes: beside the program's own place.
std::filesystem::path beside_program() {
  std::error_code unknown;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
  if (unknown) return {};
  return program.parent_path().parent_path() / "share" / "softfocus" / "scenes";
}

}  // namespace

std::vector<std::filesystem::path> scene_search_path(
    const std::vector<std::filesystem::path>& from_user) {
  std::vector<std::filesystem::path> path = from_user;
  path.emplace_back(SOFTFOCUS_SOURCE_SCENES);
  if (const auto beside = beside_program(); !beside.empty()) path.push_back(beside);
  path.emplace_back(SOFTFOCUS_INSTALLED_SCENES);
  return path;
}

std::vector<SceneListing> find_scenes(const std::vector<std::filesystem::path>& search_path) {
  std::vector<SceneListing> listings;
  for (const auto& directory : search_path) {
    std::error_code unreadable;
    for (const auto& entry : std::filesystem::directory_iterator(directory, unreadable)) {
      const auto& file = entry.path();
      if (file.extension() != ".toml" || entry.is_directory(unreadable)) continue;
      SceneListing listing{file.stem().string(), "", file};
      const bool is_known = std::any_of(listings.begin(), listings.end(), [&](const auto& other) {
        return other.name == listing.name;
      });
      if (is_known) continue;
      listings.push_back(std::move(listing));
    }
  }
  // A directory comes in no particular order.
  std::sort(listings.begin(), listings.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return listings;
}

std::vector<SceneListing> list_scenes(const std::vector<std::filesystem::path>& search_path) {
  std::vector<SceneListing> listings = find_scenes(search_path);
  for (SceneListing& listing : listings) {
    try {
      listing.title = read_scene_title(listing.file);
    } catch (const SceneError& error) {
      // Worth a line in the list, and no reason to hide the others.
      listing.title = std::string("(cannot be read: ") + error.what() + ")";
    }
  }
  return listings;
}

}  // namespace softfocus
