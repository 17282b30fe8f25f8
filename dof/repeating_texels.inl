/// Pixels x to x + kLanes - 1 of a row; the picture's edges repeat outwards.
SOFTFOCUS_INLINE HalfTexels load_repeating(const std::uint16_t* row, int x, int width) {
  if (x >= 0 && x + kLanes <= width) return load_half_texels(row + 4 * x);
  std::uint16_t texels[4 * kLanes];
  for (int i = 0; i < kLanes; ++i) {
    const int inside = x + i < 0 ? 0 : x + i < width ? x + i : width - 1;
    std::memcpy(texels + 4 * i, row + 4 * inside, 4 * sizeof *texels);
  }
  return load_half_texels(texels);
}
