// A picture of twice the size, mixed with another of that size. Beside raster/passes/pyramid.cpp.
// BILINEAR: one bilinear sample in place of a tent of them. ALONE: of the other its alpha only.
uniform sampler2D source;
uniform sampler2D own;
uniform float share;

out vec4 filtered;

#ifdef BILINEAR
const float kTaps[4] = float[](0.0, 0.25, 0.75, 0.0);
const int kFirst = 1;
#else
const float kTaps[4] = float[](0.0625, 0.3125, 0.4375, 0.1875);
const int kFirst = 0;
#endif

float tap(int i, int parity) { return kTaps[parity == 0 ? i : 3 - i]; }

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 parity = here & 1;
  ivec2 corner = here / 2 - 2 + parity;
  precise vec4 sum = vec4(0.0);
  for (int j = kFirst; j < 4 - kFirst; ++j) {
    for (int i = kFirst; i < 4 - kFirst; ++i) {
      float weight = tap(i, parity.x) * tap(j, parity.y);  // exact: a multiple of 1/256
      sum = sum + weight * texelFetch(source, clamp(corner + ivec2(i, j), ivec2(0), last), 0);
    }
  }
  vec4 texel = texelFetch(own, here, 0);
#ifdef ALONE
  filtered = vec4(sum.rgb, texel.a);
#else
  precise vec4 mixed = texel + share * (sum - texel);
  filtered = mixed;
#endif
}
