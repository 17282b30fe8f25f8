#ifndef SOFTFOCUS_ISA  // once a vector unit: below

#include "dof/pack.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr int kPackedRows = 8;  // that a thread takes at a time

/// A row of the source, and the half of each byte where there are bytes.
struct PackRow {
  ChannelType type;
  const std::byte* colour[3];
  const std::byte* depth;
  std::ptrdiff_t colour_step;
  std::ptrdiff_t depth_step;
  const std::uint16_t* half_of_byte;
};

template <class Value>
Value read(const std::byte* from) {
  Value value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The bits of a colour that is stored as it is: all but floats.
std::uint16_t stored_half(const PackRow& row, const std::byte* from) {
  return row.type == ChannelType::half ? read<std::uint16_t>(from)
                                       : row.half_of_byte[static_cast<std::size_t>(*from)];
}

std::array<std::uint16_t, 256> halves_of_bytes(ChannelType type) {
  std::array<std::uint16_t, 256> halves{};
  for (int byte = 0; byte < 256; ++byte) {
    const auto code = static_cast<std::uint8_t>(byte);
    const float linear =
        type == ChannelType::srgb8 ? srgb8_to_linear(code) : unorm8_to_linear(code);
    halves[code] = float_to_half(linear, HalfRounding::nearest_even);
  }
  return halves;
}

void pack_pixel(const PackRow& row, int x, HalfRounding rounding, std::uint16_t* to) {
  for (int channel = 0; channel < 3; ++channel) {
    const std::byte* from = row.colour[channel] + x * row.colour_step;
    to[channel] = row.type == ChannelType::single ? float_to_half(read<float>(from), rounding)
                                                  : stored_half(row, from);
  }
  to[3] = float_to_half(read<float>(row.depth + x * row.depth_step), rounding);
}

}  // namespace
}  // namespace softfocus

#define SOFTFOCUS_KERNELS "dof/pack.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

template <class Value>
void write(std::byte* to, Value value) {
  std::memcpy(to, &value, sizeof value);
}

void unpack_channel(std::uint16_t half, ChannelType type, std::byte* to) {
  switch (type) {
    case ChannelType::half: return write(to, half);
    case ChannelType::single: return write(to, half_to_float(half));
    case ChannelType::unorm8: return write(to, linear_to_unorm8(half_to_float(half)));
    case ChannelType::srgb8: return write(to, linear_to_srgb8(half_to_float(half)));
  }
}

}  // namespace

void pack(const ColourSource& colour, const DepthSource& depth, HalfRounding rounding,
          const ImageView& picture, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f);
  std::array<std::uint16_t, 256> half_of_byte{};
  if (bytes_per_channel(colour.type) == 1) half_of_byte = halves_of_bytes(colour.type);
  for_each_row(pool, picture.height, kPackedRows, [&](int y) {
    const auto at = [y](const void* first, std::ptrdiff_t row_bytes) {
      return static_cast<const std::byte*>(first) + y * row_bytes;
    };
    const PackRow from{colour.type,
                       {at(colour.red, colour.row_bytes), at(colour.green, colour.row_bytes),
                        at(colour.blue, colour.row_bytes)},
                       at(depth.first, depth.row_bytes),
                       colour.pixel_bytes,
                       depth.pixel_bytes,
                       half_of_byte.data()};
    std::uint16_t* to = row<std::uint16_t>(picture, y).data();
    if (pool.isa() != Isa::scalar) {
      SOFTFOCUS_KERNEL(pool.isa(), pack_row)(from, picture.width, rounding, to);
      return;
    }
    for (int x = 0; x < picture.width; ++x) pack_pixel(from, x, rounding, to + 4 * x);
  });
}

void unpack(const ConstImageView& picture, const ColourTarget& colour, ThreadPool& pool) {
  assert(picture.format == Format::rgba16f);
  for_each_row(pool, picture.height, kPackedRows, [&](int y) {
    const std::uint16_t* from = row<std::uint16_t>(picture, y).data();
    for (int channel = 0; channel < 3; ++channel) {
      void* const planes[] = {colour.red, colour.green, colour.blue};
      std::byte* to = static_cast<std::byte*>(planes[channel]) + y * colour.row_bytes;
      for (int x = 0; x < picture.width; ++x, to += colour.pixel_bytes) {
        unpack_channel(from[4 * x + channel], colour.type, to);
      }
    }
  });
}

}  // namespace softfocus

#else  // the kernels

namespace {

template <HalfRounding rounding>
SOFTFOCUS_INLINE void pack_vector(const PackRow& row, int x, std::uint16_t* to) {
  Bits halves[3];
  for (int channel = 0; channel < 3; ++channel) {
    const std::byte* from = row.colour[channel] + x * row.colour_step;
    if (row.type == ChannelType::single) {
      float values[kLanes];
      for (int i = 0; i < kLanes; ++i) values[i] = read<float>(from + i * row.colour_step);
      halves[channel] = float_to_half<rounding>(load(values));
    } else {
      std::uint32_t values[kLanes];
      for (int i = 0; i < kLanes; ++i) values[i] = stored_half(row, from + i * row.colour_step);
      halves[channel] = load(values);
    }
  }
  float depths[kLanes];
  for (int i = 0; i < kLanes; ++i) depths[i] = read<float>(row.depth + (x + i) * row.depth_step);
  store_half_texels(to + 4 * x,
                    {halves[0], halves[1], halves[2], float_to_half<rounding>(load(depths))});
}

template <HalfRounding rounding>
SOFTFOCUS_INLINE void pack_vectors(const PackRow& row, int width, std::uint16_t* to) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) pack_vector<rounding>(row, x, to);
  for (; x < width; ++x) pack_pixel(row, x, rounding, to + 4 * x);
}

}  // namespace

void pack_row(const PackRow& row, int width, HalfRounding rounding, std::uint16_t* to) {
  using enum HalfRounding;
  switch (rounding) {
    case nearest_even: return pack_vectors<nearest_even>(row, width, to);
    case toward_zero: return pack_vectors<toward_zero>(row, width, to);
    case swiftshader: return pack_vectors<swiftshader>(row, width, to);
  }
}

#endif
