// Edges that tiles find, against finding them pixel by pixel.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "raster/pipeline/multisample.h"
#include "tests/support/mixed_stage.h"
#include "tests/support/raster_helpers.h"
#include "tests/support/sanitizers.h"

using namespace softfocus;
using test::profile_named;

namespace {

using Vertices = std::vector<VertexOutput<4>>;

struct Target {
  int width;
  int height;
};

struct Edges {
  Image picture, depth, other, coverage;
};

Edges no_edges(const Target& target) {
  Edges edges{make_image(Format::rgba16f, target.width, target.height),
              make_image(Format::r32f, target.width, target.height),
              make_image(Format::rgba16f, target.width, target.height),
              make_image(Format::r8, target.width, target.height)};
  clear_image(edges.coverage, glm::vec4{1.0f}, {});  // what is not written shows
  return edges;
}

constexpr glm::vec4 kEdgesClear{0.25f};
constexpr float kEdgesDepth = 0.75f;

Edges draw_edges(Isa isa, const Target& target, int samples, const Vertices& vertices,
                 std::span<const std::uint32_t> indices, const Profile& profile,
                 std::size_t layers = 1) {
  Edges edges = no_edges(target);
  std::vector<Image> colours, depths;
  for (std::size_t i = 1; i < layers; ++i) {
    colours.push_back(make_image(Format::rgba16f, target.width, target.height));
    depths.push_back(make_image(Format::r32f, target.width, target.height));
  }
  RenderPass pass;
  pass.targets.colour[0] = &edges.picture;
  pass.targets.depth = &edges.depth;
  pass.isa = isa;
  for (std::size_t i = 1; i < layers; ++i) {
    pass.targets.behind[i - 1] = {&colours[i - 1], &depths[i - 1]};
  }
  pass.profile = profile;
  if (samples > 1) pass.edges = {samples, &edges.other, &edges.coverage};
  pass.clear_colour = kEdgesClear;
  pass.clear_depth = kEdgesDepth;
  DrawState state;
  state.cull = Cull::none;
  draw_in_lanes(pass, state, indices, static_cast<std::uint32_t>(vertices.size()),
                test::ListedVertices<4>{&vertices}, test::MixedColour{}, test::mixed_stages(isa));
  ThreadPool pool{2, isa};
  finish(pass, pool);
  return edges;
}

struct PlacedTriangle {
  Triangle<4> triangle;
  std::array<std::uint32_t, 3> corners;
};

// Of triangles that nothing clips.
std::vector<PlacedTriangle> place_triangles(const Target& target, int samples,
                                            const Vertices& vertices,
                                            std::span<const std::uint32_t> indices,
                                            const Profile& profile) {
  std::vector<PlacedTriangle> placed;
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    std::array<WindowVertex, 3> window{};
    std::array<Varyings<4>, 3> varyings{};
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexOutput<4>& vertex = vertices[indices[i + k]];
      window[k] = to_window(vertex.position, target.width, target.height, profile.viewport);
      varyings[k] = vertex.varyings;
    }
    const auto setup = set_up_triangle(window, Cull::none, FrontFace::counter_clockwise,
                                       {0, 0, target.width, target.height}, profile, 1, samples);
    if (!setup) continue;
    placed.push_back({{*setup, varyings, 2}, {indices[i], indices[i + 1], indices[i + 2]}});
  }
  return placed;
}

bool covers(const PlacedTriangle& placed, int x, int y, const glm::ivec2& place) {
  const auto& functions = std::get<EdgeFunctions>(placed.triangle.setup.coverage);
  return std::all_of(functions.edges.begin(), functions.edges.end(), [&](const EdgeFunction& edge) {
    return inside(edge, edge_at(edge, x, y, place));
  });
}

bool share_surface(const PlacedTriangle& a, const PlacedTriangle& b) {
  if (a.triangle.setup.front_facing != b.triangle.setup.front_facing) return false;
  return std::any_of(a.corners.begin(), a.corners.end(), [&](std::uint32_t corner) {
    return std::find(b.corners.begin(), b.corners.end(), corner) != b.corners.end();
  });
}

