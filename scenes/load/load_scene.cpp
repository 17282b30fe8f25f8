#include "scenes/load/load_scene.h"

#include <algorithm>
#include <charconv>

#include "scenes/files/nearest_name.h"
#include "scenes/load/model_scene.h"
#include "scenes/load/obj_model.h"
#include "scenes/load/scene_file.h"
#include "scenes/random/random_scene.h"

namespace softfocus {
namespace {

// ASCII only: an extension's case, and no locale's.
bool has_extension(std::string_view path, std::string_view extension) {
  if (path.size() < extension.size()) return false;
  const std::string_view end = path.substr(path.size() - extension.size());
  return std::equal(end.begin(), end.end(), extension.begin(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

[[noreturn]] void fail_unknown(std::string_view name, const std::vector<SceneListing>& listings) {
  std::vector<std::string> there;
  std::string names;
  for (const SceneListing& listing : listings) {
    there.push_back(listing.name);
    names += (names.empty() ? "" : ", ") + listing.name;
  }
  throw SceneError("there is no scene \"" + std::string(name) + "\"" +
                   (names.empty() ? "; no scenes were found at all: give a .toml or .obj file"
                                  : "; there are " + names +
                                        ", random:SEED, and any .toml or .obj file can be given") +
                   did_you_mean(name, there));
}

constexpr std::string_view kRandom = "random:";

// One number has one spelling, so that one scene has one name.
std::uint64_t read_seed(std::string_view scene) {
  const std::string_view digits = scene.substr(kRandom.size());
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seed);
  if (error != std::errc{} || end != digits.data() + digits.size() ||
      std::to_string(seed) != digits) {
    throw SceneError("\"" + std::string(scene) +
                     "\" has no seed; a whole number from 0 to 18446744073709551615 without "
                     "leading zeros would be right, as in random:7");
  }
  return seed;
}

}  // namespace

bool is_random_scene(std::string_view scene) { return scene.starts_with(kRandom); }

Scene load_scene(std::string_view scene, const std::vector<std::filesystem::path>& search_path) {
  if (is_random_scene(scene)) return make_random_scene(read_seed(scene));
  const std::filesystem::path file{scene};
  if (has_extension(scene, ".toml")) return read_scene_file(file);
  if (has_extension(scene, ".obj")) {
    return make_model_scene(load_obj_model(file), file.stem().string());
  }
  const auto listings = list_scenes(search_path);
  const auto found = std::find_if(listings.begin(), listings.end(),
                                  [&](const SceneListing& l) { return l.name == scene; });
  if (found == listings.end()) fail_unknown(scene, listings);
  return read_scene_file(found->file);
}

std::size_t triangle_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Object& object : scene.objects) count += scene.meshes[object.mesh].indices.size() / 3;
  return count;
}

}  // namespace softfocus
