// The fixed-point filter for run_filter.cpp. The file that includes this defines what the formats
// differ in: kColour and kDepth of softfocus_fixed_settings, kCodes of the table, make_table(),
// begin_stream(). Three programs, so that each has the code of its format alone.

namespace softfocus::boards {

struct Filter {
  softfocus_fixed_stream stream;
  uint32_t rows_in;
  softfocus_fixed_weights table[kCodes];
};

namespace {

softfocus_fixed_settings stream_settings(const FrameSettings& settings) {
  const auto radius = static_cast<uint8_t>(settings.max_radius_px);
  return {static_cast<uint16_t>(settings.width), static_cast<uint16_t>(settings.height),
          static_cast<uint8_t>(radius > 0 ? radius - 1 : 0), kColour, kDepth};
}

}  // namespace

size_t filter_bytes(const FrameSettings& settings) {
  const softfocus_fixed_settings of_stream = stream_settings(settings);
  return sizeof(Filter) + softfocus_fixed_memory(&of_stream);
}

Filter* begin_filter(const FrameSettings& settings, uint8_t* memory, size_t bytes) {
  auto& filter = *reinterpret_cast<Filter*>(memory);
  filter.rows_in = 0;
  const softfocus_fixed_lens lens = {settings.radius_at_infinity_q16, settings.focus_um,
                                     settings.max_radius_px * SOFTFOCUS_FIXED_ONE_PIXEL,
                                     SOFTFOCUS_FIXED_ONE_PIXEL};
  const softfocus_fixed_settings of_stream = stream_settings(settings);
  const bool begun = make_table(lens, settings, filter.table) == 0 &&
                     begin_stream(&filter.stream, &of_stream, filter.table, memory + sizeof(Filter),
                                  bytes - sizeof(Filter)) == 0;
  return begun ? &filter : nullptr;
}

bool put_row(Filter& filter, const void* colour, const void* depth, void* out) {
  return softfocus_fixed_put_row(&filter.stream, filter.rows_in++, colour, depth, out) == 1;
}

bool next_row(Filter& filter, void* out) {
  return softfocus_fixed_finish_row(&filter.stream, out) == 1;
}

}  // namespace softfocus::boards
