#pragma once
// The fixed-function state of a draw call, in OpenGL's terms and with its defaults.

#include <array>
#include <cstdint>
#include <optional>

namespace softfocus {

enum class Compare : std::uint8_t {
  never,
  less,
  equal,
  less_equal,
  greater,
  not_equal,
  greater_equal,
  always,
};

/// With NaN, only not_equal and always are true.
template <class Value>
constexpr bool compare(Compare function, Value incoming, Value stored) {
  switch (function) {
    case Compare::never: return false;
    case Compare::less: return incoming < stored;
    case Compare::equal: return incoming == stored;
    case Compare::less_equal: return incoming <= stored;
    case Compare::greater: return incoming > stored;
    case Compare::not_equal: return !(incoming == stored);
    case Compare::greater_equal: return incoming >= stored;
    case Compare::always: return true;
  }
  return false;
}

enum class Cull : std::uint8_t { none, back, front };

/// Which winding, as seen in the picture (row 0 on top), is a front face.
enum class FrontFace : std::uint8_t { counter_clockwise, clockwise };

/// Which vertex of a triangle gives `flat` varyings their value.
enum class ProvokingVertex : std::uint8_t { last, first };

/// Pixels x_begin <= x < x_end, y_begin <= y < y_end.
struct Rectangle {
  int x_begin = 0;
  int y_begin = 0;
  int x_end = 0;
  int y_end = 0;
};

/// The pixels of both; none if an end is not above its begin.
constexpr Rectangle intersection(const Rectangle& a, const Rectangle& b) {
  // Not std::max: <algorithm> doubles what there is to parse here.
  const auto later = [](int x, int y) { return x > y ? x : y; };
  const auto earlier = [](int x, int y) { return x < y ? x : y; };
  return {later(a.x_begin, b.x_begin), later(a.y_begin, b.y_begin), earlier(a.x_end, b.x_end),
          earlier(a.y_end, b.y_end)};
}

/// Pixels x_begin <= x < x_end of a row; none if x_begin >= x_end.
struct Span {
  int x_begin = 0;
  int x_end = 0;
};

struct DepthState {
  Compare test = Compare::less;
  bool write = true;
};

enum class StencilOp : std::uint8_t {
  keep,
  zero,
  replace,
  increment_clamp,
  decrement_clamp,
  invert,
  increment_wrap,
  decrement_wrap,
};

/// Passes where (reference & read_mask) `test` (stored & read_mask).
struct StencilFace {
  Compare test = Compare::always;
  std::uint8_t reference = 0;
  std::uint8_t read_mask = 0xFF;
  std::uint8_t write_mask = 0xFF;
  StencilOp on_fail = StencilOp::keep;        ///< the stencil test failed
  StencilOp on_depth_fail = StencilOp::keep;  ///< it passed and the depth test failed
  StencilOp on_pass = StencilOp::keep;        ///< both passed
};

struct StencilState {
  StencilFace front;
  StencilFace back;
};

enum class BlendFactor : std::uint8_t {
  zero,
  one,
  source_colour,
  one_minus_source_colour,
  destination_colour,
  one_minus_destination_colour,
  source_alpha,
  one_minus_source_alpha,
  destination_alpha,
  one_minus_destination_alpha,
};

enum class BlendOp : std::uint8_t { add, subtract, reverse_subtract, minimum, maximum };

/// result = source * source_factor (op) destination * destination_factor. Minimum and
/// maximum take no factors.
struct BlendEquation {
  BlendFactor source = BlendFactor::one;
  BlendFactor destination = BlendFactor::zero;
  BlendOp op = BlendOp::add;
};

struct BlendState {
  BlendEquation colour;
  BlendEquation alpha;
};

/// State of one colour target.
struct ColourState {
  std::optional<BlendState> blend;  ///< none: the source replaces the destination
  std::array<bool, 4> write{true, true, true, true};
};

inline constexpr int kMaxColourTargets = 4;

struct DrawState {
  Cull cull = Cull::back;
  FrontFace front_face = FrontFace::counter_clockwise;
  ProvokingVertex provoking_vertex = ProvokingVertex::last;
  std::optional<Rectangle> scissor;
  std::optional<DepthState> depth = DepthState{};
  std::optional<StencilState> stencil;
  /// Of n samples sample s is left out unless the first colour's alpha is above s / n, or NaN.
  bool alpha_to_coverage = false;
  std::array<ColourState, kMaxColourTargets> colour{};
};

}  // namespace softfocus
