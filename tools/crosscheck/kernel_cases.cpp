// Stages `kernel`, `pyramid` and `bilateral`: the same picture filtered by both sides.

#include <array>
#include <bit>
#include <cmath>

#include "raster/images/image.h"
#include "raster/images/texel.h"
#include "raster/passes/bilateral.h"
#include "raster/passes/kernel.h"
#include "raster/passes/pyramid.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/effects_on_gl.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

/// Halves of any bits, or of colours alone.
Image random_picture(int width, int height, unsigned seed, bool any_bits) {
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      value = any_bits && random.below(16) == 0
                  ? static_cast<std::uint16_t>(random.word())
                  : float_to_half(random.between(0.0f, 3.0f), HalfRounding::nearest_even);
    }
  }
  return image;
}

/// Depths in steps, so that some are unlike.
Image with_steps(Image image) {
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 3; i < values.size(); i += 4) {
      values[i] = static_cast<std::uint16_t>(
          0x3C00 + (i / 4 / 9 + static_cast<std::size_t>(y) / 7) % 3 * 0x200);
    }
  }
  return image;
}

struct KernelCase {
  Kernel kernel;
  int width;
  int height;
  glm::ivec2 guard{0, 0};
  bool any_bits = false;
  bool quad = false;  ///< two triangles on the driver's side
};

