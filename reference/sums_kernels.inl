// add_row_plain() in vectors.

namespace {

using Doubles [[gnu::vector_size(8 * SOFTFOCUS_LANES)]] = double;

SOFTFOCUS_INLINE void add_to(double* totals, const Floats& values) {
  Doubles sum;
  std::memcpy(&sum, totals, sizeof sum);
  sum += __builtin_convertvector(values, Doubles);
  std::memcpy(totals, &sum, sizeof sum);
}

}  // namespace

/// Of whole vectors of pixels: returns how many pixels they are.
int add_row(const std::uint16_t* const* rows, int row_count, int width, double* red, double* green,
            double* blue) {
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const HalfTexels first = load_half_texels(rows[0] + 4 * x);
    Floats r = half_to_float(first.r), g = half_to_float(first.g), b = half_to_float(first.b);
    for (int i = 1; i < row_count; ++i) {
      const HalfTexels next = load_half_texels(rows[i] + 4 * x);
      r += half_to_float(next.r);
      g += half_to_float(next.g);
      b += half_to_float(next.b);
    }
    add_to(red + x, r);
    add_to(green + x, g);
    add_to(blue + x, b);
  }
  return x;
}
