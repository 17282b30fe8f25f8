// Stage `store`: floats on their way into halves and bytes.

#include <array>
#include <bit>
#include <cmath>

#include "raster/images/texel.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

void store_both(const Bench& bench, Tally& tally, const Image& values, Format format) {
  const GlTexture texture = upload(values);
  const GlTarget target = make_target(std::array{format}, values.width, values.height, false);
  const GlProgram program = link_program(bench.gl, bench.shaders, "fullscreen.vert", "store.frag");
  set_texture(program, "values", 0, texture);
  draw_fullscreen(target, program);

  Image emulated = make_image(format, values.width, values.height);
  for (int y = 0; y < values.height; ++y) {
    for (int x = 0; x < values.width; ++x) {
      store_texel(emulated, x, y, load_texel(values, x, y), bench.profile);
    }
  }
  add_pictures(tally, read_colour(target, 0), emulated);
}

// Every half, the floats on either side of it, the midpoint to the next and the floats
// on either side of that: six floats a half.
Image around_every_half() {
  constexpr int kWidth = 512;
  Image image = make_image(Format::rgba32f, kWidth, 65536 * 6 / 4 / kWidth);
  for (int i = 0; i < 65536 * 6; ++i) {
    const auto half = static_cast<std::uint16_t>(i / 6);
    const auto next = static_cast<std::uint16_t>(half + 1);
    const float at = half_to_float(half);
    const float middle = std::isfinite(half_to_float(next)) ? (at + half_to_float(next)) * 0.5f
                                                            : std::copysign(65520.0f, at);
    const float values[6] = {
        at,     std::nextafterf(at, HUGE_VALF),     std::nextafterf(at, -HUGE_VALF),
        middle, std::nextafterf(middle, HUGE_VALF), std::nextafterf(middle, -HUGE_VALF)};
    row<float>(image, i / 4 / kWidth)[static_cast<std::size_t>(i % (4 * kWidth))] = values[i % 6];
  }
  return image;
}

// Any bits at all: denormals, infinities and NaNs among them.
Image any_floats(unsigned seed, int size) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba32f, size, size);
  for (int y = 0; y < size; ++y) {
    for (float& value : row<float>(image, y)) value = std::bit_cast<float>(random.word());
  }
  return image;
}

// Every byte's value, the limits between bytes, and the floats around both.
Image around_every_byte() {
  Image image = make_image(Format::rgba32f, 511, 3);
  for (int y = 0; y < 3; ++y) {
    const auto values = row<float>(image, y);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float at = static_cast<float>(i / 4) * 0.5f / 255.0f;
      values[i] = y == 0 ? at : std::nextafterf(at, y == 1 ? HUGE_VALF : -HUGE_VALF);
    }
  }
  return image;
}

Image beyond_bytes(unsigned seed) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba32f, 256, 256);
  for (int y = 0; y < image.height; ++y) {
    for (float& value : row<float>(image, y)) value = random.between(-0.5f, 1.5f);
  }
  return image;
}

}  // namespace

void add_store_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* name, bool quick, Format format, auto make_values) {
    cases.push_back({"store", name, quick, true, [=](const Bench& bench, Tally& tally) {
                       store_both(bench, tally, make_values(), format);
                     }});
  };
  add("rgba16f-around-every-half", true, Format::rgba16f, around_every_half);
  add("rgba16f-any-floats", false, Format::rgba16f, [] { return any_floats(1, 1024); });
  add("rgba16f-any-floats-small", true, Format::rgba16f, [] { return any_floats(2, 128); });
  add("rgba8-around-every-byte", true, Format::rgba8, around_every_byte);
  add("rgba8-random", true, Format::rgba8, [] { return beyond_bytes(3); });
}

}  // namespace softfocus
