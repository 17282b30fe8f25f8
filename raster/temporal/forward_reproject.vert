// A point for each pixel of the frame before, at its place now; the depth test, by `less`, keeps
// the nearest, and of equal ones the first. Beside raster/temporal/forward_reproject.cpp.
uniform sampler2D before;    // colour, depth in alpha
uniform sampler2D velocity;  // pixels, x right, y down: until now

flat out vec4 moved;

// In bits: drivers turn comparisons around, which is wrong for NaN.
bool is_finite(vec2 v) {
  uvec2 size = floatBitsToUint(v) & 0x7FFFFFFFu;
  return size.x < 0x7F800000u && size.y < 0x7F800000u;
}

void main() {
  ivec2 size = textureSize(before, 0);
  ivec2 from = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
  vec2 motion = texelFetch(velocity, from, 0).rg;
  moved = texelFetch(before, from, 0);
  precise float x = float(from.x) + motion.x + 0.5;
  precise float y = float(from.y) + motion.y + 0.5;
  precise vec2 place = floor(vec2(x, y)) + 0.5;
  // Halves above 0 are in the order of their bits; as a float each has 18 bits that count.
  uint order = floatBitsToUint(moved.a) >> 13;
  bool is_inside =
      place.x > 0.0 && place.y > 0.0 && place.x < float(size.x) && place.y < float(size.y);
  bool goes = is_finite(motion) && moved.a > 0.0 && is_inside;
  precise vec2 corner = 2.0 * place / vec2(size) - 1.0;
  precise float depth = float(order) / 131072.0 - 1.0;
  gl_Position = goes ? vec4(corner, depth, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  gl_PointSize = 1.0;
}
