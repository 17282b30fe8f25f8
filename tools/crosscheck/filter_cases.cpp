// Stages `two-pass`, `one-pass` and their tiled forms: the same picture filtered by both sides.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "dof/dof.h"
#include "dof/polygon/polygon_lines.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/pipeline_file.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/filter_on_gl.h"
#include "tools/gl/objects.h"
#include "tools/gl/pipeline_on_gl.h"

namespace softfocus {
namespace {

// The picture that is filtered.
enum class TestPicture {
  figures,  ///< a drawn scene
  cube_room,
  sphere_world,
  random,   ///< random colours, random depths
  steps,    ///< random colours on a few depths, in blocks: silhouettes
  islands,  ///< random colours in focus, and single pixels before it, of all radii
  special,  ///< half subnormals, 65504, infinities and NaN; zero, infinite and NaN depths
};

Image drawn(const char* name, int width, int height, const Bench& bench) {
  const Scene& scene = loaded_scene(name);
  return draw_scene(scene, camera_matrices(scene.camera, 5, width, height), 5, width, height,
                    bench.profile, bench.pool);
}

Image make_picture(TestPicture kind, int width, int height, unsigned seed, const Bench& bench) {
  if (kind == TestPicture::figures) return drawn("figures", width, height, bench);
  if (kind == TestPicture::cube_room) return drawn("cube-room", width, height, bench);
  if (kind == TestPicture::sphere_world) return drawn("sphere-world", width, height, bench);
  static constexpr std::array<float, 6> kDepths{0.5f, 1.0f, 1.9f, 2.0f, 4.0f, 50.0f};
  static constexpr std::array<std::uint16_t, 13> kSpecialColours{
      0x0000, 0x8000, 0x0001, 0x03FF, 0x83FF, 0x0400, 0x3C00,
      0x3555, 0x7BFF, 0xFBFF, 0x7C00, 0xB800, 0x7E00};
  static constexpr std::array<std::uint16_t, 9> kSpecialDepths{
      0x0000, 0x8000, 0x0001, 0x3C00, 0x4000, 0x4880, 0x7BFF, 0x7C00, 0x7E00};
  RandomNumbers random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (int x = 0; x < width; ++x) {
      std::uint16_t* texel = &values[static_cast<std::size_t>(4 * x)];
      for (int i = 0; i < 3; ++i) {
        texel[i] =
            kind == TestPicture::special && random.below(8) == 0
                ? kSpecialColours[static_cast<std::size_t>(random.below(kSpecialColours.size()))]
                : float_to_half(random.between(0.0f, 3.0f), HalfRounding::nearest_even);
      }
      float depth = random.between(0.3f, 20.0f);
      if (kind == TestPicture::steps) {
        depth = kDepths[static_cast<std::size_t>((x / 7 * 31 + y / 5 * 17) % 6)];
      }
      texel[3] = float_to_half(depth, HalfRounding::nearest_even);
      if (kind == TestPicture::islands) {
        texel[3] = float_to_half(random.below(75 + 2 * x) == 0 ? random.between(1.0f, 2.0f) : 2.0f,
                                 HalfRounding::nearest_even);
      }
      if (kind == TestPicture::special && random.below(4) == 0) {
        texel[3] = kSpecialDepths[static_cast<std::size_t>(random.below(kSpecialDepths.size()))];
      }
    }
  }
  return image;
}

struct FilterCase {
  TestPicture picture;
  int width;
  int height;
  DofSettings settings;
  int tile_px = kFilterTilePx;  ///< of the tiled form
};

void filter_both(const Bench& bench, Tally& tally, const char* method, FilterForm form,
                 const FilterCase& what) {
  const Image picture = make_picture(what.picture, what.width, what.height, 4711, bench);
  const GlTexture texture = upload(picture);
  const GlFilter filter = make_filter(bench.gl, bench.shaders, method, form, what.settings,
                                      what.width, what.height, what.tile_px);
  run_filter(filter, texture);
  add_pictures(tally, read_colour(filter.targets.back(), 0),
               apply(*find_method(method), {picture, what.settings, bench.profile}, bench.pool));
}

DofSettings focused(float radius_at_infinity_px, float focus_m, float max_coc_px,
                    float leak = 1.0f) {
  return {{radius_at_infinity_px, focus_m}, max_coc_px, leak};
}

void add_filter_cases(const char* method, FilterForm form, std::vector<Case>& cases) {
  const bool rings = method == std::string_view("one-pass");
  const bool tiled = form == FilterForm::tiled;
  const std::string stage = std::string{method} + (tiled ? "-tiled" : "");
  const auto add = [&](const std::string& name, bool quick, bool slow_too, const FilterCase& what) {
    cases.push_back(
        {stage, name, quick && (!tiled || what.picture == TestPicture::islands || what.width == 1),
         slow_too,
         [=](const Bench& bench, Tally& tally) { filter_both(bench, tally, method, form, what); }});
  };
  for (const int radius : {1, 4, 16, 64}) {
    const DofSettings lens =
        focused(static_cast<float>(radius) * 1.5f, 2.0f, static_cast<float>(radius));
    const std::string name = "radius" + std::to_string(radius);
    const bool heavy = rings && radius == 64;
    add("random-64x64-" + name, !heavy, radius <= (rings ? 4 : 16),
        {TestPicture::random, 64, 64, lens});
    add("steps-160x120-" + name, false, radius <= 4, {TestPicture::steps, 160, 120, lens});
    if (heavy) continue;
    add("figures-512x512-" + name, false, false, {TestPicture::figures, 512, 512, lens});
    add("figures-1024x1024-" + name, false, false, {TestPicture::figures, 1024, 1024, lens});
  }
  add("special-values", true, true, {TestPicture::special, 64, 64, focused(6.0f, 2.0f, 4.0f)});
  add("special-values-radius16", false, !rings,
      {TestPicture::special, 64, 64, focused(24.0f, 2.0f, 16.0f)});
  add("cube-room-512x512-radius16", false, false,
      {TestPicture::cube_room, 512, 512, focused(24.0f, 2.0f, 16.0f)});
  add("sphere-world-512x512-radius16", false, false,
      {TestPicture::sphere_world, 512, 512, focused(24.0f, 2.0f, 16.0f)});
  if (tiled) {
    add("islands-60x40-tiles5", true, true,
        {TestPicture::islands, 60, 40, focused(18.0f, 2.0f, 12.0f), 5});
    add("islands-150x131-tiles5", false, false,
        {TestPicture::islands, 150, 131, focused(18.0f, 2.0f, 12.0f), 5});
  }
  add("special-values-odd", false, true, {TestPicture::special, 33, 51, focused(6.0f, 2.0f, 4.0f)});
  add("odd-333x517", false, false, {TestPicture::steps, 333, 517, focused(12.0f, 2.0f, 8.0f)});
  add("wide-1024x512", false, false, {TestPicture::figures, 1024, 512, focused(12.0f, 2.0f, 8.0f)});
  add("one-pixel", true, true, {TestPicture::random, 1, 1, focused(12.0f, 2.0f, 8.0f)});
  add("one-column", true, true, {TestPicture::random, 1, 300, focused(12.0f, 2.0f, 8.0f)});
  add("lens-nothing-in-focus", false, true,
      {TestPicture::random, 48, 48, focused(4000.0f, 1000.0f, 8.0f)});
  add("lens-all-sharp", false, true, {TestPicture::random, 48, 48, focused(1e-6f, 2.0f, 8.0f)});
  add("lens-half-pixel-radius", false, true,
      {TestPicture::random, 48, 48, focused(3.0f, 2.0f, 0.5f)});
  add("lens-fractional-radius", true, true,
      {TestPicture::random, 48, 48, focused(9.0f, 2.0f, 6.7f)});
  add("lens-no-filter", false, true, {TestPicture::random, 48, 48, focused(3.0f, 2.0f, 0.0f)});
  add("lens-no-leak", false, true, {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 0.0f)});
  add("lens-leak-0.3", true, true, {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 0.3f)});
  add("lens-huge-leak", false, true,
      {TestPicture::steps, 48, 48, focused(9.0f, 2.0f, 6.0f, 1e30f)});
}

}  // namespace

