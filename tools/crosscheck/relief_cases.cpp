// Stages `relief`, `march` and `octahedral`: a pre-warped plane mapped, a relief that rays march
// through, an octahedral atlas blended, by both sides.

#include <array>
#include <string>

#include "raster/images/texel.h"
#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "raster/numbers/vector_math.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/warp/map_relief.h"
#include "scenes/relief/warp/march_relief.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

struct ReliefCase {
  std::string scene;
  int texels;         ///< of the relief, each way
  int width, height;  ///< of the picture
  int slices = 0, bisections = 0;
  int views = 0, parallax = 0;
};

/// A background that cuts through the object in places.
Image background_of(const ReliefCase& what, double distance_m) {
  RandomNumbers random{417};
  Image picture = make_image(Format::rgba16f, what.width, what.height);
  for (int y = 0; y < what.height; ++y) {
    for (int x = 0; x < what.width; ++x) {
      const bool is_near = (x / 9 + y / 7) % 5 == 0;
      const auto depth = static_cast<float>(is_near ? distance_m : 60000.0);
      store_texel<Format::rgba16f>(picture, x, y,
                                   {random.between(0.0f, 1.0f), random.between(0.0f, 1.0f),
                                    random.between(0.0f, 1.0f), depth},
                                   Profile{});
    }
  }
  return picture;
}

/// Floats of a driver as the halves that the emulation stores.
Image stored(const Image& floats) {
  Image picture = make_image(Format::rgba16f, floats.width, floats.height);
  for (int y = 0; y < floats.height; ++y) {
    for (int x = 0; x < floats.width; ++x) {
      store_texel<Format::rgba16f>(picture, x, y, load_texel<Format::rgba32f>(floats, x, y),
                                   Profile{});
    }
  }
  return picture;
}

/// A texel a texel of the relief: light, and the depth in metres, -1 where nothing is.
Image light_and_depth(const ReliefTexture& relief) {
  const auto step_m = static_cast<float>(depth_step(relief));
  Image image = make_image(Format::rgba32f, relief.width, relief.height);
  const auto light = [](std::uint32_t code) {
    return srgb8_to_linear(static_cast<std::uint8_t>(code & 255u));
  };
  for (int y = 0; y < relief.height; ++y) {
    for (int x = 0; x < relief.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
                             static_cast<std::size_t>(x);
      const std::uint32_t colour = relief.colours[at];
      const float depth = colour == 0 ? -1.0f : static_cast<float>(relief.depths[at]) * step_m;
      store_texel<Format::rgba32f>(
          image, x, y, {light(colour), light(colour >> 8), light(colour >> 16), depth}, Profile{});
    }
  }
  return image;
}

float single_of(double value) { return static_cast<float>(value); }

/// u, v and q of each row's pixel 0.
Image lines_of(const PlaneMapping& mapping, int height) {
  Image image = make_image(Format::rgba32f, 1, height);
  for (int y = 0; y < height; ++y) {
    store_texel<Format::rgba32f>(image, 0, y,
                                 {single_of(mapping.u.at(0.0, y)), single_of(mapping.v.at(0.0, y)),
                                  single_of(mapping.q.at(0.0, y)), 0.0f},
                                 Profile{});
  }
  return image;
}

void set_mapping(const GlProgram& program, const PlaneMapping& mapping) {
  set_uniform(program, "along",
              glm::vec3{single_of(mapping.u.step_x), single_of(mapping.v.step_x),
                        single_of(mapping.q.step_x)});
  set_uniform(program, "height_m", single_of(mapping.height_m));
}

void set_area(const GlProgram& program, const Rectangle& area) {
  set_uniform(program, "first", glm::ivec2{area.x_begin, area.y_begin});
  set_uniform(program, "end", glm::ivec2{area.x_end, area.y_end});
}

Image drawn_on_gl(const GlProgram& program, const ReliefCase& what) {
  const GlTarget target = make_target(std::array{Format::rgba32f}, what.width, what.height, false);
  draw_fullscreen(target, program);
  return stored(read_colour(target, 0));
}

/// A scene's relief, a camera 12 degrees beside its eye and as far from the middle, and the picture
/// that it will lie over.
struct SeenCase {
  SeenCase(const Bench& bench, const ReliefCase& what)
      : scene(loaded_scene(what.scene)), maker(prepare_relief(scene, 0.0, bench.pool)) {
    const double away = 3.2 * maker.radius_m;
    Camera camera;
    camera.target = maker.middle;
    camera.position = maker.middle + normalize(glm::dvec3{0.32, 0.4, 1.0}) * away;
    camera.near_m = 0.1 * away;
    camera.far_m = 10.0 * away;
    view = camera_matrices(camera, 0.0, what.width, what.height);
    emulated = background_of(what, away);
  }
  SeenCase(const SeenCase&) = delete;
  SeenCase& operator=(const SeenCase&) = delete;

