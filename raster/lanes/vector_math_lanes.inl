// vector_math.h for kLanes vectors at once.

struct Vec3Lanes {
  Floats x, y, z;
};

SOFTFOCUS_INLINE Vec3Lanes splat(const glm::vec3& v) {
  return {splat(v.x), splat(v.y), splat(v.z)};
}
SOFTFOCUS_INLINE Vec3Lanes operator+(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
SOFTFOCUS_INLINE Vec3Lanes operator-(const Vec3Lanes& a, const Vec3Lanes& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
SOFTFOCUS_INLINE Vec3Lanes operator*(const glm::vec3& a, const Vec3Lanes& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
SOFTFOCUS_INLINE Vec3Lanes operator*(const glm::vec3& a, Floats b) {
  return {a.x * b, a.y * b, a.z * b};
}
SOFTFOCUS_INLINE Vec3Lanes select(Mask mask, const Vec3Lanes& yes, const Vec3Lanes& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
SOFTFOCUS_INLINE Floats dot(const Vec3Lanes& a, const Vec3Lanes& b) {
  return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
SOFTFOCUS_INLINE Vec3Lanes normalize(const Vec3Lanes& v) {
  const Floats length = square_root(dot(v, v));
  const Mask long_enough = length > 0.0f;
  const Floats zero = splat(0.0f);
  return {select(long_enough, v.x / length, zero), select(long_enough, v.y / length, zero),
          select(long_enough, v.z / length, zero)};
}
