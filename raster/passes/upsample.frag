// A picture of twice the size, mixed with another of that size. Beside raster/passes/pyramid.cpp.
uniform sampler2D source;
uniform sampler2D own;
uniform float share;

out vec4 filtered;

const float kTent[4] = float[](0.0625, 0.3125, 0.4375, 0.1875);

float tent(int i, int parity) { return kTent[parity == 0 ? i : 3 - i]; }

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 parity = here & 1;
  ivec2 corner = here / 2 - 2 + parity;
  precise vec4 sum = vec4(0.0);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      float weight = tent(i, parity.x) * tent(j, parity.y);  // exact: a multiple of 1/256
      sum = sum + weight * texelFetch(source, clamp(corner + ivec2(i, j), ivec2(0), last), 0);
    }
  }
  vec4 texel = texelFetch(own, here, 0);
  precise vec4 mixed = texel + share * (sum - texel);
  filtered = mixed;
}