void add_filter_cases(std::vector<Case>& cases) {
  for (const FilterForm form : kFilterForms) {
    for (const char* method : {"two-pass", "one-pass"}) add_filter_cases(method, form, cases);
  }
}

// A user's pipeline, by both sides.

namespace {

/// A pass, after those before it.
void run_both(const Bench& bench, Tally& tally, const Pipeline& pipeline, const FilterCase& what,
              std::size_t wanted) {
  const Image picture = make_picture(what.picture, what.width, what.height, 4711, bench);
  const DofInput input{picture, what.settings, bench.profile};
  PipelineOnGl on_gl{bench.gl, pipeline, input};
  std::vector<Image> driver;
  on_gl.run(upload(source_image(pipeline, input, PipelineSource::picture)),
            [&](std::size_t pass, const GlTarget& made) {
              if (pass != wanted) return;
              driver.clear();
              for (std::size_t i = 0; i < made.colour.size(); ++i) {
                driver.push_back(read_colour(made, i));
              }
            });
  std::vector<Texture> emulated;
  Image result = make_image(Format::rgba16f, what.width, what.height);
  run_pipeline(pipeline, input, result, bench.pool,
               [&](std::size_t pass, std::span<const Texture> made) {
                 if (pass == wanted) emulated.assign(made.begin(), made.end());
               });
  for (std::size_t i = 0; i < driver.size(); ++i) {
    add_pictures(tally, driver[i], emulated[i].levels[0],
                 driver.size() > 1 ? "output " + std::to_string(i) : "");
  }
}

}  // namespace