  ReliefTexture relief(const ReliefCase& what, ThreadPool& pool) {
    const glm::dvec3 eye =
        maker.middle + normalize(glm::dvec3{0.1, 0.35, 1.0}) * (3.2 * maker.radius_m);
    return make_relief(maker, {eye, {0.0, 1.0, 0.0}}, {what.texels, what.texels, 8, false}, pool);
  }

  Scene scene;
  ReliefMaker maker;  // refers to the scene
  CameraMatrices view;
  Image emulated;
};

void map_plane_both(const Bench& bench, Tally& tally, const ReliefCase& what) {
  SeenCase seen{bench, what};
  const CameraMatrices& view = seen.view;
  Image& emulated = seen.emulated;
  const ReliefTexture relief = seen.relief(what, bench.pool);
  const ReliefExtent extent = *relief_extent(relief);
  const PlaneRectangle place = *warped_extent(relief, extent, view.eye);
  WarpedRelief warped;
  warp_relief(relief, extent, view.eye, place, {}, warped, bench.pool);
  const PlaneMapping mapping = plane_mapping(relief, view, place, what.width, what.height);

  Image codes = make_image(Format::rgba32f, place.width, place.height);
  Image depths = make_image(Format::r32f, place.width, place.height);
  for (int y = 0; y < place.height; ++y) {
    for (int x = 0; x < place.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(place.width) +
                             static_cast<std::size_t>(x);
      const std::uint32_t colour = warped.colours[at];
      const auto code = [&](int shift) { return static_cast<float>(colour >> shift & 255u); };
      store_texel<Format::rgba32f>(codes, x, y, {code(0), code(8), code(16), code(24)}, Profile{});
      row<float>(depths, y)[static_cast<std::size_t>(x)] = colour == 0 ? 0.0f : warped.depths_m[at];
    }
  }
  Image light = make_image(Format::r32f, 256, 1);
  for (std::size_t code = 0; code < 256; ++code) {
    row<float>(light, 0)[code] = half_to_float(float_to_half(
        srgb8_to_linear(static_cast<std::uint8_t>(code)), HalfRounding::nearest_even));
  }
  const GlTexture gl_codes = upload(codes), gl_depths = upload(depths), gl_light = upload(light);
  const GlTexture gl_lines = upload(lines_of(mapping, what.height)), before = upload(emulated);
  const GlProgram program =
      link_program(bench.gl, bench.shaders, "fullscreen.vert", "relief_map.frag");
  set_texture(program, "texels", 0, gl_codes);
  set_texture(program, "depths", 1, gl_depths);
  set_texture(program, "lines", 2, gl_lines);
  set_texture(program, "light", 3, gl_light);
  set_texture(program, "picture", 4, before);
  set_mapping(program, mapping);
  set_area(program, mapping.area);
  set_uniform(program, "k3", mapping.k3);
  const Image driver = drawn_on_gl(program, what);
  map_relief(warped, mapping, emulated, bench.pool);
  add_pictures(tally, driver, emulated);
}

void march_both(const Bench& bench, Tally& tally, const ReliefCase& what) {
  SeenCase seen{bench, what};
  const CameraMatrices& view = seen.view;
  Image& emulated = seen.emulated;
  const ReliefTexture relief = seen.relief(what, bench.pool);
  const MarchMapping march =
      march_mapping(relief, *relief_extent(relief), view, what.width, what.height);
  const MarchSettings settings{what.slices, what.bisections};

  const float most_m = static_cast<float>(last_depth(relief.depth_bits)) * march.warp.step_m;
  const GlTexture texels = upload(light_and_depth(relief)), before = upload(emulated);
  const GlTexture lines = upload(lines_of(march.mapping, what.height));
  const GlProgram program =
      link_program(bench.gl, bench.shaders, "fullscreen.vert", "relief_march.frag");
  set_texture(program, "texels", 0, texels);
  set_texture(program, "lines", 1, lines);
  set_texture(program, "picture", 2, before);
  set_mapping(program, march.mapping);
  set_area(program, march.mapping.area);
  set_uniform(program, "warp", glm::vec3{march.warp.k1, march.warp.k2, march.warp.k3});
  set_uniform(program, "slice_m", most_m / static_cast<float>(settings.slices));
  set_uniform(program, "slices", settings.slices);
  set_uniform(program, "bisections", settings.bisections);
  const Image driver = drawn_on_gl(program, what);
  march_relief(relief, march, settings, emulated, bench.pool);
  add_pictures(tally, driver, emulated);
}

