#include "raster/effects/effect.h"

#include <doctest/doctest.h>

#include <set>

#include "raster/images/texel.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;

namespace {

std::vector<double> presets_of(const Effect& effect) {
  std::vector<double> values;
  for (const Parameter& parameter : effect.parameters) values.push_back(parameter.preset);
  return values;
}

/// For effects that read one.
Image some_velocity(const Image& picture) {
  Image velocity = make_image(Format::rg16f, picture.width, picture.height);
  for (int y = 0; y < velocity.height; ++y) {
    for (int x = 0; x < velocity.width; ++x) {
      store_texel(velocity, x, y, {0.5f * static_cast<float>(x - y), 20.0f, 0.0f, 1.0f}, {});
    }
  }
  return velocity;
}

}  // namespace

TEST_CASE("effects have names of their own and presets within their limits") {
  std::set<std::string_view> names;
  for (const Effect& effect : effects()) {
    CAPTURE(effect.name);
    CHECK(names.insert(effect.name).second);
    CHECK(find_effect(effect.name) == &effect);
    for (const Parameter& parameter : effect.parameters) {
      CHECK(parameter.least <= parameter.preset);
      CHECK(parameter.preset <= parameter.most);
    }
    if (effect.velocity == VelocityOf::nothing) continue;
    REQUIRE(!effect.parameters.empty());
    CHECK(effect.parameters[0].name == "shutter");
  }
  CHECK(find_effect("nothing") == nullptr);
}

TEST_CASE("an effect keeps alpha, and its bits do not depend on threads or vectors") {
  const Image picture = test::random_halves(75, 70, 17, 0.0, 9.0);
  const Image velocity = some_velocity(picture);
  for (const Effect& effect : effects()) {
    if (effect.filter == nullptr) continue;  // of frames
    CAPTURE(effect.name);
    const std::vector<double> parameters = presets_of(effect);
    ThreadPool alone{1, Isa::scalar};
    const Image expected = apply(effect, {picture, parameters, {}, velocity}, alone);
    int wrong = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        wrong += load_texel(expected, x, y).w != load_texel(picture, x, y).w;
      }
    }
    CHECK(wrong == 0);
    for (const Isa isa : available_isas()) {
      ThreadPool pool{3, isa};
      CHECK(equal(apply(effect, {picture, parameters, {}, velocity}, pool), expected));
    }
  }
}

TEST_CASE("an effect that spreads light keeps what is even") {
  Image picture = make_image(Format::rgba16f, 40, 30);
  for (int y = 0; y < picture.height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(picture, y)) value = 0x3800;
  }
  ThreadPool pool{2};
  const Image velocity = some_velocity(picture);
  for (const Effect& effect : effects()) {
    if (!effect.spreads) continue;
    CAPTURE(effect.name);
    const std::vector<double> parameters = presets_of(effect);
    CHECK(equal(apply(effect, {picture, parameters, {}, velocity}, pool), picture));
  }
}
