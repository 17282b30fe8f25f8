// First pass of the tiled filters: the largest radius in each row of a tile. Drawn into R32F, as
// wide as there are tiles in a row and as high as the picture. tile_reach.frag is the second.
#include "weights.glsl"

uniform int tile_px;  // the side of a tile

out vec4 row_radius;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  float largest = 0.0;
  for (int i = 0; i < tile_px; ++i) {
    float radius = filter_radius(fetch(ivec2(here.x * tile_px + i, here.y)).a);
    largest = radius > largest ? radius : largest;
  }
  row_radius = vec4(largest);
}
