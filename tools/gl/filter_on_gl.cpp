#include "tools/gl/filter_on_gl.h"

#include <array>
#include <cmath>

#include "dof/one_pass/one_pass.h"
#include "dof/weights.h"

namespace softfocus {
namespace {

void set_settings(const GlProgram& program, const DofSettings& settings) {
  set_uniform(program, "radius_at_infinity_px", settings.coc.radius_at_infinity_px);
  set_uniform(program, "focus_m", settings.coc.focus_m);
  set_uniform(program, "max_coc_px", settings.max_coc_px);
  set_uniform(program, "leak", settings.leak);
}

// The taps as a texture of whole rows, the last one filled up with zeros.
Image ring_tap_image(const std::vector<RingTap>& taps) {
  constexpr int kColumns = 256;
  const int count = static_cast<int>(taps.size());
  Image image = make_image(Format::rgba32f, kColumns, count / kColumns + 1);
  for (int i = 0; i < count; ++i) {
    const RingTap& tap = taps[static_cast<std::size_t>(i)];
    float* texel = &row<float>(image, i / kColumns)[static_cast<std::size_t>(i % kColumns * 4)];
    texel[0] = static_cast<float>(tap.dx);
    texel[1] = static_cast<float>(tap.dy);
    texel[2] = tap.distance_px;
  }
  return image;
}

// How many tiles away the largest circle can come from: tile_reach.frag's gap_px().
int farthest_tiles(float max_coc_px, int tile_px) {
  return max_coc_px > 1.0f
             ? static_cast<int>(std::ceil((max_coc_px - 1.0f) / static_cast<float>(tile_px)))
             : 0;
}

GlTileReach make_tile_reach(const GlContext& context, const Shaders& shaders,
                            const DofSettings& settings, bool diagonal, int width, int height,
                            int tile_px) {
  const int columns = (width + tile_px - 1) / tile_px, rows = (height + tile_px - 1) / tile_px;
  GlTileReach tiles{tile_px, link_program(context, shaders, "fullscreen.vert", "tile_rows.frag"),
                    link_program(context, shaders, "fullscreen.vert", "tile_reach.frag"),
                    make_target(std::array{Format::r32f}, columns, height, false),
                    make_target(std::array{Format::rgba32f}, columns, rows, false)};
  set_settings(tiles.rows_program, settings);
  set_uniform(tiles.rows_program, "tile_px", tile_px);
  set_uniform(tiles.reach_program, "tile_px", tile_px);
  set_uniform(tiles.reach_program, "farthest", farthest_tiles(settings.max_coc_px, tile_px));
  set_uniform(tiles.reach_program, "diagonal", diagonal ? 1 : 0);
  return tiles;
}

void find_reach(const GlTileReach& tiles, const GlTexture& scene) {
  set_texture(tiles.rows_program, "source", 0, scene);
  draw_fullscreen(tiles.rows, tiles.rows_program);
  set_texture(tiles.reach_program, "row_radius", 0, tiles.rows.colour[0]);
  draw_fullscreen(tiles.reach, tiles.reach_program);
}

std::string_view fragment_shader(bool rings, FilterForm form) {
  if (form == FilterForm::tiled) return rings ? "one_pass_tiled.frag" : "two_pass_tiled.frag";
  return rings ? "one_pass.frag" : "two_pass.frag";
}

}  // namespace

std::string_view form_name(FilterForm form) {
  return form == FilterForm::tiled ? "tiled" : "brute-force";
}

GlFilter make_filter(const GlContext& context, const Shaders& shaders, std::string_view method,
                     FilterForm form, const DofSettings& settings, int width, int height,
                     int tile_px) {
  if (!has_shader(method)) {
    throw DriverError("the method " + std::string(method) + " has no shader");
  }
  const bool rings = method == "one-pass";
  GlFilter filter;
  filter.program = link_program(context, shaders, "fullscreen.vert", fragment_shader(rings, form));
  set_settings(filter.program, settings);
  int taps = tap_count(settings.max_coc_px);
  if (rings) {
    const std::vector<RingTap> ring = ring_taps(settings.max_coc_px);
    filter.ring_taps = upload(ring_tap_image(ring));
    taps = static_cast<int>(ring.size());
  }
  set_uniform(filter.program, "taps", taps);
  set_uniform(filter.program, "tile_px", tile_px);
  for (int pass = 0; pass < (rings ? 1 : 2); ++pass) {
    filter.targets.push_back(make_target(std::array{Format::rgba16f}, width, height, false));
  }
  if (form == FilterForm::tiled) {
    filter.tiles = make_tile_reach(context, shaders, settings, rings, width, height, tile_px);
  }
  return filter;
}

void run_filter(const GlFilter& filter, const GlTexture& scene, const GlTexture* copy) {
  if (filter.tiles) {
    find_reach(*filter.tiles, scene);
    set_texture(filter.program, "tile_reach", 2, filter.tiles->reach.colour[0]);
  }
  const GlTexture* source = &scene;
  if (filter.ring_taps != 0) set_texture(filter.program, "ring_taps", 1, filter.ring_taps);
  glm::ivec2 direction{1, 0};  // of two-pass; one-pass has none
  for (const GlTarget& target : filter.targets) {
    set_texture(filter.program, "source", 0, *source);
    set_uniform(filter.program, "direction", direction);
    draw_fullscreen(target, filter.program);
    source = &target.colour[0];
    if (copy != nullptr && &target != &filter.targets.back()) {
      copy_colour(target, *copy);
      source = copy;
    }
    direction = {0, 1};
  }
}

GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height) {
  GlFilter filter =
      make_filter(context, shaders, method, FilterForm::brute_force, settings, width, height);
  run_filter(filter, scene);
  return std::move(filter.targets.back());
}

}  // namespace softfocus