void convolve_both(const Bench& bench, Tally& tally, const KernelCase& what) {
  const Image source = random_picture(what.width + 2 * what.guard.x, what.height + 2 * what.guard.y,
                                      2047, what.any_bits);
  EffectPasses passes{bench.gl, bench.shaders};
  passes.draw_quads(what.quad);
  const GlTexture picture = upload(source);
  const GlTarget& target =
      convolved_on_gl(passes, what.kernel, {picture, source.width, source.height}, what.guard);

  Image emulated = make_image(Format::rgba16f, what.width, what.height);
  convolve(what.kernel, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void box_both(const Bench& bench, Tally& tally, int width, int height) {
  const Texture source = make_texture(random_picture(width, height, 2051, false));
  const GlTexture picture =
      upload(source, {Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge});
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& target = passes.target(width, height);
  const GlProgram& program = passes.program("box_bilinear.frag");
  set_texture(program, "source", 0, picture);
  set_uniform(program, "texel",
              glm::vec2{1.0f / static_cast<float>(width), 1.0f / static_cast<float>(height)});
  passes.draw(target, program);
  Image emulated = make_image(Format::rgba16f, width, height);
  box_in_four_reads(source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

/// Down and up again.
void halve_and_double_both(const Bench& bench, Tally& tally, int width, int height, bool any_bits) {
  const Image source = random_picture(width, height, 2049, any_bits);
  const GlTexture picture = upload(source);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlPicture whole{picture, width, height};
  const GlTarget& half = halved_on_gl(passes, whole);
  Image small = make_image(Format::rgba16f, half.width, half.height);
  downsample(source, small, bench.profile, bench.pool);
  add_pictures(tally, read_colour(half, 0), small, "half");
  Image large = make_image(Format::rgba16f, width, height);
  for (const Widening widening : {Widening::tent, Widening::bilinear}) {
    for (const bool alone : {false, true}) {
      const Upsampling how{0.7f, widening, alone};
      const GlTarget& widened = widened_on_gl(passes, picture_of(half), whole, how);
      upsample(small, source, how, large, bench.profile, bench.pool);
      add_pictures(tally, read_colour(widened, 0), large, "whole");
    }
  }
}

void dual_filter_both(const Bench& bench, Tally& tally, int levels, Widening widening) {
  constexpr int kWidth = 61, kHeight = 43;
  const Image source = random_picture(kWidth, kHeight, 2050, false);
  const GlTexture picture = upload(source);
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTarget& target = dual_filter_on_gl(passes, levels, widening, {picture, kWidth, kHeight});
  Image emulated = make_image(Format::rgba16f, kWidth, kHeight);
  dual_filter(levels, widening, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void add_pyramid_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* name, bool quick, bool slow_too, int width, int height,
                       bool any_bits = false) {
    cases.push_back({"pyramid", name, quick, slow_too, [=](const Bench& bench, Tally& tally) {
                       halve_and_double_both(bench, tally, width, height, any_bits);
                     }});
  };
  add("64x48", true, true, 64, 48);
  add("odd-61x43", true, true, 61, 43);
  add("512x512", false, false, 512, 512);
  add("any-bits", true, true, 64, 64, true);
  add("one-pixel", true, true, 1, 1);
  cases.push_back({"pyramid", "dual-filter-1", true, true, [](const Bench& bench, Tally& tally) {
                     dual_filter_both(bench, tally, 1, Widening::bilinear);
                   }});
  cases.push_back({"pyramid", "dual-filter-3", false, true, [](const Bench& bench, Tally& tally) {
                     dual_filter_both(bench, tally, 3, Widening::tent);
                   }});
}

void smooth_both(const Bench& bench, Tally& tally, const BilateralSettings& settings, int width,
                 int height, bool any_bits) {
  const Image source = with_steps(random_picture(width, height, 2048, any_bits));
  EffectPasses passes{bench.gl, bench.shaders};
  const GlTexture picture = upload(source);
  const GlTarget& target = bilateral_on_gl(passes, settings, {picture, width, height});

  Image emulated = make_image(Format::rgba16f, width, height);
  bilateral(settings, source, emulated, bench.profile, bench.pool);
  add_pictures(tally, read_colour(target, 0), emulated);
}

void add_bilateral_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* name, bool quick, bool slow_too,
                       const BilateralSettings& settings, int width, int height,
                       bool any_bits = false) {
    cases.push_back({"bilateral", name, quick, slow_too, [=](const Bench& bench, Tally& tally) {
                       smooth_both(bench, tally, settings, width, height, any_bits);
                     }});
  };
  add("colour-61x43", true, true, {1.5, 1.5f, 0.0f}, 61, 43);
  add("depth-61x43", true, true, {1.5, 0.0f, 0.4f}, 61, 43);
  add("both-256x256", false, false, {3.0, 2.0f, 0.6f}, 256, 256);
  add("no-tolerance", false, true, {2.0, 0.0f, 0.0f}, 64, 64);
  add("any-bits", true, true, {1.0, 2.0f, 0.6f}, 64, 64, true);
  add("one-pixel", true, true, {1.0, 2.0f, 0.6f}, 1, 1);
}

}  // namespace

void add_kernel_cases(std::vector<Case>& cases) {
  const auto add = [&](const std::string& name, bool quick, bool slow_too, const KernelCase& what) {
    cases.push_back({"kernel", name, quick, slow_too,
                     [=](const Bench& bench, Tally& tally) { convolve_both(bench, tally, what); }});
  };
  for (const NamedKernel& named : kernels()) {
    const std::string name{named.name};
    add(name + "-61x43", true, true, {named.kernel, 61, 43});
    add(name + "-512x512", false, false, {named.kernel, 512, 512});
    add(name + "-any-bits", name == "gaussian-5", true, {named.kernel, 97, 64, {0, 0}, true});
  }
  add("quad-61x43", true, true,
      {.kernel = *find_kernel("gaussian-5"), .width = 61, .height = 43, .quad = true});
  add("guard-band-40x30", true, true, {*find_kernel("gaussian-5"), 40, 30, {7, 3}});
  for (const double sigma : {0.6, 4.0, 20.0}) {
    const std::string name = "gaussian-" + std::to_string(static_cast<int>(sigma * 10.0));
    add(name + "-tenths-across", sigma < 1.0, sigma < 10.0,
        {row_kernel(gaussian_weights(sigma)), 160, 120});
    add(name + "-tenths-down", sigma < 1.0, sigma < 10.0,
        {column_kernel(gaussian_weights(sigma)), 160, 120});
  }
  add("one-pixel", true, true, {*find_kernel("gaussian-5"), 1, 1});
  for (const glm::ivec2 size : {glm::ivec2{61, 43}, {256, 64}}) {
    cases.push_back(
        {"kernel", "box-in-four-reads-" + std::to_string(size.x) + "x" + std::to_string(size.y),
         true, true,
         [size](const Bench& bench, Tally& tally) { box_both(bench, tally, size.x, size.y); }});
  }
  add_pyramid_cases(cases);
  add_bilateral_cases(cases);
}

// Stage `store`: floats on their way into halves and bytes.

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
      const std::size_t texel = i / 4;
      const float at = static_cast<float>(texel) * 0.5f / 255.0f;
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
