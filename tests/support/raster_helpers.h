#pragma once
// Shared by several tests of the raster room: stages that read their values from lists, and
// drawing in one call.

#include <array>
#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <utility>
#include <vector>

#include "raster/images/image.h"
#include "raster/images/sampler.h"
#include "raster/images/texel.h"
#include "raster/numbers/profile.h"
#include "raster/numbers/random_bits.h"
#include "raster/pipeline/draw.h"
#include "tests/support/random.h"

namespace softfocus::test {

inline Profile profile_named(std::string_view name) { return find_profile(name).value(); }

/// A vertex stage that reads a list.
template <std::size_t N>
struct ListedVertices {
  const std::vector<VertexOutput<N>>* list;
  VertexOutput<N> operator()(std::uint32_t i) const { return (*list)[i]; }
};

/// A fragment stage of one colour and no varyings.
struct OneColour {
  static constexpr std::array<Interpolation, 0> kInterpolation{};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  glm::vec4 colour{1.0f};
  FragmentOutput<1> operator()(const Fragment<0>&) const { return {{colour}, false}; }
};

/// A fragment stage whose colour is its four varyings.
template <Interpolation kind>
struct VaryingColour {
  static constexpr std::array kInterpolation{kind, kind, kind, kind};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<4>& f) const {
    return {{glm::vec4{f.varyings[0], f.varyings[1], f.varyings[2], f.varyings[3]}}, false};
  }
};

/// RGBA16F with every channel at random from `low` to `high`.
inline Image random_halves(int width, int height, std::uint64_t seed, double low, double high) {
  RandomSequence random{seed};
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& value : row<std::uint16_t>(image, y)) {
      value = float_to_half(static_cast<float>(next_between(random, low, high)),
                            HalfRounding::nearest_even);
    }
  }
  return image;
}

/// State that lets everything through: no culling, no depth test, no blending.
inline DrawState plain_state() {
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  return state;
}

/// Adds what is drawn to what is there, in every channel.
inline DrawState adding_state() {
  DrawState state = plain_state();
  const BlendEquation add{BlendFactor::one, BlendFactor::one, BlendOp::add};
  state.colour[0].blend = BlendState{add, add};
  return state;
}

inline std::vector<std::uint32_t> indices_up_to(std::size_t count) {
  std::vector<std::uint32_t> indices(count);
  for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<std::uint32_t>(i);
  return indices;
}

/// Draws the listed vertices, three a triangle, in one pass on one thread.
template <std::size_t N, class FragmentStage>
void draw_list(const RenderTargets& targets, const DrawState& state,
               const std::vector<VertexOutput<N>>& vertices, FragmentStage fragment_stage,
               const Profile& profile = {}, int threads = 1) {
  const std::vector<std::uint32_t> indices = indices_up_to(vertices.size());
  RenderPass pass{.targets = targets, .profile = profile, .draws = {}};
  draw(pass, state, indices, static_cast<std::uint32_t>(vertices.size()),
       ListedVertices<N>{&vertices}, std::move(fragment_stage));
  ThreadPool pool{threads};
  finish(pass, pool);
}

/// The clip position that comes out at a window position (pixels) with w = 1. Exact for
/// sides that are powers of two and positions that are multiples of 1/256 pixel.
inline glm::vec4 at_window(glm::vec2 window, int width, int height, float ndc_z = 0.0f) {
  return {window.x / (static_cast<float>(width) * 0.5f) - 1.0f,
          window.y / (static_cast<float>(height) * 0.5f) - 1.0f, ndc_z, 1.0f};
}

/// A list of window positions, three a triangle, as vertices without varyings.
inline std::vector<VertexOutput<0>> window_triangles(std::span<const glm::vec2> points, int width,
                                                     int height, float ndc_z = 0.0f) {
  std::vector<VertexOutput<0>> vertices;
  for (const glm::vec2 p : points) vertices.push_back({at_window(p, width, height, ndc_z), {}});
  return vertices;
}

/// The two triangles of a rectangle in window coordinates, six points, clockwise as seen.
inline std::vector<glm::vec2> window_quad(float x0, float y0, float x1, float y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y0}, {x1, y1}, {x0, y1}};
}

/// Six vertices that cover the whole target at one window depth (0 to 1).
inline std::vector<VertexOutput<0>> covering_quad(int width, int height, float depth = 0.5f) {
  return window_triangles(
      window_quad(0.0f, 0.0f, static_cast<float>(width), static_cast<float>(height)), width, height,
      depth * 2.0f - 1.0f);
}

/// Every component equal to the bit, NaN included.
inline bool same_bits(glm::vec4 a, glm::vec4 b) {
  for (int i = 0; i < 4; ++i) {
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i])) return false;
  }
  return true;
}

// Texels of independent channels between low and high.
inline Texture random_texture(Format format, int width, int height, std::uint64_t seed,
                              float low = 0.0f, float high = 1.0f) {
  Image image = make_image(format, width, height);
  Random random{seed};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      glm::vec4 value{};
      for (int i = 0; i < 4; ++i) value[i] = random.between(low, high);
      store_texel(image, x, y, value, {});
    }
  }
  return make_texture(std::move(image));
}

// A row of grey texels.
inline Texture row_texture(const std::vector<float>& values, Format format = Format::rgba32f) {
  Image image = make_image(format, static_cast<int>(values.size()), 1);
  for (std::size_t x = 0; x < values.size(); ++x) {
    store_texel(image, static_cast<int>(x), 0, glm::vec4{values[x]}, {});
  }
  return make_texture(std::move(image));
}

}  // namespace softfocus::test
