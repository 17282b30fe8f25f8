// Which triangles and which of their pixels the draw call's state leaves out.

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/coverage_counts.h"

using namespace softfocus;
using test::count_at;
using test::count_coverage;
using test::window_triangles;
using test::wrong_pixels;

namespace {

struct FaceColour {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<0>& f) const {
    return {{glm::vec4{f.front_facing ? 1.0f : 2.0f}}, false};
  }
};

}  // namespace

TEST_CASE("both windings of a triangle cover the same pixels, and culling takes one away") {
  const std::vector<glm::vec2> clockwise{{3.0f, 2.0f}, {13.0f, 5.0f}, {6.0f, 14.0f}};
  const std::vector<glm::vec2> counter{clockwise[0], clockwise[2], clockwise[1]};
  const auto covered = [&](const std::vector<glm::vec2>& points, Cull cull, FrontFace face) {
    DrawState state = test::adding_state();
    state.cull = cull;
    state.front_face = face;
    const Image counts = count_coverage(window_triangles(points, 16, 16), 16, 16, {}, state);
    int sum = 0;
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) sum += static_cast<int>(count_at(counts, x, y));
    }
    return sum;
  };
  const int all = covered(clockwise, Cull::none, FrontFace::counter_clockwise);
  CHECK(all > 30);
  CHECK(covered(counter, Cull::none, FrontFace::counter_clockwise) == all);
  CHECK(covered(clockwise, Cull::back, FrontFace::counter_clockwise) == 0);
  CHECK(covered(counter, Cull::back, FrontFace::counter_clockwise) == all);
  CHECK(covered(clockwise, Cull::front, FrontFace::counter_clockwise) == all);
  CHECK(covered(clockwise, Cull::back, FrontFace::clockwise) == all);
  CHECK(covered(counter, Cull::back, FrontFace::clockwise) == 0);
}

TEST_CASE("the fragment stage is told which face it draws") {
  const std::vector<glm::vec2> clockwise{{-9.0f, -9.0f}, {30.0f, -9.0f}, {-9.0f, 30.0f}};
  for (const FrontFace face : {FrontFace::clockwise, FrontFace::counter_clockwise}) {
    Image target = make_image(Format::r32f, 8, 8);
    DrawState state = test::plain_state();
    state.front_face = face;
    test::draw_list({.colour = {&target}}, state, window_triangles(clockwise, 8, 8), FaceColour{});
    CHECK(count_at(target, 4, 4) == (face == FrontFace::clockwise ? 1.0f : 2.0f));
  }
}

TEST_CASE("a scissor lets through the pixels it holds and no others, across tiles") {
  for (const Rectangle& scissor : {Rectangle{3, 5, 17, 9},
                                   {60, 63, 70, 65},
                                   {-50, -50, 1000, 3},
                                   {64, 64, 128, 128},
                                   {10, 10, 11, 11}}) {
    DrawState state = test::adding_state();
    state.scissor = scissor;
    const Image counts = count_coverage(test::covering_quad(100, 90), 100, 90, {}, state);
    CHECK(wrong_pixels(counts, [&](int x, int y) {
            return x >= scissor.x_begin && x < scissor.x_end && y >= scissor.y_begin &&
                   y < scissor.y_end;
          }) == 0);
  }
}

TEST_CASE("an empty, turned or far away scissor lets nothing through") {
  for (const Rectangle& scissor :
       {Rectangle{5, 5, 5, 9}, {9, 9, 5, 5}, {200, 0, 300, 50}, {-20, -20, -10, -10}}) {
    DrawState state = test::adding_state();
    state.scissor = scissor;
    const Image counts = count_coverage(test::covering_quad(100, 90), 100, 90, {}, state);
    CHECK(wrong_pixels(counts, [](int, int) { return 0; }) == 0);
  }
}
