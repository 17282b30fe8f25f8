#pragma once
// The programmer's part: a vertex stage and a fragment stage, callables known when compiling, and
// the values that travel between them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>

namespace softfocus {

/// How a varying runs over a triangle.
enum class Interpolation : std::uint8_t {
  perspective,  ///< linear on the surface in space
  linear,       ///< linear in the window
  flat,         ///< the provoking vertex's value (DrawState::provoking_vertex)
};

inline constexpr std::size_t kMaxVaryings = 16;

template <std::size_t N>
using Varyings = std::array<float, N>;

/// What a vertex stage returns. Clip space: -w <= x, y, z <= w, y downwards.
template <std::size_t N>
struct VertexOutput {
  glm::vec4 position;
  Varyings<N> varyings;
};

// A vertex stage is callable as
//     VertexOutput<N> operator()(std::uint32_t vertex_index) const
//
// A fragment stage has
//     static constexpr std::array<Interpolation, N> kInterpolation
//     static constexpr bool kNeedsDerivatives   whether it reads ddx and ddy
//     static constexpr bool kDiscards           whether it may discard a fragment
//     bool discards() const                     if some draws of a stage that may do not
//     static constexpr bool kCentroid = true    if a pixel's varyings, where it is covered in part,
//                                               are those of its first sample that passes early
//                                               tests
//     FragmentOutput<C> operator()(const Fragment<N>&) const    C colour targets
// Both are called from several threads at once, and must not write what they share.

// A stage for draws of several numbers of varyings has those of the most, and
//     std::size_t varying_count() const         of this draw: the rest is not read

/// Whether a draw's fragment stage discards fragments.
template <class FragmentStage>
bool discards(const FragmentStage& stage) {
  if constexpr (requires { stage.discards(); }) return stage.discards();
  return FragmentStage::kDiscards;
}

/// Whether its varyings are centroid ones.
template <class FragmentStage>
constexpr bool is_centroid() {
  if constexpr (requires { FragmentStage::kCentroid; }) return FragmentStage::kCentroid;
  return false;
}

/// How many varyings a draw has.
template <class FragmentStage>
std::size_t varying_count(const FragmentStage& stage) {
  if constexpr (requires { stage.varying_count(); }) return stage.varying_count();
  return FragmentStage::kInterpolation.size();
}

/// A pixel of a triangle, as the fragment stage sees it.
template <std::size_t N>
struct Fragment {
  int x = 0;
  int y = 0;
  float depth = 0.0f;  ///< window depth, 0 to 1; beyond in softpipe's slivers
  bool front_facing = true;
  Varyings<N> varyings{};
  /// Differences to the next pixel right and down in this pixel's 2x2 block (even x, even y),
  /// taken along the block's upper row (in softpipe its lower row) and left column. They are the
  /// same for all four pixels, as GPUs' coarse derivatives are. Zero unless asked for.
  Varyings<N> ddx{};
  Varyings<N> ddy{};
};

template <std::size_t C>
struct FragmentOutput {
  std::array<glm::vec4, C> colour{};
  bool discard = false;
};

}  // namespace softfocus
