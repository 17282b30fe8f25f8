// First pass of bloom: the bright light, by its weight, and the weight. bloom.glsl has the rest.
#include "bloom.glsl"

uniform sampler2D source;
uniform int steady;  // 1: the brighter, the less it counts

out vec4 weighted;

void main() {
  vec3 light = bright_light(texelFetch(source, ivec2(gl_FragCoord.xy), 0));
  precise float weight = steady == 1 ? 1.0 / (1.0 + max(max(light.r, light.g), light.b)) : 1.0;
  precise vec3 share = light * weight;
  weighted = vec4(share, weight);
}
