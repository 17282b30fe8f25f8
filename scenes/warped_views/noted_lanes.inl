// Radii with notes in lanes: nearest_whole() and radius_of() of each.

namespace {

SOFTFOCUS_INLINE Ints nearest_wholes(Floats value) {
  return as_ints(value + kWholeSum) - kWholeSumBits;
}
SOFTFOCUS_INLINE Floats without_notes(Floats noted) {
  return as_floats(as_bits(noted) & ~kRadiusNotes);
}

}  // namespace