void add_pipeline_cases(const std::string& method, std::vector<Case>& cases) {
  const Pipeline& pipeline = *pipeline_method(method)->pipeline;
  const std::string stage = std::filesystem::path{pipeline.name}.stem().string();
  const auto add = [&](const std::string& name, bool quick, bool slow_too, const FilterCase& what) {
    for (std::size_t i = 0; i < pipeline.passes.size(); ++i) {
      const std::string& pass = pipeline.passes[i].name;
      cases.push_back({stage,
                       name + "-pass-" + std::to_string(i + 1) + (pass.empty() ? "" : "-" + pass),
                       quick, slow_too, [&pipeline, what, i](const Bench& bench, Tally& tally) {
                         run_both(bench, tally, pipeline, what, i);
                       }});
    }
  };
  add("random-77x41", true, true, {TestPicture::random, 77, 41, focused(9.0f, 2.0f, 6.0f)});
  add("special-values-64x64", true, true,
      {TestPicture::special, 64, 64, focused(6.0f, 2.0f, 4.0f)});
  add("figures-256x256", true, false,
      {TestPicture::figures, 256, 256, focused(24.0f, 2.0f, 16.0f)});
  add("cube-room-512x512", false, false,
      {TestPicture::cube_room, 512, 512, focused(24.0f, 2.0f, 16.0f)});
}

// Stage `polygon`: the lines of pentagonal and hexagonal, and what is left of their pictures, by
// both sides.

