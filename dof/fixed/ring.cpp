#include "dof/fixed/ring.h"

namespace softfocus::fixed {
namespace {

bool within_limits(const Settings& settings) {
  const auto size_is_good = [](uint32_t size) {
    return size >= 1 && size <= SOFTFOCUS_FIXED_LARGEST_SIZE;
  };
  return size_is_good(settings.width) && size_is_good(settings.height) &&
         settings.reach <= SOFTFOCUS_FIXED_LARGEST_REACH;
}

bool formats_are_known(const Settings& settings) {
  if (settings.colour > SOFTFOCUS_FIXED_RGB565_SWAPPED) return false;
  return settings.depth <= SOFTFOCUS_FIXED_DEPTH16 ||
         (settings.depth == SOFTFOCUS_FIXED_DEPTH_IN_ALPHA &&
          settings.colour == SOFTFOCUS_FIXED_RGBA16F);
}

bool table_is_good(const Settings& settings, const Weights* table, uint8_t* leaking) {
  const uint32_t codes = settings.depth == SOFTFOCUS_FIXED_DEPTH8 ? 256 : 65536;
  uint8_t largest = 0;
  for (uint32_t code = 0; code < codes; ++code) {
    const Weights& weights = table[code];
    if (!within_bounds(weights, settings.reach)) return false;
    const uint8_t reach = reach_and_side(weights);
    if (weights.leak != kLeakOne && reach > largest) largest = reach;
  }
  *leaking = largest;
  return true;
}

}  // namespace

int begin_stream(Stream* stream, const Settings* settings, const Weights* table, void* memory,
                 size_t bytes, size_t bytes_needed) {
  if (stream == nullptr || table == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (!within_limits(*settings)) return SOFTFOCUS_FIXED_BAD_SIZE;
  if (!formats_are_known(*settings)) return SOFTFOCUS_FIXED_BAD_FORMAT;
  if (memory == nullptr || bytes < bytes_needed || reinterpret_cast<uintptr_t>(memory) % 4 != 0) {
    return SOFTFOCUS_FIXED_BAD_MEMORY;
  }
  uint8_t leaking = 0;
  if (!table_is_good(*settings, table, &leaking)) return SOFTFOCUS_FIXED_BAD_TABLE;
  stream->leaking = leaking;
  stream->table = table;
  stream->memory = static_cast<uint8_t*>(memory);
  stream->settings = *settings;
  stream->rows_in = 0;
  stream->rows_out = 0;
  stream->next_slot = 0;
  return 0;
}

void put_codes(const Stream& stream, const Ring& ring, const void* codes, uint32_t slot) {
  const uint32_t width = stream.settings.width;
  const size_t first = static_cast<size_t>(slot) * width;
  uint32_t farthest[2] = {0, 0};
  uint32_t reaches_there = 0;
  uint32_t last_code = ~0u;
  uint8_t last_reach = 0;
  for (uint32_t x = 0; x < width; ++x) {
    uint32_t code = 0;
    if (stream.settings.depth == SOFTFOCUS_FIXED_DEPTH8) {
      code = static_cast<const uint8_t*>(codes)[x];
      static_cast<uint8_t*>(ring.codes)[first + x] = static_cast<uint8_t>(code);
    } else {
      code = static_cast<const uint16_t*>(codes)[x];
      static_cast<uint16_t*>(ring.codes)[first + x] = static_cast<uint16_t>(code);
    }
    if (code != last_code) {
      last_code = code;
      const Weights& weights = stream.table[code];
      last_reach = reach_and_side(weights);
      reaches_there |= reach_bit(weights.reach);
      uint32_t& farthest_of_side = farthest[weights.beyond];
      if (weights.reach > farthest_of_side) farthest_of_side = weights.reach;
    }
    ring.reaches[first + x] = last_reach;
  }
  ring.farthest[slot] = static_cast<uint8_t>(farthest[0] > farthest[1] ? farthest[0] : farthest[1]);
  ring.reaches_there[slot] = reaches_there;
  ring.farthest_beyond[slot] = static_cast<uint8_t>(farthest[1]);
}

uint32_t list_taps(const Stream& stream, const Ring& ring, const uint8_t* farthest, uint32_t row) {
  const uint32_t last = stream.settings.height - 1u;
  uint32_t count = 0;
  for (uint32_t distance = 1; distance <= stream.settings.reach; ++distance) {
    const uint32_t above = row > distance ? row - distance : 0;
    const uint32_t below = last - row > distance ? row + distance : last;
    const uint32_t slots[] = {slot_of(stream, above), slot_of(stream, below)};
    for (const uint32_t slot : slots) {
      if (farthest[slot] < distance) continue;
      ring.taps[count++] = {slot * stream.settings.width, 2 * distance};
    }
  }
  return count;
}

}  // namespace softfocus::fixed

using namespace softfocus::fixed;

size_t softfocus_fixed_memory(const Settings* settings) {
  if (settings == nullptr || !within_limits(*settings) || !formats_are_known(*settings)) return 0;
  if (settings->colour == SOFTFOCUS_FIXED_RGBA16F) {
    return SOFTFOCUS_FIXED_MEMORY_HALF(settings->width, settings->reach);
  }
  const uint32_t has_alpha = settings->colour == SOFTFOCUS_FIXED_RGBA8 ? 1 : 0;
  const uint32_t depth_bytes = settings->depth == SOFTFOCUS_FIXED_DEPTH8 ? 1 : 2;
  return SOFTFOCUS_FIXED_MEMORY(settings->width, settings->reach, has_alpha, depth_bytes);
}

int softfocus_fixed_put_row(Stream* stream, uint32_t y, const void* colours, const void* depths,
                            void* out) {
  if (stream == nullptr || colours == nullptr || out == nullptr) {
    return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  }
  const Settings& settings = stream->settings;
  if (depths == nullptr && settings.depth != SOFTFOCUS_FIXED_DEPTH_IN_ALPHA) {
    return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  }
  if (y != stream->rows_in || y >= settings.height) return SOFTFOCUS_FIXED_BAD_ROW;
  stream->add_row(stream, colours, depths);
  ++stream->rows_in;
  ++stream->next_slot;
  if (stream->next_slot == ring_rows(settings)) stream->next_slot = 0;
  if (y < settings.reach) return 0;
  stream->write_row(stream, out);
  ++stream->rows_out;
  return 1;
}

int softfocus_fixed_finish_row(Stream* stream, void* out) {
  if (stream == nullptr || out == nullptr) return SOFTFOCUS_FIXED_BAD_ARGUMENT;
  if (stream->rows_in != stream->settings.height) return SOFTFOCUS_FIXED_BAD_ROW;
  if (stream->rows_out == stream->rows_in) return 0;
  stream->write_row(stream, out);
  ++stream->rows_out;
  return 1;
}
