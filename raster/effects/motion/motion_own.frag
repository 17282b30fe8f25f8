// The plainest motion blur: the mean along the pixel's own motion. Beside
// raster/effects/motion/motion_own.cpp.
#include "motion_blur.glsl"

uniform sampler2D source;
uniform sampler2D velocity;
uniform int samples;
uniform float way_step;  // 2 / samples
uniform float to_half;   // shutter / 2

out vec4 result;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(source, 0);
  vec4 own = texelFetch(source, at, 0);
  vec2 px = texelFetch(velocity, at, 0).xy;
  precise vec2 v = vec2(finite_or_0(px.x), finite_or_0(px.y)) * to_half;
  precise float square = v.x * v.x + v.y * v.y;
  if (!(square > 0.25)) {
    result = own;
    return;
  }
  float jittered = jitter(at);
  precise vec3 sum = vec3(0.0);
  for (int i = 0; i < samples; ++i) {
    precise vec2 moved = way_at(i, jittered, way_step) * v;
    sum += texelFetch(source, pixel_at(at, moved, size), 0).rgb;
  }
  precise vec3 mean = sum * (0.5 * way_step);
  result = vec4(mean, own.a);
}
