// One pass of the two-pass filter (Zhou, Chen and Pullen 2007): run with direction (1, 0)
// on the picture, then with (0, 1) on the result, both times into RGBA16F. Beside
// dof/two_pass/two_pass.cpp.
#include "weights.glsl"

uniform ivec2 direction;
uniform int taps;  // to each side: the whole numbers below max_coc_px

out vec4 filtered;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 texel = fetch(here);
  FilterTexel centre = filter_texel(texel);
  float receiver_leakage = leakage(centre.radius_px);
  Gather gather = begin_gather(centre);
  for (int d = 1; d <= taps; ++d) {
    add_neighbour(gather, here - d * direction, float(d), receiver_leakage);
    add_neighbour(gather, here + d * direction, float(d), receiver_leakage);
  }
  filtered = vec4(resolve(gather), texel.a);
}
