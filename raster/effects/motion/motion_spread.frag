// First pass of motion blur: the way to either side, and 1 over its length. motion_blur.h has the
// steps.
#include "motion_blur.glsl"

uniform sampler2D velocity;
uniform float to_half;  // shutter / 2
uniform float most;     // radius

out vec4 spread;

void main() {
  vec2 px = texelFetch(velocity, ivec2(gl_FragCoord.xy), 0).xy;
  precise float x = finite_or_0(px.x) * to_half;
  precise float y = finite_or_0(px.y) * to_half;
  precise float square = x * x + y * y;
  float length = sqrt(square);
  precise float shorter = length > most ? most / length : 1.0;
  float cut = length > most ? most : length;
  precise float inverse = 1.0 / (cut > 0.5 ? cut : 0.5);
  precise vec2 v = vec2(x, y) * shorter;
  spread = vec4(v, inverse, 0.0);
}
