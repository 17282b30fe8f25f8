// An input is checked before a method sees it.

#include <doctest/doctest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "dof/dof.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

std::string error_of(const DofInput& input) {
  const Image result = make_image(Format::rgba16f, input.scene.width, input.scene.height);
  const char* error = input_error(input, result);
  return error == nullptr ? "" : error;
}

}  // namespace

TEST_CASE("a picture needs no radii and no objects, or one of each a pixel") {
  const Image scene = random_scene_image(6, 4, 1);
  CHECK(error_of({scene, {}, {}}) == "");
  for (const std::size_t count : {1u, 23u, 24u, 25u}) {
    CAPTURE(count);
    const std::vector<float> radii(count, 2.0f);
    const std::vector<std::uint16_t> objects(count);
    const bool right = count == 24;
    CHECK(error_of({.scene = scene, .settings = {}, .profile = {}, .radii_px = radii}) ==
          (right ? "" : "there is not one radius for each pixel"));
    CHECK(error_of({.scene = scene, .settings = {}, .profile = {}, .objects = objects}) ==
          (right ? "" : "there is not one object number for each pixel"));
  }
}

TEST_CASE("a radius that is given must be finite, of either sign") {
  const Image scene = random_scene_image(6, 4, 1);
  std::vector<float> radii(24, 2.0f);
  const auto error_with = [&](float radius_px) {
    radii[23] = radius_px;
    return error_of({.scene = scene, .settings = {}, .profile = {}, .radii_px = radii});
  };
  CHECK(error_with(-1e30f) == "");
  CHECK(error_with(std::numeric_limits<float>::infinity()) == "a radius is not finite");
  CHECK(error_with(-std::numeric_limits<float>::infinity()) == "a radius is not finite");
  CHECK(error_with(std::numeric_limits<float>::quiet_NaN()) == "a radius is not finite");
}

TEST_CASE("layers behind a picture are at most three, of its size and format") {
  const Image scene = random_scene_image(6, 4, 1), other = random_scene_image(4, 6, 1);
  const auto error_with = [&](const std::vector<ConstImageView>& behind) {
    return error_of({.scene = scene, .settings = {}, .profile = {}, .behind = behind});
  };
  CHECK(error_with({scene, scene, scene}) == "");
  CHECK(error_with({scene, scene, scene, scene}) ==
        "there are more than 3 layers behind the first");
  CHECK(error_with({scene, other}) == "a layer has not the scene's size and format");
  CHECK(error_with({make_image(Format::rgba32f, 6, 4)}) ==
        "a layer has not the scene's size and format");
  CHECK(error_with({ConstImageView{Format::rgba16f, 6, 4, 48, nullptr}}) == "there is no memory");
}

TEST_CASE("an aperture that cannot be is an error") {
  const Image scene = random_scene_image(6, 4, 1);
  const auto error_with = [&](const Aperture& aperture) {
    DofSettings settings;
    settings.aperture = aperture;
    return error_of({scene, settings, {}});
  };
  CHECK(error_with({.blades = 5, .stretch = 2.0f}) == "");
  CHECK(error_with({.blades = 2}) != "");
}
