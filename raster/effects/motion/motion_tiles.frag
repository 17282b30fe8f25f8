// Second pass of motion blur: a pixel for each tile, the longest way in it.
#include "motion_blur.glsl"

uniform sampler2D spread;
uniform int tile_size;

out vec4 longest;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * tile_size;
  ivec2 end = min(first + tile_size, textureSize(spread, 0));
  vec2 most = vec2(0.0);
  for (int y = first.y; y < end.y; ++y) {
    for (int x = first.x; x < end.x; ++x) {
      vec2 v = texelFetch(spread, ivec2(x, y), 0).xy;
      if (is_longer(v, most)) most = v;
    }
  }
  longest = vec4(most, 0.0, 0.0);
}
