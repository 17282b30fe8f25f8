#include "dof/methods/diffusion.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dof/picture_planes.h"
#include "raster/images/texel.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// A layer as the header has it, in double: places in it and out of it, their radii and values.
struct Layer {
  int width, height;
  std::vector<bool> inside;
  std::vector<double> radius;
  std::vector<std::vector<double>> channels;
};

// Relaxes a line until nothing moves, which shares nothing with the elimination.
void relax(std::vector<double>& line, const std::vector<double>& flow) {
  const std::vector<double> source = line;
  for (int sweep = 0; sweep < 1500; ++sweep) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const double left = i > 0 ? std::min(flow[i - 1], flow[i]) : 0.0;
      const double right = i + 1 < line.size() ? std::min(flow[i], flow[i + 1]) : 0.0;
      line[i] = (source[i] + (i > 0 ? left * line[i - 1] : 0.0) +
                 (i + 1 < line.size() ? right * line[i + 1] : 0.0)) /
                (1.0 + left + right);
    }
  }
}

void diffuse_line(Layer& layer, std::size_t first, std::size_t step, std::size_t count) {
  const std::vector<double> own = layer.radius;
  std::vector<double> flow(count);
  for (std::size_t i = 0; i < count; ++i) {
    double& radius = layer.radius[first + i * step];
    for (std::size_t j = 0; j < count && !layer.inside[first + i * step]; ++j) {
      const double apart = std::fabs(static_cast<double>(i) - static_cast<double>(j));
      radius = std::max(radius, own[first + j * step] - apart / 8.0);
    }
    flow[i] = radius > 0.5 ? radius * radius / 8.0 : 0.0;
  }
  for (std::vector<double>& channel : layer.channels) {
    std::vector<double> line(count);
    for (std::size_t i = 0; i < count; ++i) line[i] = channel[first + i * step];
    relax(line, flow);
    for (std::size_t i = 0; i < count; ++i) channel[first + i * step] = line[i];
  }
}

void diffuse(Layer& layer) {
  const auto width = static_cast<std::size_t>(layer.width);
  const auto height = static_cast<std::size_t>(layer.height);
  for (std::size_t y = 0; y < height; ++y) diffuse_line(layer, y * width, 1, width);
  for (std::size_t x = 0; x < width; ++x) diffuse_line(layer, x, width, height);
}

// The green of the result.
std::vector<double> oracle(const DofInput& input) {
  const int width = input.scene.width, height = input.scene.height;
  const auto count = static_cast<std::size_t>(width * height);
  std::vector<double> colour, radius;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const SplitTexel texel = split_texel(input, x, y);
      colour.push_back(texel.g);
      radius.push_back(texel.radius_px);
    }
  }
  // Channels: premultiplied colour, opacity, colour outside.
  const auto layer_where = [&](double side) {
    Layer layer{width, height, {}, {}, std::vector(3, std::vector<double>(count))};
    for (std::size_t i = 0; i < count; ++i) {
      const bool inside = side * radius[i] > 0.5;
      layer.inside.push_back(inside);
      layer.radius.push_back(inside ? std::fabs(radius[i]) : 0.0);
      layer.channels[0][i] = inside ? colour[i] : 0.0;
      layer.channels[1][i] = inside ? 1.0 : 0.0;
      layer.channels[2][i] = inside ? 0.0 : colour[i];
    }
    diffuse(layer);
    return layer;
  };
  const Layer far = layer_where(1.0);
  for (std::size_t i = 0; i < count; ++i) {
    if (far.inside[i]) colour[i] = far.channels[0][i] / far.channels[1][i];
  }
  const Layer near = layer_where(-1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const double behind =
        near.inside[i] ? near.channels[2][i] : (1.0 - near.channels[1][i]) * colour[i];
    colour[i] = near.channels[0][i] + behind;
  }
  return colour;
}

Image diffused(const Image& scene, const DofSettings& settings, Isa isa = widest_isa()) {
  ThreadPool pool(2, isa);
  Image result = make_image(Format::rgba16f, scene.width, scene.height);
  diffusion({scene, settings, {}}, result, pool);
  return result;
}

// Grey from 0 to 1 by place, at a depth by place.
template <class GreyAt, class DepthAt>
Image grey_scene(int width, int height, const GreyAt& grey_at, const DepthAt& depth_at) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float grey = grey_at(x, y);
      store_texel(image, x, y, {grey, grey, grey, depth_at(x, y)}, {});
    }
  }
  return image;
}

// The focus is at 2 m; depths whose circles have a radius of 8 pixels.
constexpr DofSettings kEight{.coc = {16.0f, 2.0f}, .max_coc_px = 16.0f};
constexpr float kFar = 4.0f, kSharp = 2.0f, kNear = 4.0f / 3.0f;

}  // namespace