namespace {

struct PolygonCase {
  int corners;
  bool near;
  float largest;
  int width, height;
};

/// Random light, with sizes in blocks so that some differ sharply, and some blur nothing.
LineField random_field(const PolygonCase& what, int reach, ThreadPool& pool) {
  RandomNumbers random{811};
  LineField field = make_line_field(what.near, what.width, what.height, reach, pool);
  for (int y = 0; y < what.height; ++y) {
    for (int x = 0; x < what.width; ++x) {
      const float opacity = what.near ? random.between(0.0f, 1.0f) : 0.0f;
      for (int c = 0; c < 3; ++c) {
        line_row(field, c, y)[x] = random.between(0.0f, 3.0f) * (what.near ? opacity : 1.0f);
      }
      line_row(field, 3, y)[x] = opacity;
      const int block = (x / 7 * 13 + y / 5 * 29) % 5;
      const float size = std::max(0.5f, what.largest * 0.25f * static_cast<float>(block));
      line_row(field, kLineSize, y)[x] = size;
      line_row(field, kLineCounts, y)[x] =
          what.near ? 0.0f : size * random.between(0.0f, 1.0f) * (block == 2 ? 0x1p-20f : 1.0f);
    }
    repeat_line_ends(field, 0, kLinePlanes, y);
  }
  return field;
}

Image four_planes(const LineField& field, int first, int count) {
  Image image = make_image(Format::rgba32f, field.width, field.height);
  for (int y = 0; y < field.height; ++y) {
    const auto to = row<float>(image, y);
    for (int x = 0; x < field.width; ++x) {
      for (int c = 0; c < 4; ++c) {
        to[static_cast<std::size_t>(4 * x + c)] =
            c < count ? line_row(field, first + c, y)[x] : 0.0f;
      }
    }
  }
  return image;
}

Image tap_image(const PolygonLine& line) {
  constexpr std::size_t kColumns = 256;
  const std::size_t rows = line.taps.size() / kColumns + 1;
  Image image = make_image(Format::rgba32f, static_cast<int>(kColumns), static_cast<int>(rows));
  for (std::size_t i = 0; i < line.taps.size(); ++i) {
    float* texel = &row<float>(image, static_cast<int>(i / kColumns))[i % kColumns * 4];
    texel[0] = static_cast<float>(line.taps[i].dx);
    texel[1] = static_cast<float>(line.taps[i].dy);
    texel[2] = line.taps[i].share;
  }
  return image;
}

GlTarget blur_on_gl(const Bench& bench, const PolygonCase& what, const PolygonLine& line,
                    const GlTexture& values, const GlTexture& sizes) {
  GlTarget target = make_target(std::array{Format::rgba32f}, what.width, what.height, false);
  const GlTexture taps = upload(tap_image(line));
  const GlProgram program =
      link_program(bench.gl, bench.shaders, "fullscreen.vert", "polygon_line.frag");
  set_texture(program, "values", 0, values);
  set_texture(program, "sizes", 1, sizes);
  set_texture(program, "taps", 2, taps);
  set_uniform(program, "reach", line.reach);
  set_uniform(program, "taps_a_step", line.taps_a_step);
  set_uniform(program, "middle_a_size", line.middle);
  set_uniform(program, "half_a_size", line.half);
  set_uniform(program, "near_field", what.near ? 1 : 0);
  draw_fullscreen(target, program);
  return target;
}

void blur_both(const Bench& bench, Tally& tally, const PolygonCase& what) {
  const PolygonLines lines = polygon_lines(what.corners, what.largest, what.near);
  int reach = 0;
  for (const auto& part : lines.parts) {
    for (const PolygonLine& line : part) reach = std::max(reach, line.reach);
  }
  LineField field = random_field(what, reach, bench.pool);
  const GlTexture values = upload(four_planes(field, 0, 4));
  const GlTexture sizes = upload(four_planes(field, kLineSize, 2));
  std::vector<GlTarget> parts;
  for (const auto& part : lines.parts) {
    const GlTarget across = blur_on_gl(bench, what, part[0], values, sizes);
    parts.push_back(blur_on_gl(bench, what, part[1], across.colour[0], sizes));
  }
  const GlTarget target = make_target(std::array{Format::rgba32f}, what.width, what.height, false);
  const GlProgram combine =
      link_program(bench.gl, bench.shaders, "fullscreen.vert", "polygon_combine.frag");
  static constexpr std::array kNames{"part_0", "part_1", "part_2", "part_3", "part_4", "part_5"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    set_texture(combine, kNames[i], static_cast<int>(i), parts[i % parts.size()].colour[0]);
  }
  set_uniform(combine, "least_share", lines.least_share);
  draw_fullscreen(target, combine);

  blur_polygon(lines, field, bench.pool);
  add_pictures(tally, read_colour(target, 0), four_planes(field, 0, 4));
}

}  // namespace

void add_polygon_cases(std::vector<Case>& cases) {
  for (const int corners : {5, 6}) {
    const std::string name = corners == 5 ? "pentagon" : "hexagon";
    const auto add = [&](const std::string& of, bool quick, bool slow_too,
                         const PolygonCase& what) {
      cases.push_back({"polygon", name + of, quick, slow_too,
                       [=](const Bench& bench, Tally& tally) { blur_both(bench, tally, what); }});
    };
    add("-far-61x43", true, true, {corners, false, 6.3f, 61, 43});
    add("-near-61x43", true, true, {corners, true, 6.3f, 61, 43});
    add("-far-256x256-size32", false, false, {corners, false, 32.0f, 256, 256});
    add("-near-256x256-size32", false, false, {corners, true, 32.0f, 256, 256});
    add("-far-one-cell", true, true, {corners, false, 3.0f, 1, 1});
  }
}

}  // namespace softfocus