/// Two texels a picture and row: u, v and their slopes; q. The last row has the steps to the next
/// pixel.
Image octahedral_lines(const std::array<OctahedralView, 3>& views, int height) {
  Image image = make_image(Format::rgba32f, 6, height + 1);
  for (int y = 0; y <= height; ++y) {
    for (int i = 0; i < 3; ++i) {
      const OctahedralView& view = views[static_cast<std::size_t>(i)];
      const auto of = [&](const PlaneMapping::Planar& plane) {
        return single_of(y == height ? plane.step_x : plane.at(0.0, y));
      };
      store_texel<Format::rgba32f>(
          image, 2 * i, y, {of(view.u), of(view.v), of(view.slope_u), of(view.slope_v)}, Profile{});
      store_texel<Format::rgba32f>(image, 2 * i + 1, y, {of(view.q), 0.0f, 0.0f, 0.0f}, Profile{});
    }
  }
  return image;
}

void octahedral_both(const Bench& bench, Tally& tally, const ReliefCase& what) {
  SeenCase seen{bench, what};
  const CameraMatrices& view = seen.view;
  Image& emulated = seen.emulated;
  const OctahedralAtlas atlas =
      make_octahedral_atlas(seen.maker, {.views = what.views, .texels = what.texels}, bench.pool);
  const OctahedralBlend blend = octahedral_blend(atlas, view.eye - atlas.middle);
  std::array<OctahedralView, 3> views{};
  std::array<GlTexture, 3> texels{};
  glm::vec3 heights{0.0f}, shares{0.0f};
  for (std::size_t i = 0; i < 3; ++i) {
    const ReliefTexture& picture = atlas.pictures[blend.pictures[i]];
    views[i] = octahedral_view(picture, atlas.radius_m, view, what.width, what.height);
    texels[i] = upload(light_and_depth(picture));
    heights[static_cast<int>(i)] = single_of(views[i].height_m);
    shares[static_cast<int>(i)] = single_of(blend.shares[i]);
  }
  const GlTexture before = upload(emulated), lines = upload(octahedral_lines(views, what.height));
  const GlProgram program =
      link_program(bench.gl, bench.shaders, "fullscreen.vert", "octahedral.frag");
  set_texture(program, "first_texels", 0, texels[0]);
  set_texture(program, "second_texels", 1, texels[1]);
  set_texture(program, "third_texels", 2, texels[2]);
  set_texture(program, "lines", 3, lines);
  set_texture(program, "picture", 4, before);
  set_area(program, octahedral_area(atlas, view, what.width, what.height));
  set_uniform(program, "heights_m", heights);
  set_uniform(program, "shares", shares);
  set_uniform(program, "middle_m", single_of(atlas.radius_m * (1.0 + kDepthMargin)));
  set_uniform(program, "least_cover", kLeastCover);
  set_uniform(program, "steps", what.parallax);
  const Image driver = drawn_on_gl(program, what);
  draw_octahedral(atlas, view, what.parallax, emulated, bench.pool);
  add_pictures(tally, driver, emulated);
}

}  // namespace

void add_relief_cases(std::vector<Case>& cases) {
  const auto add = [&](const char* stage, const std::string& name, bool quick,
                       void (*both)(const Bench&, Tally&, const ReliefCase&),
                       const ReliefCase& what) {
    cases.push_back(
        {stage,
         what.scene + ' ' + std::to_string(what.width) + 'x' + std::to_string(what.height) + name,
         quick, quick, [=](const Bench& bench, Tally& tally) { both(bench, tally, what); }});
  };
  for (const std::string scene : {"figures", "lattice"}) {
    const ReliefCase small{scene, 64, 97, 61}, large{scene, 256, 512, 512};
    add("relief", "", true, map_plane_both, small);
    add("relief", "", false, map_plane_both, large);
    const auto add_march = [&](ReliefCase what, int slices, int bisections, bool quick) {
      what.slices = slices;
      what.bisections = bisections;
      add("march", " slices" + std::to_string(slices) + "-bisections" + std::to_string(bisections),
          quick, march_both, what);
    };
    add_march(small, 16, 0, true);
    add_march(small, 8, 6, true);
    add_march(large, 64, 0, false);
    add_march(large, 32, 6, false);
    const auto add_atlas = [&](ReliefCase what, int parallax, bool quick) {
      what.views = 6;
      what.parallax = parallax;
      add("octahedral", " parallax" + std::to_string(parallax), quick, octahedral_both, what);
    };
    add_atlas(small, 0, true);
    add_atlas(small, 1, true);
    add_atlas(large, 1, false);
    add_atlas(large, 3, false);
  }
}

}  // namespace softfocus
