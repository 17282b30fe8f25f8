// A picture of half the size, rounded up. Beside raster/passes/pyramid.cpp, which says what order
// the sum has.
uniform sampler2D source;

out vec4 filtered;

const float kEven[6] = float[](0.125, 0.125, 0.25, 0.25, 0.125, 0.125);
const float kOdd[6] = float[](0.0, 0.25, 0.25, 0.25, 0.25, 0.0);

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 corner = 2 * ivec2(gl_FragCoord.xy) - 2;
  precise vec4 sum = vec4(0.0);
  for (int j = 0; j < 6; ++j) {
    for (int parity = 0; parity < 2; ++parity) {
      for (int i = parity; i < 6; i += 2) {
        // Exact: a multiple of 1/128.
        float weight = 0.5 * (kEven[i] * kEven[j] + kOdd[i] * kOdd[j]);
        sum = sum + weight * texelFetch(source, clamp(corner + ivec2(i, j), ivec2(0), last), 0);
      }
    }
  }
  filtered = sum;
}
