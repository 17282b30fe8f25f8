// Tone mapping by a quotient of polynomials. Beside raster/effects/tone_map.cpp; tone_map.h has
// the formula and the curves.
uniform sampler2D source;
uniform float exposure;
uniform vec3 numerator;    // a, b, c
uniform vec3 denominator;  // d, e, f
uniform float offset;      // g
uniform float factor;      // h

out vec4 mapped;

float curve(float light) {
  float usable = light > 0.0 ? (light < 65504.0 ? light : 65504.0) : 0.0;
  precise float x = exposure * usable;
  precise float above = x * (numerator.x * x + numerator.y) + numerator.z;
  precise float below = x * (denominator.x * x + denominator.y) + denominator.z;
  precise float value = (above / below + offset) * factor;
  return value > 0.0 ? (value < 1.0 ? value : 1.0) : 0.0;
}

void main() {
  vec4 texel = texelFetch(source, ivec2(gl_FragCoord.xy), 0);
  mapped = vec4(curve(texel.r), curve(texel.g), curve(texel.b), texel.a);
}
