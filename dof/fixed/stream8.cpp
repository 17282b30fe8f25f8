// The filter for 8-bit colour: RGBA8, and RGB565 in both orders of its bytes.

#include "dof/fixed/moving_sums.h"

namespace softfocus::fixed {
namespace {

Ring ring8(const Stream& stream) {
  const Settings& settings = stream.settings;
  Ring ring{};
  ring.rows = ring_rows(settings);
  const size_t pixels = static_cast<size_t>(ring.rows) * settings.width;
  Parts parts{stream.memory};
  ring.colours = parts.next(4 * pixels);
  ring.line = parts.next(4u * settings.width);
  ring.columns = reinterpret_cast<Sums*>(parts.next(sizeof(Sums) * settings.width));
  ring.changes = reinterpret_cast<Sums*>(parts.next(sizeof(Sums) * 4 * (settings.reach + 1u)));
  ring.taps = reinterpret_cast<Tap*>(parts.next(2 * sizeof(Tap) * settings.reach));
  ring.reaches_there = reinterpret_cast<uint32_t*>(parts.next(4 * ring.rows));
  ring.codes = parts.next(settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? pixels : 2 * pixels);
  ring.reaches = parts.next(pixels);
  ring.alphas = settings.colour == SOFTFOCUS_FIXED_RGBA8 ? parts.next(pixels) : nullptr;
  ring.farthest = parts.next(ring.rows);
  ring.farthest_beyond = parts.next(ring.rows);
  return ring;
}

constexpr uint32_t expand5(uint32_t value) { return value << 3 | value >> 2; }
constexpr uint32_t expand6(uint32_t value) { return value << 2 | value >> 4; }
constexpr uint32_t swapped(uint32_t word) { return (word << 8 | word >> 8) & 0xFFFFu; }
// 31 v / 255 and 63 v / 255, rounded to nearest, for bytes.
constexpr uint32_t reduce5(uint32_t byte) { return (byte * 249 + 1014) >> 11; }
constexpr uint32_t reduce6(uint32_t byte) { return (byte * 253 + 505) >> 10; }

void add_row8(Stream* stream, const void* colours, const void* depths) {
  const Ring ring = ring8(*stream);
  const uint32_t width = stream->settings.width;
  const uint32_t slot = slot_of(*stream, stream->rows_in);
  put_codes(*stream, ring, depths, slot);
  auto* line = static_cast<uint32_t*>(ring.line);
  if (stream->settings.colour == SOFTFOCUS_FIXED_RGBA8) {
    const auto* bytes = static_cast<const uint8_t*>(colours);
    uint8_t* alphas = static_cast<uint8_t*>(ring.alphas) + static_cast<size_t>(slot) * width;
    for (uint32_t x = 0; x < width; ++x, bytes += 4) {
      line[x] = pack(uint32_t{bytes[0]} << 2, uint32_t{bytes[1]} << 2, uint32_t{bytes[2]} << 2);
      alphas[x] = bytes[3];
    }
  } else {
    const auto* words = static_cast<const uint16_t*>(colours);
    const bool swaps = stream->settings.colour == SOFTFOCUS_FIXED_RGB565_SWAPPED;
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t word = swaps ? swapped(words[x]) : words[x];
      line[x] =
          pack(expand5(word >> 11) << 2, expand6(word >> 5 & 63u) << 2, expand5(word & 31u) << 2);
    }
  }
  filter_across(*stream, ring, slot);
}

/// The second pass, of row rows_out.
void write_row8(Stream* stream, void* out) {
  const Ring ring = ring8(*stream);
  const uint32_t width = stream->settings.width;
  const uint32_t slot = slot_of(*stream, stream->rows_out);
  const size_t first = static_cast<size_t>(slot) * width;
  filter_down(*stream, ring, stream->rows_out);
  const auto* line = static_cast<const uint32_t*>(ring.line);
  if (stream->settings.colour == SOFTFOCUS_FIXED_RGBA8) {
    auto* bytes = static_cast<uint8_t*>(out);
    const uint8_t* alphas = static_cast<const uint8_t*>(ring.alphas) + first;
    for (uint32_t x = 0; x < width; ++x, bytes += 4) {
      bytes[0] = static_cast<uint8_t>(red(line[x]) >> 2);
      bytes[1] = static_cast<uint8_t>(green(line[x]) >> 2);
      bytes[2] = static_cast<uint8_t>(blue(line[x]) >> 2);
      bytes[3] = alphas[x];
    }
  } else {
    auto* words = static_cast<uint16_t*>(out);
    const bool swaps = stream->settings.colour == SOFTFOCUS_FIXED_RGB565_SWAPPED;
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t word = reduce5(red(line[x]) >> 2) << 11 | reduce6(green(line[x]) >> 2) << 5 |
                            reduce5(blue(line[x]) >> 2);
      words[x] = static_cast<uint16_t>(swaps ? swapped(word) : word);
    }
  }
}

}  // namespace
}  // namespace softfocus::fixed

using namespace softfocus::fixed;

int softfocus_fixed_begin(Stream* stream, const Settings* settings, const Weights* table,
                          void* memory, size_t bytes) {
  if (settings == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (settings->colour == SOFTFOCUS_FIXED_RGBA16F) return SOFTFOCUS_FIXED_BAD_FORMAT;
  const int error =
      begin_stream(stream, settings, table, memory, bytes, softfocus_fixed_memory(settings));
  if (error != 0) return error;
  stream->add_row = add_row8;
  stream->write_row = write_row8;
  return 0;
}