template <class Interpolator>
glm::vec4 shaded(const PlacedTriangle& placed, int x, int y, const glm::ivec2& place,
                 const Profile& profile) {
  const Interpolator interpolator{placed.triangle, profile, test::MixedColour::kInterpolation};
  Fragment<4> fragment{.x = x, .y = y, .front_facing = placed.triangle.setup.front_facing};
  fragment.varyings = interpolator.at(x, y, place).varyings;
  // Differences of the quad, at the same places of its pixels.
  const Varyings<4> corner = interpolator.at(x & ~1, y & ~1, place).varyings;
  const Varyings<4> right = interpolator.at(x | 1, y & ~1, place).varyings;
  const Varyings<4> below = interpolator.at(x & ~1, y | 1, place).varyings;
  for (std::size_t i = 0; i < 4; ++i) {
    fragment.ddx[i] = right[i] - corner[i];
    fragment.ddy[i] = below[i] - corner[i];
  }
  Image texel = make_image(Format::rgba16f, 1, 1);
  store_texel(texel, 0, 0, test::MixedColour{}(fragment).colour[0], profile);
  return load_texel(texel, 0, 0);
}

template <class Interpolator>
void store_edge(const Image& picture, Edges& to, int samples,
                std::span<const PlacedTriangle> triangles, int x, int y, const Profile& profile) {
  const std::span<const glm::ivec2> places = sample_places(samples);
  const auto shown_at = [&](const glm::ivec2& place) {
    const PlacedTriangle* shown = nullptr;
    float nearest = kEdgesDepth;
    for (const PlacedTriangle& placed : triangles) {
      const Rectangle& bounds = placed.triangle.setup.bounds;
      if (x < bounds.x_begin || x >= bounds.x_end || y < bounds.y_begin || y >= bounds.y_end) {
        continue;
      }
      if (!covers(placed, x, y, place)) continue;
      const Interpolator interpolator{placed.triangle, profile, test::MixedColour::kInterpolation};
      const float depth =
          draw_detail::clamped_depth(interpolator.depth(interpolator.pixel(x, y, place)), profile);
      if (!(depth < nearest)) continue;
      nearest = depth;
      shown = &placed;
    }
    return shown;
  };
  const auto are_one = [](const PlacedTriangle* a, const PlacedTriangle* b) {
    return a == b || (a != nullptr && b != nullptr && share_surface(*a, *b));
  };
  const PlacedTriangle* centre = shown_at({});
  std::vector<const PlacedTriangle*> shows;
  for (const glm::ivec2& place : places) shows.push_back(shown_at(place));
  std::vector<bool> is_done(places.size());
  std::vector<glm::vec4> texels(places.size()), others;
  for (std::size_t first = 0; first < places.size(); ++first) {
    if (is_done[first] || are_one(centre, shows[first])) continue;
    std::vector<std::size_t> of_surface;
    for (std::size_t s = first; s < places.size(); ++s) {
      if (!is_done[s] && !are_one(centre, shows[s]) && are_one(shows[first], shows[s])) {
        of_surface.push_back(s);
      }
    }
    const PlacedTriangle* by = nullptr;
    glm::ivec2 place{};
    int most = 0;
    for (const std::size_t s : of_surface) {
      int count = 0;
      glm::ivec2 sum{};
      for (const std::size_t other : of_surface) {
        if (shows[other] != shows[s]) continue;
        sum += places[other];
        ++count;
      }
      if (count <= most) continue;
      by = shows[s];
      most = count;
      place = sum / count;
    }
    Image texel = make_image(Format::rgba16f, 1, 1);
    store_texel(texel, 0, 0, kEdgesClear, profile);
    for (const std::size_t s : of_surface) {
      texels[s] =
          by == nullptr ? load_texel(texel, 0, 0) : shaded<Interpolator>(*by, x, y, place, profile);
      is_done[s] = true;
    }
  }
  for (std::size_t s = 0; s < places.size(); ++s) {
    if (is_done[s]) others.push_back(texels[s]);
  }
  const OtherSurface found = other_surface(load_texel(picture, x, y).w, others);
  row<std::uint8_t>(to.coverage, y)[static_cast<std::size_t>(x)] =
      coverage_byte(found.samples, samples);
  if (found.samples > 0) store_texel(to.other, x, y, found.texel, profile);
}