TEST_CASE("diffusion solves its equations, layer by layer, along rows and then along columns") {
  const Image scene = random_scene_image(29, 23, 1);
  // Far, near and sharp patches; far alone; near alone.
  for (const float focus_m : {3.0f, 0.4f, 9.0f}) {
    const DofSettings settings{.coc = {9.0f, focus_m}, .max_coc_px = 7.0f};
    const std::vector<double> expected = oracle({scene, settings, {}});
    const Image result = diffused(scene, settings);
    double worst = 0.0;
    for (int y = 0; y < 23; ++y) {
      for (int x = 0; x < 29; ++x) {
        const double value = expected[static_cast<std::size_t>(y * 29 + x)];
        worst = std::max(worst, std::fabs(load_texel(result, x, y).y - value));
      }
    }
    CAPTURE(focus_m);
    CHECK(worst < 0x1p-11);
  }
}

TEST_CASE("diffusion has the same bits on every vector unit where layers reach few lines") {
  Image scene = random_scene_image(150, 70, 2);
  set_depth(scene, [](int x, int y) {
    if (x >= 110 && y >= 50 && y < 53) return kNear;
    return x < 9 && y < 20 ? kFar : kSharp;
  });
  const Image expected = diffused(scene, kEight, Isa::scalar);
  for (const Isa isa : available_isas()) {
    INFO(std::string{isa_name(isa)});
    CHECK(equal(diffused(scene, kEight, isa), expected));
  }
  CHECK(load_texel(expected, 70, 10) == load_texel(scene, 70, 10));
}

TEST_CASE("diffusion blurs a background past a sharp line as if the line were not there") {
  // White left of the line, black right of it.
  const auto with_line = [](float line, int width) {
    return grey_scene(
        80, 40, [=](int x, int) { return x >= 40 && x < 40 + width ? line
                                         : x < 40                  ? 1.0f
                                                                   : 0.0f; },
        [=](int x, int) { return x >= 40 && x < 40 + width ? kSharp : kFar; });
  };
  const Image without = diffused(with_line(0.0f, 0), kEight);
  const Image dark = diffused(with_line(0.0f, 1), kEight);
  for (const int x : {30, 37, 39, 41, 44, 50}) {
    CAPTURE(x);
    CHECK(load_texel(dark, x, 20).x == doctest::Approx(load_texel(without, x, 20).x).epsilon(0.1));
  }
  CHECK(load_texel(dark, 41, 20).x > 0.3f);
  // The line gives nothing of its light.
  const Image bright = diffused(with_line(1000.0f, 1), kEight);
  for (int x = 0; x < 80; ++x) {
    if (x == 40) continue;
    CHECK(load_texel(bright, x, 20) == load_texel(dark, x, 20));
  }
  CHECK(load_texel(bright, 40, 20).x == 1000.0f);
}

TEST_CASE("diffusion spreads a foreground's edge to both sides alike") {
  // White before black: light comes to the sharp side as it goes from the near one.
  const Image scene = grey_scene(
      160, 24, [](int x, int) { return x < 80 ? 1.0f : 0.0f; },
      [](int x, int) { return x < 80 ? kNear : kSharp; });
  const Image result = diffused(scene, kEight);
  for (const int apart : {0, 1, 4, 8, 12}) {
    CAPTURE(apart);
    const float inside = load_texel(result, 79 - apart, 12).x;
    const float outside = load_texel(result, 80 + apart, 12).x;
    CHECK(inside + outside == doctest::Approx(1.0).epsilon(0.03));
    CHECK(outside > 0.0f);
  }
  CHECK(load_texel(result, 80, 12).x > 0.3f);
}

TEST_CASE("diffusion leaves a sharp background sharp beside a blurred foreground") {
  // A pixel out of the foreground's reach keeps its bits; one in reach is a mix of two.
  const Image scene = grey_scene(
      200, 30, [](int x, int) { return x < 20       ? 0.25f
                                       : x % 2 == 0 ? 0.0f
                                                    : 0.5f; },
      [](int x, int) { return x < 20 ? kNear : kSharp; });
  const Image result = diffused(scene, kEight);
  for (int x = 100; x < 200; ++x) CHECK(load_texel(result, x, 9) == load_texel(scene, x, 9));
  // The pattern stays as sharp beside the foreground as its opacity leaves it.
  const float contrast = load_texel(result, 23, 9).x - load_texel(result, 22, 9).x;
  CHECK(contrast > 0.25f);
  CHECK(contrast < 0.5f);
}

TEST_CASE("diffusion shows a thin near bar as wide and as faint as its opacity spreads") {
  const auto bar = [](float bar_grey, float grey) {
    return grey_scene(
        120, 60, [=](int x, int) { return x >= 58 && x < 62 ? bar_grey : grey; },
        [](int x, int) { return x >= 58 && x < 62 ? kNear : kSharp; });
  };
  // White before black has the light of the bar, in mean over the rows.
  const Image result = diffused(bar(1.0f, 0.0f), kEight);
  double light = 0.0;
  for (int x = 0; x < 120; ++x) light += load_texel(result, x, 30).x;
  CHECK(light == doctest::Approx(4.0).epsilon(0.01));
  CHECK(load_texel(result, 60, 30).x < 0.55f);
  // Black before white is the rest to it.
  const Image inverse = diffused(bar(0.0f, 1.0f), kEight);
  for (int x = 40; x < 80; ++x) {
    CHECK(load_texel(result, x, 30).x + load_texel(inverse, x, 30).x ==
          doctest::Approx(1.0).epsilon(0.002));
  }
}
