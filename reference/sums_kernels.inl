// add_row_plain() in vectors.

namespace {

using Doubles [[gnu::vector_size(8 * SOFTFOCUS_LANES)]] = double;

}  // namespace

/// Of whole vectors: returns how many halves they are.
int add_row(const std::uint16_t* const* rows, int row_count, int halves, double* totals) {
  int done = 0;
  for (; done + kLanes <= halves; done += kLanes) {
    Floats sum = load_halves(rows[0] + done);
    for (int i = 1; i < row_count; ++i) sum += load_halves(rows[i] + done);
    Doubles total;
    std::memcpy(&total, totals + done, sizeof total);
    total += __builtin_convertvector(sum, Doubles);
    std::memcpy(totals + done, &total, sizeof total);
  }
  return done;
}
