// Stage `polygon`: the lines of pentagonal and hexagonal, and what is left of their pictures, by
// both sides.

#include <algorithm>
#include <array>
#include <utility>

#include "dof/polygon/polygon_lines.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

struct PolygonCase {
  int corners;
  bool near;
  float largest;
  int width, height;
};

/// Random light, with sizes in blocks so that some differ sharply, and some blur nothing.
LineField random_field(const PolygonCase& what, int reach) {
  RandomNumbers random{811};
  LineField field = make_line_field(what.near, what.width, what.height, reach);
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
  LineField field = random_field(what, reach);
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
