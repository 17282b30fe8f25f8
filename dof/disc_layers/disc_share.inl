/// How much belongs to a rung or to larger ones.
SOFTFOCUS_INLINE Floats share_from(RungStep step, Floats square) {
  return larger(smaller((square - step.begin) * step.slope, splat(1.0f)), splat(0.0f));
}
