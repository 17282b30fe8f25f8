// Pictures of the light, scaled about a point: ghosts and rays of a lens flare. Beside
// raster/effects/lens_flare.cpp; lens_flare.h has the formula.
uniform sampler2D source;
uniform sampler2D own;
uniform sampler2D copies;  // R32F, a row each: scale, colour
uniform vec4 anchor_and_fade;

out vec4 sum;

float light_at(ivec2 pixel, int channel) {
  bool is_outside = any(lessThan(pixel, ivec2(0))) ||
                    any(greaterThanEqual(pixel, textureSize(source, 0)));
  return is_outside ? 0.0 : texelFetch(source, pixel, 0)[channel];
}

float number(int copy, int column) { return texelFetch(copies, ivec2(column, copy), 0).r; }

void main() {
  vec2 size = vec2(textureSize(source, 0));
  vec2 anchor = anchor_and_fade.xy;
  vec2 middle = gl_FragCoord.xy;
  sum = texelFetch(own, ivec2(gl_FragCoord.xy), 0);
  for (int k = 0; k < textureSize(copies, 0).y; ++k) {
    for (int channel = 0; channel < 3; ++channel) {
      precise vec2 at = anchor + number(k, channel) * (middle - anchor);
      precise vec2 edge = min(at, size - at) * anchor_and_fade.zw;
      vec2 fade = min(max(edge, 0.0), 1.0);
      precise vec2 place = at - 0.5;
      vec2 whole = floor(place);
      precise vec2 share = place - whole;
      ivec2 first = ivec2(whole);
      float a = light_at(first, channel);
      float b = light_at(first + ivec2(1, 0), channel);
      float c = light_at(first + ivec2(0, 1), channel);
      float d = light_at(first + ivec2(1, 1), channel);
      precise float above = a + share.x * (b - a);
      precise float below = c + share.x * (d - c);
      precise float light = above + share.y * (below - above);
      precise float kept = fade.x * fade.y;
      precise float next = sum[channel] + number(k, 3 + channel) * kept * light;
      sum[channel] = next;
    }
  }
}
