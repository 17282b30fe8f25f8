// Last pass of bloom: the bright light makes way for the scattered one.
#include "bloom.glsl"

uniform sampler2D source;
uniform sampler2D scattered;
uniform float strength;

out vec4 combined;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 texel = texelFetch(source, here, 0);
  precise vec3 moved = texelFetch(scattered, here, 0).rgb - bright_light(texel);
  precise vec3 sum = texel.rgb + strength * moved;
  combined = vec4(sum, texel.a);
}
