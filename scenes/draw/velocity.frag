// The fragment stage of velocity. Beside scenes/draw/velocity.cpp. Defined or not: CUT_OUT.
#include "motion.glsl"

in vec3 to;
in vec3 from;
uniform vec2 half_size_px;
uniform float least_w;
#ifdef CUT_OUT
in vec2 uv;
uniform sampler2D opacity_texture;
uniform float least_texel;
#endif

out vec4 velocity;

void main() {
#ifdef CUT_OUT
  if (texture(opacity_texture, uv).r < least_texel) discard;
#endif
  velocity = vec4(motion_px(to, from, half_size_px, least_w), 0.0, 1.0);
}
