// Third pass of motion blur: the longest way of a tile and its eight neighbours.
#include "motion_blur.glsl"

uniform sampler2D tiles;
uniform int two_ways;  // 1: a neighbour at a corner counts only if it moves along the diagonal

out vec4 longest;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(tiles, 0);
  vec2 most = vec2(0.0);
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      ivec2 tile = at + ivec2(i, j);
      if (any(lessThan(tile, ivec2(0))) || any(greaterThanEqual(tile, size))) continue;
      vec2 v = texelFetch(tiles, tile, 0).xy;
      precise float along_diagonal = float(i * j) * v.x * v.y;
      if (i * j != 0 && two_ways == 1 && !(along_diagonal > 0.0)) continue;
      if (is_longer(v, most)) most = v;
    }
  }
  longest = vec4(most, 0.0, 0.0);
}
