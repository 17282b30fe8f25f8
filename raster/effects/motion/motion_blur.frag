// Last pass of motion blur: what is seen through the pixel while the shutter is open. Beside
// raster/effects/motion/motion_one_way.cpp and, with TWO_WAYS, motion_two_ways.cpp.
#include "motion_blur.glsl"

uniform sampler2D source;
uniform sampler2D spread;
uniform sampler2D tiles;
uniform int samples;
uniform float way_step;  // 2 / samples
#ifdef TWO_WAYS
uniform float sample_part;  // 1 / samples
uniform int across_samples;
uniform float across_part;
uniform float across_step;
#endif
uniform int tile_size;
uniform float inverse_depth;

out vec4 result;

// What a pixel and a sample have to do with each other.
struct Pair {
  vec4 there;
  vec3 w;
  float of_there, of_own;
  float gap;
};

Pair pair_of(ivec2 at, ivec2 size, vec4 own, vec3 v, float per_depth, float t, vec2 px,
             float length_px) {
  Pair of;
  precise vec2 step_px = t * px;
  ivec2 place = pixel_at(at, step_px, size);
  of.there = texelFetch(source, place, 0);
  of.w = texelFetch(spread, place, 0).xyz;
  precise float far = abs(t) * length_px;
  precise float of_there = far * of.w.z;
  precise float of_own = far * v.z;
  precise float gap = (compared_depth(of.there.a) - compared_depth(own.a)) * per_depth;
  of.of_there = of_there;
  of.of_own = of_own;
  of.gap = gap;
  return of;
}

vec2 neighbourhood_motion(ivec2 at, ivec2 size) {
#ifdef TWO_WAYS
  int i = int(jitter_bits(at.y, at.x) >> 16) - 128;
  int j = int(jitter_bits(at.y + 1, at.x) >> 16) - 128;
  at = clamp(at + ivec2(i * tile_size >> 9, j * tile_size >> 9), ivec2(0), size - 1);
#endif
  return texelFetch(tiles, at / tile_size, 0).xy;
}

#ifdef TWO_WAYS
float reached(float q) {
  precise float left = (1.05 - q) * 10.0;
  return cut_to_1(left);
}

// What samples along a way show through the pixel: their sum, and in w how many they are.
vec4 shown_along(ivec2 at, ivec2 size, vec4 own, vec3 v, float per_depth, vec2 px, float length_px,
                 vec2 way, float own_part, float own_reach, int count, float count_step,
                 float jittered) {
  precise vec4 shown = vec4(0.0);
  for (int i = 0; i < count; ++i) {
    float t = way_at(i, jittered, count_step);
    Pair of = pair_of(at, size, own, v, per_depth, t, px, length_px);
    precise float cosine = of.w.x * way.x + of.w.y * way.y;
    precise float there_part = abs(cosine) * of.w.z;
    float in_reach = reached(of.of_own);
    float reach = in_reach > own_reach ? in_reach : own_reach;
    precise float before = 2.0 - of.gap;
    precise float behind = 2.0 + of.gap;
    precise float either = (cut_to_1(before) * reached(of.of_there)) * there_part +
                           (cut_to_1(behind) * reach) * own_part;
    float weight = cut_to_1(either);
    if (!(weight > 0.0)) continue;
    shown.w += weight;
    shown.rgb += of.there.rgb * weight;
  }
  return shown;
}

vec3 blurred(ivec2 at, ivec2 size, vec4 own, vec3 v, float per_depth, vec2 n, float length) {
  precise float per_length = 1.0 / length;
  precise vec2 along = n * per_length;
  precise float own_square = v.x * v.x + v.y * v.y;
  precise float above_still = (sqrt(own_square) - 0.5) * (1.0 / 1.5);
  float moving = cut_to_1(above_still);
  precise float turning = v.x * n.x + v.y * n.y;
  vec2 ahead = turning < 0.0 ? -v.xy : v.xy;
  precise vec2 mixed = n + (ahead - n) * moving;
  precise float mixed_square = mixed.x * mixed.x + mixed.y * mixed.y;
  float own_length = sqrt(mixed_square);
  precise float per_own_length = 1.0 / own_length;
  precise vec2 across = mixed * per_own_length;
  precise float cosine = across.x * along.x + across.y * along.y;
  float facing = abs(cosine);

  float jittered = jitter(at);
  precise float between = jittered < 0.5 ? jittered + 0.5 : jittered - 0.5;
  precise float along_part = facing * 1.1;  // kFacing
  vec4 a = shown_along(at, size, own, v, per_depth, n, length, along, cut_to_1(along_part), 0.0,
                       samples, way_step, jittered);
  vec4 b = shown_along(at, size, own, v, per_depth, mixed, own_length, across, 1.0, moving,
                       across_samples, across_step, between);

  precise float shorter = own_length < length ? own_length * per_length : 1.0;
  precise float half_part = (facing * shorter) * 0.5;
  precise float a_part = 1.0 - half_part;
  precise float rest = a_part * (1.0 - a.w * sample_part);
  precise float b_part = half_part + rest * moving;
  precise float own_part = rest * (1.0 - moving) + b_part * (1.0 - b.w * across_part);
  precise float of_a = a_part * sample_part;
  precise float of_b = b_part * across_part;
  precise vec3 colour = a.rgb * of_a;
  if (of_b > 0.0) colour += b.rgb * of_b;
  if (own_part > 0.0) colour += own.rgb * own_part;
  return colour;
}
#else
float cylinder(float q) {
  precise float from_begin = (q - 0.95) * 10.0;
  float s = cut_to_1(from_begin);
  precise float share = 1.0 - s * s * (3.0 - 2.0 * s);
  return share;
}

float cone(float q) {
  precise float left = 1.0 - q;
  return cut_to_1(left);
}

vec3 blurred(ivec2 at, ivec2 size, vec4 own, vec3 v, float per_depth, vec2 n, float length) {
  float jittered = jitter(at);
  float total = v.z;
  precise vec3 sum = own.rgb * total;
  for (int i = 0; i < samples; ++i) {
    float t = way_at(i, jittered, way_step);
    Pair of = pair_of(at, size, own, v, per_depth, t, n, length);
    precise float before = 1.0 - of.gap;
    precise float behind = 1.0 + of.gap;
    precise float weight = (cut_to_1(before) * cone(of.of_there) +
                            cut_to_1(behind) * cone(of.of_own)) +
                           (cylinder(of.of_there) * cylinder(of.of_own)) * 2.0;
    if (!(weight > 0.0)) continue;
    precise float more = total + weight;
    total = more;
    sum += of.there.rgb * weight;
  }
  precise vec3 mean = sum / total;
  return mean;
}
#endif

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
  vec3 v = texelFetch(spread, at, 0).xyz;
  precise float per_depth = own.a > 0.0 ? inverse_depth / compared_depth(own.a) : 0.0;
  result = vec4(blurred(at, size, own, v, per_depth, n, length), own.a);
}
