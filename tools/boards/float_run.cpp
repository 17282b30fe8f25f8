// The float filter for run_filter.cpp: RGB565 to floats by table, and back.

#include "tools/boards/filter.h"
#include "tools/boards/float_filter.h"

namespace softfocus::boards {

const FrameFormat kFilterFormat = FrameFormat::rgb565;

struct Filter {
  int width;
  float fifths[32];  ///< of 5 bits
  float sixths[64];  ///< of 6 bits
  float* colour;
  FloatFilter* filter;
};

namespace {

constexpr float kMicrometre = 1e-6f;

size_t own_bytes(const FrameSettings& settings) {
  return (sizeof(Filter) + 3 * sizeof(float) * settings.width + 7) & ~size_t{7};
}

uint16_t to_rgb565(const float* colour) {
  const auto r = static_cast<unsigned>(colour[0] * 31.0f + 0.5f);
  const auto g = static_cast<unsigned>(colour[1] * 63.0f + 0.5f);
  const auto b = static_cast<unsigned>(colour[2] * 31.0f + 0.5f);
  return static_cast<uint16_t>(r << 11 | g << 5 | b);
}

}  // namespace

size_t filter_bytes(const FrameSettings& settings) {
  return own_bytes(settings) + float_filter_bytes(static_cast<int>(settings.width),
                                                  static_cast<int>(settings.max_radius_px));
}

Filter* begin_filter(const FrameSettings& settings, uint8_t* memory, size_t bytes) {
  if (settings.max_radius_px > kMaxFloatReach + 1 || bytes < filter_bytes(settings)) return nullptr;
  auto& filter = *reinterpret_cast<Filter*>(memory);
  filter.width = static_cast<int>(settings.width);
  for (int i = 0; i < 32; ++i) filter.fifths[i] = static_cast<float>(i) / 31.0f;
  for (int i = 0; i < 64; ++i) filter.sixths[i] = static_cast<float>(i) / 63.0f;
  filter.colour = reinterpret_cast<float*>(memory + sizeof(Filter));
  const FloatLens lens = {static_cast<float>(settings.radius_at_infinity_q16) / 65536.0f,
                          static_cast<float>(settings.focus_um) * kMicrometre,
                          static_cast<float>(settings.near_um) * kMicrometre,
                          static_cast<float>(settings.far_um) * kMicrometre, 1.0f};
  filter.filter = begin_float_filter(lens, filter.width, static_cast<int>(settings.max_radius_px),
                                     memory + own_bytes(settings));
  return &filter;
}

bool next_row(Filter& filter, void* to) {
  auto* const out = static_cast<uint16_t*>(to);
  end_float_rows(*filter.filter);
  if (!take_float_row(*filter.filter, filter.colour)) return false;
  for (int x = 0; x < filter.width; ++x) out[x] = to_rgb565(filter.colour + 3 * x);
  return true;
}

bool put_row(Filter& filter, const void* from, const void* depth, void* to) {
  const auto* const colour = static_cast<const uint16_t*>(from);
  auto* const out = static_cast<uint16_t*>(to);
  for (int x = 0; x < filter.width; ++x) {
    float* const rgb = filter.colour + 3 * x;
    rgb[0] = filter.fifths[colour[x] >> 11];
    rgb[1] = filter.sixths[colour[x] >> 5 & 63];
    rgb[2] = filter.fifths[colour[x] & 31];
  }
  put_float_row(*filter.filter, filter.colour, static_cast<const uint8_t*>(depth));
  if (!take_float_row(*filter.filter, filter.colour)) return false;
  for (int x = 0; x < filter.width; ++x) out[x] = to_rgb565(filter.colour + 3 * x);
  return true;
}

}  // namespace softfocus::boards
