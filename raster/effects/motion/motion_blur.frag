// Last pass of motion blur: what is seen through the pixel while the shutter is open. Beside
// raster/effects/motion/motion_blur.cpp. Defined or not: TWO_WAYS.
#include "motion_blur.glsl"

uniform sampler2D source;
uniform sampler2D spread;
uniform sampler2D tiles;
uniform int samples;
uniform float way_step;  // 2 / samples
uniform int tile_size;
uniform float inverse_depth;
uniform float own_weight;

out vec4 result;

float cylinder(float q) {
  precise float from_begin = (q - 0.95) * 10.0;
  float s = cut_to_1(from_begin);
  precise float share = 1.0 - s * s * (3.0 - 2.0 * s);
  return share;
}

vec2 neighbourhood_motion(ivec2 at, ivec2 size) {
#ifdef TWO_WAYS
  int i = int(jitter_bits(at.y, at.x) >> 16) - 128;
  int j = int(jitter_bits(at.y + 1, at.x) >> 16) - 128;
  at = clamp(at + ivec2(i * tile_size >> 9, j * tile_size >> 9), ivec2(0), size - 1);
#endif
  return texelFetch(tiles, at / tile_size, 0).xy;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(source, 0);
  vec4 own = texelFetch(source, at, 0);
  vec2 n = neighbourhood_motion(at, size);
  precise float square = n.x * n.x + n.y * n.y;
  if (!(square > 0.25)) {
    result = own;
    return;
  }
  float length = sqrt(square);
  precise vec2 along = n / length;
  vec3 v = texelFetch(spread, at, 0).xyz;

  vec2 across = along;
  float facing = 1.0;
#ifdef TWO_WAYS
  precise float turning = v.y * along.x - v.x * along.y;
  vec2 right = turning < 0.0 ? vec2(along.y, -along.x) : vec2(-along.y, along.x);
  precise float own_square = v.x * v.x + v.y * v.y;
  precise float own_share = (sqrt(own_square) - 0.5) * (1.0 / 1.5);
  float share = cut_to_1(own_share);
  precise vec2 mixed = right + (v.xy * v.z - right) * share;
  precise float mixed_square = mixed.x * mixed.x + mixed.y * mixed.y;
  precise vec2 unit_across = mixed / sqrt(mixed_square);
  across = unit_across;
  precise float cosine = across.x * along.x + across.y * along.y;
  facing = abs(cosine);
#endif

  precise float per_depth = own.a > 0.0 ? inverse_depth / own.a : 0.0;
  float jittered = jitter(at);
  precise float total = v.z * own_weight;
  precise vec3 sum = own.rgb * total;
  for (int i = 0; i < samples; ++i) {
    bool is_across = i % 2 != 0;
    vec2 way = is_across ? across : along;
    precise float moved = way_at(i, jittered, way_step) * length;
    precise vec2 step_px = moved * way;
    ivec2 place = pixel_at(at, step_px, size);
    vec4 there = texelFetch(source, place, 0);
    vec3 w = texelFetch(spread, place, 0).xyz;
    float far = abs(moved);
    precise float of_there = far * w.z;
    precise float of_own = far * v.z;
    precise float before = 1.0 - (there.a - own.a) * per_depth;
    precise float behind = 1.0 - (own.a - there.a) * per_depth;
    float nearer = cut_to_1(before);
    float farther = cut_to_1(behind);
    precise float left_there = 1.0 - of_there;
    precise float left_own = 1.0 - of_own;
    float cone_there = cut_to_1(left_there);
    float cone_own = cut_to_1(left_own);
#ifdef TWO_WAYS
    float own_way = is_across ? 1.0 : facing;
    precise float cosine_there = w.x * way.x + w.y * way.y;
    precise float there_way = abs(cosine_there) * w.z;
    float of_both = of_there > of_own ? of_there : of_own;
    float either_way = there_way > own_way ? there_way : own_way;
    precise float weight = ((nearer * cone_there) * there_way + (farther * cone_own) * own_way) +
                           (cylinder(of_both) * either_way) * 2.0;
#else
    precise float weight = (nearer * cone_there + farther * cone_own) +
                           (cylinder(of_there) * cylinder(of_own)) * 2.0;
#endif
    if (!(weight > 0.0)) continue;
    total += weight;
    sum += there.rgb * weight;
  }
  precise vec3 mean = sum / total;
  result = vec4(mean, own.a);
}
