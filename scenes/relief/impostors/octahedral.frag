// Three pictures of an octahedral atlas, blended. Beside scenes/relief/impostors/octahedral_atlas.cpp; the
// numbers before they are stored as halves.
uniform sampler2D first_texels;  // RGBA32F: light, and the depth in metres; below 0 where nothing is
uniform sampler2D second_texels;
uniform sampler2D third_texels;
uniform sampler2D lines;    // two texels a picture: u, v and their slopes; q. The last row: a pixel
uniform sampler2D picture;  // what was there, depth in alpha
uniform ivec2 first;
uniform ivec2 end;
uniform vec3 heights_m;
uniform float middle_m;
uniform vec3 shares;
uniform float least_cover;
uniform int steps;
out vec4 blended;

vec4 texel_of(int number, ivec2 place) {
  if (number == 0) return texelFetch(first_texels, place, 0);
  if (number == 1) return texelFetch(second_texels, place, 0);
  return texelFetch(third_texels, place, 0);
}

int size;

bool is_within(vec2 place) {
  float last = float(size - 1);
  return place.x >= 0.0 && place.y >= 0.0 && place.x < last && place.y < last;
}

float depth_near(int number, vec2 place, float otherwise) {
  if (!is_within(place)) return otherwise;
  precise vec2 nearest = place + 0.5;
  float depth = texel_of(number, ivec2(nearest)).a;
  precise float from_middle = depth - middle_m;
  return depth < 0.0 ? otherwise : from_middle;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  blended = texelFetch(picture, here, 0);
  if (here.x < first.x || here.y < first.y || here.x >= end.x || here.y >= end.y) return;
  size = textureSize(first_texels, 0).x;
  int last_row = textureSize(lines, 0).y - 1;
  float x = float(here.x);
  precise vec3 light = vec3(0.0);
  precise float cover = 0.0;
  precise float far_sum = 0.0;
  for (int number = 0; number < 3; ++number) {
    vec4 base = texelFetch(lines, ivec2(2 * number, here.y), 0);
    vec4 pixel = texelFetch(lines, ivec2(2 * number, last_row), 0);
    float base_q = texelFetch(lines, ivec2(2 * number + 1, here.y), 0).r;
    float pixel_q = texelFetch(lines, ivec2(2 * number + 1, last_row), 0).r;
    precise float q = base_q + x * pixel_q;
    if (!(q > 0.0)) continue;
    precise float inverse = 1.0 / q;
    precise vec4 planes = (base + x * pixel) * inverse;
    float depth = 0.0;
    for (int look = 0; look < steps; ++look) {
      precise vec2 seen = planes.xy + depth * planes.zw;
      depth = depth_near(number, seen, depth);
    }
    precise vec2 place = planes.xy + depth * planes.zw;
    if (!is_within(place)) continue;
    ivec2 corner = ivec2(place);
    precise vec2 after = place - vec2(corner);
    precise vec2 before = 1.0 - after;
    precise float own_cover = 0.0;
    precise vec3 own_light = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
      vec4 texel = texel_of(number, corner + ivec2(i & 1, i >> 1));
      precise float weight =
          ((i & 1) == 1 ? after.x : before.x) * ((i >> 1) == 1 ? after.y : before.y);
      if (texel.a < 0.0) continue;
      own_cover = own_cover + weight;
      own_light = own_light + weight * texel.rgb;
    }
    precise float far = (heights_m[number] + depth_near(number, place, depth)) * inverse;
    if (!(far > 0.0)) continue;
    float share = shares[number];
    cover = cover + share * own_cover;
    light = light + share * own_light;
    precise float weighted = share * own_cover;
    far_sum = far_sum + weighted * far;
  }
  if (!(cover >= least_cover)) return;
  precise float far = far_sum / cover;
  float cut = far < 65504.0 ? far : 65504.0;
  if (!(cut < blended.a)) return;
  blended = vec4(light / cover, cut);
}
