#version 300 es
// Each pixel asks its neighbours whether their circles reach it, and for the light that such a
// circle gives to one pixel. What lies behind the pixel spreads no farther than the pixel does.
precision highp float;
precision highp sampler2D;

uniform sampler2D picture;  // light, and in alpha the depth in metres
uniform float radius_at_infinity_px, focus_m, max_coc_px;
out vec4 colour;

float radius_px(float depth_m) {
  return min(abs(radius_at_infinity_px * (depth_m - focus_m) / depth_m), max_coc_px);
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(picture, 0) - 1;
  float depth_m = texelFetch(picture, here, 0).a;
  float own = radius_px(depth_m);
  int reach = int(max_coc_px);
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      vec4 texel = texelFetch(picture, clamp(here + ivec2(x, y), ivec2(0), last), 0);
      float theirs = radius_px(texel.a);
      if (texel.a > depth_m) theirs = min(theirs, own);
      if (float(x * x + y * y) > theirs * theirs) continue;
      float share = 1.0 / max(theirs * theirs, 1.0);
      sum += texel.rgb * share;
      weight += share;
    }
  }
  colour = vec4(sum / weight, 1.0);
}
