// How many texels around a pixel's place in a side of a shadow map are nearer to the light. Beside
// scenes/shadows/maps/shadow_map.cpp.
#include "doubles.glsl"
uniform sampler2D nearness;
uniform usampler2D places;  // u and v in 16 bits each; the side; how near the pixel is
uniform int side;
uniform int kernel;
out vec4 blocked;

void main() {
  uvec4 place = texelFetch(places, ivec2(gl_FragCoord.xy), 0);
  if (int(place.y) != side) discard;
  double own = packDouble2x32(place.zw);
  int u = int(place.x & 0xFFFFu);
  int v = int(place.x >> 16);
  int last = textureSize(nearness, 0).x - 1;
  int reach = kernel / 2;
  float count = 0.0;
  for (int j = max(v - reach, 0); j <= min(v + reach, last); ++j) {
    for (int i = max(u - reach, 0); i <= min(u + reach, last); ++i) {
      if (double(texelFetch(nearness, ivec2(i, j), 0).x) > own) count += 1.0;
    }
  }
  blocked = vec4(count);
}
