// Between other programs' pictures and RGBA16F: every type, order and direction, against a
// loop over single values.

#include "dof/pack.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <vector>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/srgb.h"

using namespace softfocus;

namespace {

constexpr int kWidth = 37, kHeight = 11;
constexpr std::byte kSentinel{0xA5};
constexpr std::array kTypes{ChannelType::half, ChannelType::single, ChannelType::unorm8,
                            ChannelType::srgb8};

/// How a picture lies in memory.
struct Order {
  int channels;      ///< of a pixel; 0: planes
  bool upside_down;  ///< the bottom row first
};
constexpr std::array kOrders{Order{3, false}, Order{4, false}, Order{0, false}, Order{4, true}};

/// Colours in bytes of their own: random bits, so that halves and floats are of every kind.
struct Colours {
  std::vector<std::byte> bytes;
  ColourTarget view;
};

Colours make_colours(ChannelType type, Order order, std::uint64_t seed) {
  const std::ptrdiff_t bytes = bytes_per_channel(type);
  const std::ptrdiff_t step = order.channels == 0 ? bytes : order.channels * bytes;
  const std::ptrdiff_t row_bytes = kWidth * step + 5;  // so that nothing is aligned
  const std::ptrdiff_t plane = order.channels == 0 ? kHeight * row_bytes : bytes;
  Colours colours;
  colours.bytes.assign(static_cast<std::size_t>(3 * kHeight * row_bytes + 16), kSentinel);
  std::byte* first = colours.bytes.data() + 1 + (order.upside_down ? (kHeight - 1) * row_bytes : 0);
  colours.view = {type,          first,
                  first + plane, first + 2 * plane,
                  step,          order.upside_down ? -row_bytes : row_bytes};
  for (std::size_t i = 1; seed != 0 && i + 15 < colours.bytes.size(); ++i) {
    colours.bytes[i] = static_cast<std::byte>(mix_bits(seed + i) >> 40);
  }
  return colours;
}

const std::byte* at(const ColourSource& colours, int channel, int x, int y) {
  const void* const planes[] = {colours.red, colours.green, colours.blue};
  return static_cast<const std::byte*>(planes[channel]) + x * colours.pixel_bytes +
         y * colours.row_bytes;
}

std::uint16_t packed(ChannelType type, const std::byte* from, HalfRounding rounding) {
  std::uint16_t half = 0;
  float value = 0.0f;
  switch (type) {
    case ChannelType::half: std::memcpy(&half, from, 2); return half;
    case ChannelType::single: std::memcpy(&value, from, 4); return float_to_half(value, rounding);
    case ChannelType::unorm8: value = unorm8_to_linear(static_cast<std::uint8_t>(*from)); break;
    case ChannelType::srgb8: value = srgb8_to_linear(static_cast<std::uint8_t>(*from)); break;
  }
  return float_to_half(value, HalfRounding::nearest_even);
}

}  // namespace

TEST_CASE("pack takes every type of channel in every order on every vector unit") {
  std::vector<float> depths(kWidth * kHeight);
  for (std::size_t i = 0; i < depths.size(); ++i) depths[i] = 0.1f * static_cast<float>(i + 1);
  depths[3] = std::numeric_limits<float>::infinity();
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    for (const ChannelType type : kTypes) {
      for (const Order order : kOrders) {
        for (const HalfRounding rounding :
             {HalfRounding::nearest_even, HalfRounding::toward_zero, HalfRounding::swiftshader}) {
          const Colours colours = make_colours(type, order, 99);
          std::vector<std::uint16_t> picture(4 * kWidth * kHeight, 0xBEEF);
          pack(colours.view, {depths.data(), 4, 4 * kWidth}, rounding,
               view_of(Format::rgba16f, picture.data(), kWidth, kHeight), pool);
          int wrong = 0;
          for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
              const auto pixel = static_cast<std::size_t>(y * kWidth + x);
              for (int channel = 0; channel < 3; ++channel) {
                wrong += picture[4 * pixel + static_cast<std::size_t>(channel)] !=
                         packed(type, at(colours.view, channel, x, y), rounding);
              }
              wrong += picture[4 * pixel + 3] != float_to_half(depths[pixel], rounding);
            }
          }
          CAPTURE(isa_name(isa));
          CAPTURE(static_cast<int>(type));
          CAPTURE(order.channels);
          CHECK(wrong == 0);
        }
      }
    }
  }
}

TEST_CASE("unpack gives back the bytes and halves that were packed, and writes nothing else") {
  ThreadPool pool(2);
  const std::vector<float> depths(kWidth * kHeight, 2.0f);
  for (const ChannelType type : {ChannelType::half, ChannelType::unorm8, ChannelType::srgb8}) {
    for (const Order order : kOrders) {
      const Colours colours = make_colours(type, order, 7);
      std::vector<std::uint16_t> picture(4 * kWidth * kHeight);
      const ImageView view = view_of(Format::rgba16f, picture.data(), kWidth, kHeight);
      pack(colours.view, {depths.data(), 4, 4 * kWidth}, HalfRounding::nearest_even, view, pool);
      Colours back = make_colours(type, order, 0);
      unpack(view, back.view, pool);
      int wrong = 0;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          for (int channel = 0; channel < 3; ++channel) {
            const std::byte* there = at(back.view, channel, x, y);
            wrong += !std::equal(there, there + bytes_per_channel(type),
                                 at(colours.view, channel, x, y));
          }
        }
      }
      CHECK(wrong == 0);
      const auto written =
          static_cast<std::ptrdiff_t>(3 * kWidth * kHeight) * bytes_per_channel(type);
      const auto touched = static_cast<std::ptrdiff_t>(back.bytes.size()) -
                           std::count(back.bytes.begin(), back.bytes.end(), kSentinel);
      CHECK(touched <= written);
    }
  }
}

TEST_CASE("unpacked floats are the halves' values") {
  ThreadPool pool(1);
  std::vector<std::uint16_t> picture{0x3C00, 0x0001, 0xFBFF, 0x4000};
  std::array<float, 3> values{};
  unpack(view_of(Format::rgba16f, picture.data(), 1, 1),
         interleaved(ChannelType::single, values.data(), 3, 12), pool);
  CHECK(values == std::array{1.0f, 0x1p-24f, -65504.0f});
}
