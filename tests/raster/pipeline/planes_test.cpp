// Attributes as planes over the window.

#include "raster/pipeline/planes.h"

#include <doctest/doctest.h>

#include <vector>

#include "raster/pipeline/draw.h"
#include "tests/support/raster_helpers.h"

using namespace softfocus;
using test::profile_named;

namespace {

constexpr int kSize = 64;

}  // namespace

TEST_CASE("llvmpipe's planes do not see the winding: the provoking vertex keeps its place") {
  test::Random random{88};
  int wrong = 0;
  for (int t = 0; t < 200; ++t) {
    std::vector<VertexOutput<4>> v;
    for (int i = 0; i < 3; ++i) {
      const glm::vec2 window{random.between(0.0f, 64.0f), random.between(0.0f, 64.0f)};
      v.push_back({test::at_window(window, kSize, kSize) * random.between(0.5f, 3.0f),
                   {random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f),
                    random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f)}});
    }
    const auto drawn = [&](const std::vector<VertexOutput<4>>& vertices,
                           ProvokingVertex provoking) {
      Image target = make_image(Format::rgba32f, kSize, kSize);
      DrawState state = test::plain_state();
      state.provoking_vertex = provoking;
      test::draw_list({.colour = {&target}}, state, vertices,
                      test::VaryingColour<Interpolation::perspective>{}, profile_named("llvmpipe"));
      return target;
    };
    wrong +=
        !equal(drawn(v, ProvokingVertex::last), drawn({v[1], v[0], v[2]}, ProvokingVertex::last));
    wrong +=
        !equal(drawn(v, ProvokingVertex::first), drawn({v[0], v[2], v[1]}, ProvokingVertex::first));
  }
  CHECK(wrong == 0);
}

TEST_CASE("softpipe steps its planes from the upper left pixel of each 2x2 block") {
  test::Random random{89};
  int wrong = 0;
  int differs_from_its_own_column = 0;
  for (int t = 0; t < 400; ++t) {
    std::array<WindowVertex, 3> v{};
    for (WindowVertex& vertex : v) {
      const float x = random.between(0.0f, 64.0f);
      vertex = {x, random.between(0.0f, 64.0f), 0.5f, 1.0f};
    }
    const auto setup = set_up_triangle(v, Cull::none, FrontFace::clockwise, {0, 0, kSize, kSize},
                                       profile_named("softpipe"));
    if (!setup) continue;
    const PlanesByQuad planes{*setup, 2, profile_named("softpipe")};
    const Plane p = planes.plane({random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f), 1.0f});
    const int x = 2 * random.whole(0, 31);
    const int y = 2 * random.whole(0, 31);
    const float corner =
        (p.at_origin + p.per_x * static_cast<float>(x)) + p.per_y * static_cast<float>(y);
    wrong += planes.at(p, x, y) != corner;
    wrong += planes.at(p, x + 1, y) != corner + p.per_x;
    wrong += planes.at(p, x, y + 1) != corner + p.per_y;
    wrong += planes.at(p, x + 1, y + 1) != (corner + p.per_x) + p.per_y;
    const float from_origin =
        (p.at_origin + p.per_x * static_cast<float>(x + 1)) + p.per_y * static_cast<float>(y);
    differs_from_its_own_column += planes.at(p, x + 1, y) != from_origin;
  }
  CHECK(wrong == 0);
  CHECK(differs_from_its_own_column > 50);
}
