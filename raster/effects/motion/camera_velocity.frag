// How a still scene moves in the picture between two cameras. Beside raster/effects/motion/camera_velocity.cpp.
#include "motion.glsl"

uniform sampler2D source;  // depth in metres in alpha
uniform mat3 to_turn;
uniform vec3 to_shift;
uniform mat3 from_turn;
uniform vec3 from_shift;
uniform vec2 pixel;  // 2 over the picture's size
uniform vec2 half_size_px;
uniform float near_m;
uniform float background_m;

out vec4 velocity;

vec3 seen(mat3 turn, vec3 shift, vec2 at, float inverse) {
  precise vec3 clip = ((turn[0] * at.x + turn[2]) + turn[1] * at.y) + shift * inverse;
  return clip;
}

void main() {
  float depth_m = texelFetch(source, ivec2(gl_FragCoord.xy), 0).a;
  precise float inverse = depth_m > 0.0 && depth_m < background_m ? 1.0 / depth_m : 0.0;
  precise float least_inverse = 1.0 / background_m;
  precise float least_w = near_m * (inverse > least_inverse ? inverse : least_inverse);
  precise vec2 scaled = (vec2(ivec2(gl_FragCoord.xy)) + vec2(0.5)) * pixel;
  precise vec2 at = scaled - vec2(1.0);
  velocity = vec4(motion_px(seen(to_turn, to_shift, at, inverse),
                            seen(from_turn, from_shift, at, inverse), half_size_px, least_w),
                  0.0, 1.0);
}
