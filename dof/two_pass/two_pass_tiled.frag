// One pass of the two-pass filter with the bits of two_pass.frag, for pictures of which much is in
// focus: a tile's taps go only as far as the circles that reach it.
#include "weights.glsl"

uniform ivec2 direction;
uniform sampler2D tile_reach;  // what tile_reach.frag made of the picture, for both passes
uniform int tile_px;

out vec4 filtered;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 texel = fetch(here);
  FilterTexel centre = filter_texel(texel);
  float receiver_leakage = leakage(centre.radius_px);
  Gather gather = begin_gather(centre);
  vec4 reach = texelFetch(tile_reach, here / tile_px, 0);
  int taps = int(ceil(direction.x != 0 ? reach.x : reach.y)) - 1;
  for (int d = 1; d <= taps; ++d) {
    add_neighbour(gather, here - d * direction, float(d), receiver_leakage);
    add_neighbour(gather, here + d * direction, float(d), receiver_leakage);
  }
  filtered = vec4(resolve(gather), texel.a);
}
