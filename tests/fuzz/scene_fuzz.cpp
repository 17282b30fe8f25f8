// Any text as a scene file: a scene that can be drawn, or a SceneError.

#include <algorithm>
#include <string>

#include "scenes/draw/draw_scene.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/load_scene.h"

namespace {

/// Sizes of textures and meshes of 3 to 5 digits become 32: what large ones cost is no finding.
std::string with_small_sizes(std::string text) {
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string line = text.substr(start, end - start);
    const std::string key = line.substr(0, line.find('='));
    bool counts = false;
    for (const char* word : {"size", "segments", "rings", "sides", "cells", "count"}) {
      counts = counts || key.find(word) != key.npos;
    }
    const std::size_t first = counts ? line.find_first_of("0123456789", key.size()) : line.npos;
    const std::size_t last =
        first == line.npos ? first
                           : std::min(line.find_first_not_of("0123456789", first), line.size());
    if (first != line.npos && last - first >= 3 && last - first <= 5) {
      text.replace(start + first, last - first, "32");
      start = start + first + 2;
    }
    start = text.find('\n', start);
    if (start == text.npos) break;
    ++start;
  }
  return text;
}

}  // namespace

int softfocus::fuzz_scene(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMostTriangles = 20000;
  try {
    const std::string text = with_small_sizes({reinterpret_cast<const char*>(data), size});
    const Scene scene = read_scene_text(text, "fuzz.toml");
    std::size_t triangles = 0;
    for (const Object& object : scene.objects) {
      triangles += scene.meshes[object.mesh].indices.size() / 3;
    }
    if (triangles > kMostTriangles) return 0;
    ThreadPool pool(1);
    draw_scene(scene, camera_matrices(scene.camera, 1, 16, 16), 1, 16, 16, Profile{}, pool);
  } catch (const SceneError&) {
  }
  return 0;
}
