// What the passes of motion blur share. Beside raster/effects/motion/motion_samples.h, whose order of
// operations this is.
uint jitter_bits(int x, int y) { return (uint(x) * 3242174889u + uint(y) * 2447445414u) >> 8; }

float jitter(ivec2 at) { return float(jitter_bits(at.x, at.y)) * 5.9604644775390625e-8; }

float way_at(int i, float jittered, float way_step) {
  precise float way = (float(i) + jittered) * way_step - 1.0;
  return way;
}

// Infinity is 65504: of raster/numbers/half.h. In bits, for NaN stays.
float compared_depth(float depth) {
  return floatBitsToUint(depth) == 0x7F800000u ? 65504.0 : depth;
}

float cut_to_1(float x) { return x > 0.0 ? (x < 1.0 ? x : 1.0) : 0.0; }

float finite_or_0(float px) { return abs(px) <= 65504.0 ? px : 0.0; }

ivec2 pixel_at(ivec2 at, vec2 moved, ivec2 size) {
  precise vec2 place = floor((vec2(at) + moved) + vec2(0.5));
  return clamp(ivec2(place), ivec2(0), size - 1);
}

// By length, then x, then y.
bool is_longer(vec2 a, vec2 b) {
  precise float of_a = a.x * a.x + a.y * a.y;
  precise float of_b = b.x * b.x + b.y * b.y;
  if (of_a != of_b) return of_a > of_b;
  return a.x != b.x ? a.x > b.x : a.y > b.y;
}
