// The one-pass filter over rings (the thesis, 5.1). Beside dof/one_pass/one_pass.cpp, whose
// ring_taps() fills the texture of taps: row by row, each (dx, dy, distance, unused).
#include "weights.glsl"

uniform sampler2D ring_taps;
uniform int taps;

out vec4 filtered;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 texel = fetch(here);
  FilterTexel centre = filter_texel(texel);
  float receiver_leakage = leakage(centre.radius_px);
  Gather gather = begin_gather(centre);
  int columns = textureSize(ring_taps, 0).x;
  for (int i = 0; i < taps; ++i) {
    vec4 tap = texelFetch(ring_taps, ivec2(i % columns, i / columns), 0);
    add_neighbour(gather, here + ivec2(tap.xy), tap.z, receiver_leakage);
  }
  filtered = vec4(resolve(gather), texel.a);
}
