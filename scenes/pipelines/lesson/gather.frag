#version 300 es
// Each pixel is the mean of what lies within its own circle of confusion.
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
  float own = radius_px(texelFetch(picture, here, 0).a);
  int reach = int(own);
  vec3 sum = vec3(0.0);
  float weight = 0.0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      if (float(x * x + y * y) > own * own) continue;
      sum += texelFetch(picture, clamp(here + ivec2(x, y), ivec2(0), last), 0).rgb;
      weight += 1.0;
    }
  }
  colour = vec4(sum / weight, 1.0);
}
