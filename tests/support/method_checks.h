#pragma once
// Checks that several methods of depth of field have to pass.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "dof/dof.h"
#include "tests/support/test_images.h"

namespace softfocus::test {

/// Checks that a method gives its oracle's bits on every isa and on 1 to 3 threads. Both take
/// (DofInput, Image&, ThreadPool&).
template <class MethodFunction, class Oracle>
void check_oracle(const MethodFunction& method, const Oracle& oracle, const DofInput& input) {
  const int width = input.scene.width, height = input.scene.height;
  ThreadPool any(1);
  Image expected = make_image(Format::rgba16f, width, height);
  oracle(input, expected, any);
  for (const Isa isa : available_isas()) {
    for (const int threads : {1, 2, 3}) {
      ThreadPool pool(threads, isa);
      Image result = random_scene_image(width, height, 99);
      method(input, result, pool);
      INFO(std::string{isa_name(isa)}, " on ", threads, " threads, ", width, "x", height,
           ", max_coc ", input.settings.max_coc_px);
      CHECK(equal(result, expected));
    }
  }
}

/// Checks the soft edge of a black near half-plane of radius 10 px before a white wall, which is in
/// focus or behind the focus: each pixel has the part of its disc that lies beside the edge.
template <class MethodFunction>
void check_soft_near_edge(const MethodFunction& method, double tolerance) {
  ThreadPool pool(2);
  for (const float wall_m : {2.0f, 4.0f}) {
    const Image scene = grey_depth_picture(128, 64, [&](int x, int) {
      return x < 64 ? std::pair{0.0f, 1.0f} : std::pair{1.0f, wall_m};
    });
    Image result = make_image(Format::rgba16f, scene.width, scene.height);
    method(DofInput{scene, {.coc = {10.0f, 2.0f}, .max_coc_px = 16.0f}, {}}, result, pool);
    for (int x = 0; x < 128; ++x) {
      const double apart = std::clamp((x - 63.5) / 10.0, -1.0, 1.0);
      const double black =
          (std::acos(apart) - apart * std::sqrt(1.0 - apart * apart)) / 3.14159265358979;
      INFO("wall at ", wall_m, " m, x ", x);
      CHECK(std::fabs(load_texel(result, x, 32).x - (1.0 - black)) < tolerance);
    }
  }
}

}  // namespace softfocus::test
