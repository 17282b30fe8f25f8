#include "scenes/make/procedural_texture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

using namespace softfocus;

namespace {

using Texel = std::array<std::uint8_t, 4>;

Image picture_of(const std::vector<Texel>& texels) {
  Image picture = make_image(Format::srgb8, static_cast<int>(texels.size()), 1);
  const auto to = row<std::uint8_t>(picture, 0);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    std::copy(texels[i].begin(), texels[i].end(), &to[4 * i]);
  }
  return picture;
}

std::vector<int> opacities(const Texture& texture) {
  std::vector<int> values;
  const auto texels = row<std::uint8_t>(texture.levels[0], 0);
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    CHECK(texels[i + 1] == texels[i]);
    CHECK(texels[i + 3] == texels[i]);
    values.push_back(texels[i]);
  }
  return values;
}

}  // namespace

TEST_CASE("a picture's opacity is its alpha where it has one") {
  const Texture opacity = make_opacity_texture(picture_of({{9, 9, 9, 255}, {200, 0, 0, 7}}));
  CHECK(opacities(opacity) == std::vector<int>{255, 7});
  CHECK(opacity.levels.size() == 2);
}

TEST_CASE("an opaque picture's opacity is the mean of its colours, rounded") {
  const Texture opacity = make_opacity_texture(
      picture_of({{255, 255, 255, 255}, {0, 0, 1, 255}, {0, 1, 1, 255}, {10, 20, 60, 255}}));
  CHECK(opacities(opacity) == std::vector<int>{255, 0, 1, 30});
}

TEST_CASE("texels of 0 and 1 alone make a cut-out") {
  CHECK(is_cut_out(make_opacity_texture(picture_of({{5, 5, 5, 255}, {5, 5, 5, 0}}))));
  CHECK(is_cut_out(make_opacity_texture(picture_of({{255, 255, 255, 255}, {0, 0, 0, 255}}))));
  CHECK_FALSE(is_cut_out(make_opacity_texture(picture_of({{5, 5, 5, 254}, {5, 5, 5, 0}}))));
}