// Returns how many edge pixels there were.
int check_edges(const Target& target, const Vertices& vertices,
                std::span<const std::uint32_t> indices, const Profile& profile) {
  int mixed = 0;
  for (const int samples : {4, 8}) {
    Edges expected = no_edges(target);
    bool is_known = false;
    for (const Isa isa : available_isas()) {
      if (isa == Isa::scalar) continue;
      const Edges without = draw_edges(isa, target, 1, vertices, indices, profile);
      const auto triangles = place_triangles(target, samples, vertices, indices, profile);
      for (int y = 0; y < target.height && !is_known; ++y) {
        for (int x = 0; x < target.width; ++x) {
          if (profile.attributes == AttributeSetup::exact_barycentric) {
            store_edge<BarycentricInterpolator<4>>(without.picture, expected, samples, triangles, x,
                                                   y, profile);
          } else {
            using Interpolator = PlaneInterpolator<PlanesFromOrigin, 4>;
            store_edge<Interpolator>(without.picture, expected, samples, triangles, x, y, profile);
          }
        }
      }
      is_known = true;
      for (const std::size_t layers : {std::size_t{1}, std::size_t{3}}) {
        const Edges drawn = draw_edges(isa, target, samples, vertices, indices, profile, layers);
        INFO("isa ", isa_name(isa));
        INFO("samples ", samples, ", layers ", layers);
        CHECK(equal(drawn.picture, without.picture));
        CHECK(equal(drawn.depth, without.depth));
        CHECK(equal(drawn.coverage, expected.coverage));
        int different = 0;
        for (int y = 0; y < target.height; ++y) {
          for (int x = 0; x < target.width; ++x) {
            if (load_texel(expected.coverage, x, y).x == 0.0f) continue;
            ++mixed;
            different +=
                !test::same_bits(load_texel(drawn.other, x, y), load_texel(expected.other, x, y));
          }
        }
        CHECK(different == 0);
      }
    }
  }
  return mixed;
}

// Sheets of quads that share corners, bent and before each other.
std::pair<Vertices, std::vector<std::uint32_t>> sheets(test::Random& random, const Target& target,
                                                       int sheet_count, int cells,
                                                       std::optional<double> size = {}) {
  Vertices vertices;
  std::vector<std::uint32_t> indices;
  for (int sheet = 0; sheet < sheet_count; ++sheet) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    const double x = random.between(2.0, target.width * 0.6),
                 y = random.between(2.0, target.height * 0.6);
    const double cell = size.value_or(random.between(0.4, 5.0));
    for (int j = 0; j <= cells; ++j) {
      for (int i = 0; i <= cells; ++i) {
        const double from = size ? 0.5 * cells : 0.0;  // a large one lies about its middle
        const glm::vec2 window{
            static_cast<float>(x + cell * (i - from + random.between(-0.6, 0.6))),
            static_cast<float>(y + cell * (j - from + random.between(-0.6, 0.6)))};
        VertexOutput<4> vertex{
            test::at_window(window, target.width, target.height, random.between(-0.9f, 0.9f)), {}};
        vertex.position *= random.between(0.5f, 2.0f);
        for (float& value : vertex.varyings) value = random.between(-2.0f, 2.0f);
        vertices.push_back(vertex);
      }
    }
    const auto across = static_cast<std::uint32_t>(cells + 1);
    for (std::uint32_t j = 0; j + 1 < across; ++j) {
      for (std::uint32_t i = 0; i + 1 < across; ++i) {
        const std::uint32_t at = first + j * across + i;
        for (const std::uint32_t corner : {0u, 1u, across, across, 1u, across + 1}) {
          indices.push_back(at + corner);
        }
      }
    }
  }
  return {vertices, indices};
}

constexpr std::array kProfileNames{"ieee", "d3d11", "llvmpipe", "llvmpipe-sse41"};

}  // namespace

TEST_CASE("lanes: edges are those that are found pixel by pixel, and leave the picture as it is") {
  const Target target{75, 70};  // four tiles
  for (const char* name : kProfileNames) {
    INFO("profile ", name);
    test::Random random{512};
    for (const int cells : {1, 4, 12}) {
      const auto [vertices, indices] = sheets(random, target, fewer(40) / cells + 1, cells);
      CHECK(check_edges(target, vertices, indices, profile_named(name)) > 0);
    }
  }
}

TEST_CASE("lanes: edges of triangles far larger than the picture") {
  const Target target{40, 30};
  test::Random random{513};
  int edges = 0;
  for (const double cell : {95.0, 130.0, 170.0}) {
    const auto [vertices, indices] = sheets(random, target, 6, 2, cell);
    edges += check_edges(target, vertices, indices, {});
  }
  CHECK(edges > 0);
}
