// The one-pass filter with the bits of one_pass.frag, for pictures of which much is in focus: a
// tile's rings go only as far as the circles that reach it.
#include "weights.glsl"

uniform sampler2D ring_taps;
uniform int taps;
uniform sampler2D tile_reach;  // what tile_reach.frag made
uniform int tile_px;

out vec4 filtered;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 texel = fetch(here);
  FilterTexel centre = filter_texel(texel);
  float receiver_leakage = leakage(centre.radius_px);
  Gather gather = begin_gather(centre);
  float reach = texelFetch(tile_reach, here / tile_px, 0).b;
  int columns = textureSize(ring_taps, 0).x;
  for (int i = 0; i < taps; ++i) {
    vec4 tap = texelFetch(ring_taps, ivec2(i % columns, i / columns), 0);
    // Distances within a ring differ by less than a pixel, so all that follow are past the reach.
    if (tap.z >= reach + 1.0) break;
    add_neighbour(gather, here + ivec2(tap.xy), tap.z, receiver_leakage);
  }
  filtered = vec4(resolve(gather), texel.a);
}
