#include "tools/gl/maps_on_gl.h"

#include <array>
#include <bit>
#include <limits>
#include <string>

namespace softfocus {
namespace {

// Half the side of a viewport whose middle is texel (0, 0)'s corner, and that holds the map. With
// the middle at 0 and a power of two, a corner's place in the window is the very number that it is
// given: a viewport of the map's own size would round it twice more. Nothing is clipped either.
int half_viewport(int size) {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>(size) + 2u));
}

std::vector<glm::uvec4> planes_of(std::span<const CutCasters> casters) {
  std::vector<glm::uvec4> texels;
  for (const CutCasters& part : casters) {
    for (const MapTriangle& triangle : part.triangles) {
      texels.push_back(texel_of_doubles(triangle.over_u, triangle.over_v));
      texels.push_back(texel_of_doubles(triangle.at_origin, triangle.least));
      texels.push_back(texel_of_doubles(triangle.most, 0.0));
    }
  }
  return texels;
}

std::vector<ListedVertex> corners_of_casters(std::span<const CutCasters> casters, int size) {
  const auto half = static_cast<float>(half_viewport(size));
  std::vector<ListedVertex> vertices;
  float number = 0.0f;
  for (const CutCasters& part : casters) {
    for (const MapTriangle& triangle : part.triangles) {
      for (const WindowVertex& corner : triangle.window) {
        vertices.push_back({{corner.x / half, corner.y / half}, number});
      }
      number += 1.0f;
    }
  }
  return vertices;
}

std::vector<glm::uvec4> texels_of(std::span<const PixelComparison> pixels) {
  std::vector<glm::uvec4> texels;
  texels.reserve(pixels.size());
  for (const PixelComparison& pixel : pixels) {
    const auto u = static_cast<std::uint32_t>(pixel.with.u);
    const auto v = static_cast<std::uint32_t>(pixel.with.v);
    texels.emplace_back(u | v << 16, pixel.side, words_of(pixel.with.own));
  }
  return texels;
}

}  // namespace

GlMap make_gl_map(const GlContext& context, const Shaders& shaders,
                  const ShadowMapSettings& settings) {
  require_doubles(context, "a shadow map");
  std::array<GLint, 2> most{};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, most.data());
  if (2 * half_viewport(settings.size) > most[0]) {
    throw DriverError("a shadow map of " + std::to_string(settings.size) +
                      " texels needs a viewport of " +
                      std::to_string(2 * half_viewport(settings.size)) + " pixels; " +
                      std::to_string(most[0]) + " are the driver's most");
  }
  return {settings.size,
          settings.kernel,
          link_program(context, shaders, "listed.vert", "map_side.frag"),
          link_program(context, shaders, "fullscreen.vert", "map_lookup.frag"),
          {}};
}

void add_side(GlMap& map, std::span<const CutCasters> casters) {
  map.sides.push_back({upload_listed(corners_of_casters(casters, map.size)),
                       upload_list(planes_of(casters)),
                       make_target(std::array{Format::r32f}, map.size, map.size, false)});
}

void draw(const GlMap& map) {
  constexpr float kFar = -std::numeric_limits<float>::infinity();
  constexpr std::array kEmpty{kFar, kFar, kFar, kFar};
  const int half = half_viewport(map.size);
  for (const GlMapSide& side : map.sides) {
    bind(side.target);
    glClearBufferfv(GL_COLOR, 0, kEmpty.data());
    glViewport(-half, -half, 2 * half, 2 * half);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glBlendEquation(GL_MAX);
    glUseProgram(map.draw);
    set_texture(map.draw, "triangles", 0, side.planes);
    draw_listed(side.triangles);
    glBlendEquation(GL_FUNC_ADD);
    glDisable(GL_BLEND);
  }
}

Image look_up(const GlMap& map, std::span<const PixelComparison> pixels, int width, int height) {
  const GlTexture places = upload_words(texels_of(pixels), width, height);
  const GlTarget target = make_target(std::array{Format::r32f}, width, height, false);
  constexpr std::array kNone{0.0f, 0.0f, 0.0f, 0.0f};
  bind(target);
  glClearBufferfv(GL_COLOR, 0, kNone.data());
  for (std::size_t i = 0; i < map.sides.size(); ++i) {
    glUseProgram(map.look_up);
    set_texture(map.look_up, "nearness", 0, map.sides[i].target.colour[0]);
    set_texture(map.look_up, "places", 1, places);
    set_uniform(map.look_up, "side", static_cast<int>(i) + 1);
    set_uniform(map.look_up, "kernel", map.kernel);
    draw_fullscreen(target, map.look_up);
  }
  return read_colour(target, 0);
}

}  // namespace softfocus
