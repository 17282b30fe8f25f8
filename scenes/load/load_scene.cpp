#include "scenes/load/load_scene.h"

#include <algorithm>
#include <charconv>

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

// How many letters to insert, drop or replace to get from one name to the other
// (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> costs(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) costs[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = costs[0];
    costs[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[j - 1] ? 1 : 0);
      diagonal = costs[j];
      costs[j] = std::min({replaced, costs[j] + 1, costs[j - 1] + 1});
    }
  }
  return costs[b.size()];
}

[[noreturn]] void fail_unknown(std::string_view name, const std::vector<SceneListing>& listings) {
  std::string names;
  std::string nearest;
  std::size_t least = 3;  // farther off is no slip of the finger
  for (const SceneListing& listing : listings) {
    names += (names.empty() ? "" : ", ") + listing.name;
    const std::size_t distance = edit_distance(name, listing.name);
    if (distance < least) {
      least = distance;
      nearest = "; did you mean " + listing.name + "?";
    }
  }
  throw SceneError("there is no scene \"" + std::string(name) + "\"" + nearest +
                   (names.empty() ? "; no scenes were found at all: give a .toml or .obj file"
                                  : "; there are " + names +
                                        ", random:SEED, and any .toml or .obj file can be given"));
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
