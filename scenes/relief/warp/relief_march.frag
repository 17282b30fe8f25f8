// Each pixel's ray followed into a relief, by slices and bisection. Beside
// scenes/relief/warp/march_relief.cpp; the numbers before they are stored as halves.
uniform sampler2D texels;   // RGBA32F: light, and the depth in metres; below 0 where nothing is
uniform sampler2D lines;    // u, v and q of each row's pixel 0
uniform sampler2D picture;  // what was there, depth in alpha
uniform vec3 along;         // u, v and q a pixel
uniform ivec2 first;
uniform ivec2 end;
uniform vec3 warp;  // k1, k2, k3
uniform float height_m;
uniform float slice_m;
uniform int slices;
uniform int bisections;
out vec4 marched;

// Of the last texel that was there.
vec4 found;

bool texel_on_ray(vec2 start, vec2 way, float depth_m) {
  precise vec2 place = start + depth_m * way + 0.5;
  ivec2 size = textureSize(texels, 0);
  if (!(place.x >= 0.0 && place.y >= 0.0 && place.x < float(size.x) && place.y < float(size.y))) {
    return false;
  }
  vec4 texel = texelFetch(texels, ivec2(place), 0);
  if (texel.a < 0.0) return false;
  found = texel;
  return true;
}

bool meets_surface(vec2 start, vec2 way) {
  bool was_before = texel_on_ray(start, way, 0.0);
  for (int slice = 1; slice <= slices; ++slice) {
    precise float behind = float(slice) * slice_m;
    precise float before = behind - slice_m;
    bool is_there = texel_on_ray(start, way, behind);
    bool is_behind = is_there && found.a <= behind;
    if (!is_behind || !(was_before || found.a >= before)) {
      was_before = is_there && !is_behind;
      continue;
    }
    vec4 nearest = found;
    for (int i = 0; i < bisections; ++i) {
      precise float middle = 0.5 * (before + behind);
      if (texel_on_ray(start, way, middle) && found.a <= middle) {
        behind = middle;
        nearest = found;
      } else {
        before = middle;
      }
    }
    found = nearest;
    return true;
  }
  return false;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  marched = texelFetch(picture, here, 0);
  found = vec4(0.0);
  if (here.x < first.x || here.y < first.y || here.x >= end.x || here.y >= end.y) return;
  vec4 line = texelFetch(lines, ivec2(0, here.y), 0);
  float x = float(here.x);
  precise float q = line.z + x * along.z;
  if (!(q > 0.0)) return;
  precise vec2 in_plane = line.xy + x * along.xy;
  precise vec2 start = in_plane / q;
  precise vec2 way = start * warp.z - warp.xy;
  if (!meets_surface(start, way)) return;
  precise float far = height_m / q * (1.0 + warp.z * found.a);
  float cut = far < 65504.0 ? far : 65504.0;
  if (!(cut < marched.a)) return;
  marched = vec4(found.rgb, cut);
}
