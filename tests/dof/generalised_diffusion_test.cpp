#include "dof/methods/generalised_diffusion.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// Relaxes until nothing moves, which shares nothing with the elimination.
void relax(std::vector<double>& line, const std::vector<double>& flow) {
  const std::vector<double> source = line;
  for (int sweep = 0; sweep < 4000; ++sweep) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double left = i > 0 ? std::min(flow[i - 1], flow[i]) : 0.0;
      const double right = i + 1 < line.size() ? std::min(flow[i], flow[i + 1]) : 0.0;
      line[i] = (source[i] + (i > 0 ? left * line[i - 1] : 0.0) +
                 (i + 1 < line.size() ? right * line[i + 1] : 0.0)) /
                (1.0 + left + right);
    }
  }
}

}  // namespace

TEST_CASE("generalised diffusion solves its equations, along rows and then along columns") {
  ThreadPool pool(2);
  constexpr int kWidth = 23, kHeight = 19;
  const Image scene = random_scene_image(kWidth, kHeight, 1);
  const DofInput input{scene, {.coc = {9.0f, 2.0f}, .max_coc_px = 7.0f}, {}};
  std::vector<double> value, flow;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const SplitTexel texel = split_texel(input, x, y);
      value.push_back(texel.g);
      const double r = std::fabs(texel.radius_px);
      flow.push_back(r > 0.5 ? r * r / 8.0 : 0.0);
    }
  }
  const auto relax_along = [&](std::size_t first, std::size_t step, std::size_t count) {
    std::vector<double> line, flows;
    for (std::size_t i = 0; i < count; ++i) {
      line.push_back(value[first + i * step]);
      flows.push_back(flow[first + i * step]);
    }
    relax(line, flows);
    for (std::size_t i = 0; i < count; ++i) value[first + i * step] = line[i];
  };
  for (std::size_t y = 0; y < kHeight; ++y) relax_along(y * kWidth, 1, kWidth);
  for (std::size_t x = 0; x < kWidth; ++x) relax_along(x, kWidth, kHeight);

  Image result = make_image(Format::rgba16f, kWidth, kHeight);
  generalised_diffusion(input, result, pool);
  double worst = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double expected = value[static_cast<std::size_t>(y * kWidth + x)];
      worst = std::max(worst, std::fabs(load_texel(result, x, y).y - expected));
    }
  }
  CHECK(worst < 0x1p-11);
}

TEST_CASE("generalised diffusion keeps the sum of all light, whatever the depths") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(120, 90, 2);
  Image result = make_image(Format::rgba16f, 120, 90);
  generalised_diffusion({scene, {.coc = {30.0f, 2.0f}, .max_coc_px = 20.0f}, {}}, result, pool);
  double before = 0.0, after = 0.0;
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 120; ++x) {
      before += load_texel(scene, x, y).x;
      after += load_texel(result, x, y).x;
    }
  }
  CHECK(after / before == doctest::Approx(1.0).epsilon(1e-4));
}

TEST_CASE("generalised diffusion blurs by the radii that it is given, whatever the depths") {
  constexpr int kSize = 61;
  Image scene = random_scene_image(kSize, kSize, 3);
  const DofSettings settings{.coc = {20.0f, 2.0f}, .max_coc_px = 9.0f};
  std::vector<float> radii;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x)
      radii.push_back(split_texel({scene, settings, {}}, x, y).radius_px);
  }
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    const Method& method = *find_method("generalised-diffusion");
    const Image of_lens = apply(method, {scene, settings, {}}, pool);
    DofInput input{.scene = scene, .settings = settings, .profile = {}, .radii_px = radii};
    CHECK(equal(apply(method, input, pool), of_lens));
    input.settings.coc = {0.0f, 1.0f};
    CHECK(equal(apply(method, input, pool), of_lens));
  }
}

TEST_CASE("generalised diffusion takes a radius's magnitude, cut to the largest circle") {
  ThreadPool pool(2);
  const Image scene = random_scene_image(50, 40, 4);
  const auto with_radii = [&](float radius_px, float sign) {
    std::vector<float> radii(50 * 40, radius_px);
    for (std::size_t i = 0; i < radii.size(); i += 3) radii[i] *= sign;
    const DofInput input{.scene = scene,
                         .settings = {.coc = {20.0f, 2.0f}, .max_coc_px = 6.0f},
                         .profile = {},
                         .radii_px = radii};
    return apply(*find_method("generalised-diffusion"), input, pool);
  };
  CHECK(equal(with_radii(5.0f, -1.0f), with_radii(5.0f, 1.0f)));
  CHECK(equal(with_radii(1e30f, -1.0f), with_radii(6.0f, 1.0f)));
  CHECK_FALSE(equal(with_radii(5.0f, 1.0f), with_radii(6.0f, 1.0f)));
  CHECK(equal(with_radii(0.5f, 1.0f), scene));
}
