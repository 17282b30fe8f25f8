// The gate of "the same bits everywhere": hashes of whole frames. They must hold for
// every machine, compiler, optimisation level and thread count. When one changes, find
// the operation that changed before touching the table; print the new table with
//     SOFTFOCUS_PRINT_GOLDEN=1 softfocus_tests -tc="*golden*"

#include <doctest/doctest.h>

#include <cstdint>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <map>
#include <string>
#include <string_view>

#include "dof/method.h"
#include "scenes/draw_scene.h"
#include "scenes/load_scene.h"

using namespace softfocus;

namespace {

struct Golden {
  std::string_view scene;
  std::string_view method;
  std::string_view profile;
  int width;
  int height;
  std::uint64_t hash;
};

constexpr Golden kGolden[] = {
#include "tests/golden_table.inc"
};

// Making a scene's textures takes longer than drawing it small: each is loaded once.
const Scene& loaded(std::string_view name) {
  static std::map<std::string, Scene, std::less<>> scenes;
  auto found = scenes.find(name);
  if (found == scenes.end()) {
    found = scenes.emplace(name, load_scene(name, scene_search_path({}))).first;
  }
  return found->second;
}

// Frame 7, so that what moves has moved; the scene's own lens.
Image render(const Golden& golden, ThreadPool& pool) {
  const Scene& scene = loaded(golden.scene);
  const Profile profile = find_profile(golden.profile).value();
  const View view = camera_view(scene.camera, 7, golden.width, golden.height);
  const Image picture = draw_scene(scene, view, 7, golden.width, golden.height, profile, pool);
  DofSettings settings;
  settings.coc =
      pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, golden.height, scene.lens.coc_scale);
  settings.max_coc_px = static_cast<float>(scene.lens.max_coc_px_at_1024 * golden.height / 1024.0);
  return find_method(golden.method)->apply({picture, settings, profile}, pool);
}

std::string describe(const Golden& g) {
  return std::string(g.scene) + ' ' + std::string(g.method) + ' ' + std::string(g.profile) + ' ' +
         std::to_string(g.width) + 'x' + std::to_string(g.height);
}

}  // namespace

TEST_CASE("every frame has its golden hash") {
  ThreadPool pool(1);
  const bool print = std::getenv("SOFTFOCUS_PRINT_GOLDEN") != nullptr;
  for (const Golden& golden : kGolden) {
    CAPTURE(describe(golden));
    const std::uint64_t hash = hash_image(render(golden, pool));
    if (print) {
      std::cout << "{\"" << golden.scene << "\", \"" << golden.method << "\", \"" << golden.profile
                << "\", " << golden.width << ", " << golden.height << ", 0x" << std::hex
                << std::setw(16) << std::setfill('0') << hash << std::dec << "},\n";
    }
    CHECK(hash == golden.hash);
  }
}

TEST_CASE("a frame's golden hash does not depend on the number of threads") {
  for (const Golden& golden : kGolden) {
    if (golden.profile != "ieee") continue;
    CAPTURE(describe(golden));
    for (const int threads : {2, 3, 8}) {
      ThreadPool pool(threads);
      CHECK(hash_image(render(golden, pool)) == golden.hash);
    }
  }
}

TEST_CASE("a golden hash tells one profile's frame from another's") {
  ThreadPool pool(2);
  const Golden ieee{"figures", "two-pass", "ieee", 64, 64, 0};
  Golden other = ieee;
  other.profile = "llvmpipe";
  CHECK(hash_image(render(ieee, pool)) != hash_image(render(other, pool)));
}
