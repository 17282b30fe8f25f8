// What depth_range.cpp does along a row of pixels.

/// Widens kLanes least and then kLanes most depths, halves compared as integers, by those of
/// the row's whole vectors. Returns how many pixels those are.
int widen_range(const std::uint16_t* row, int width, std::uint32_t* range) {
  Bits least = load(range), most = load(range + kLanes);
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const Bits depth = load_half_texels(row + 4 * x).a;
    least = select(depth < least, depth, least);
    most = select(depth > most, depth, most);
  }
  store(range, least);
  store(range + kLanes, most);
  return x;
}
