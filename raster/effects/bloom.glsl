// The light that blooms. Beside raster/effects/bloom.cpp; bloom.h has the formula.
uniform float threshold;
uniform float begin;          // threshold - knee
uniform float double_knee;    // 2 knee
uniform float square_factor;  // 1 / (4 knee), or 0
uniform float beyond;         // what has less in alpha is not bright

float usable(float light) { return light > 0.0 ? (light < 65504.0 ? light : 65504.0) : 0.0; }

vec3 bright_light(vec4 texel) {
  vec3 light = vec3(usable(texel.r), usable(texel.g), usable(texel.b));
  float most = max(max(light.r, light.g), light.b);
  precise float above = most - begin;
  float x = above > 0.0 ? (above < double_knee ? above : double_knee) : 0.0;
  precise float soft = x * x * square_factor;
  precise float hard = most - threshold;
  float kept = hard > soft ? hard : soft;
  precise float share = most > 0.0 && !(texel.a < beyond) ? kept / most : 0.0;
  precise vec3 bright = light * share;
  return bright;
}
