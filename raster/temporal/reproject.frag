// Where each pixel's surface was in the frame before. Beside raster/temporal/reproject.cpp;
// reproject.h has the formula.
uniform sampler2D depths;    // the frame's depth in alpha
uniform sampler2D velocity;  // pixels, x right, y down: now less before
uniform sampler2D before;    // colour, depth in alpha
uniform sampler2D frames;    // R32F: of how many frames `before` is made
uniform float depth_tolerance;
uniform int reach;  // 1: takes neighbours
uniform int cubic;  // 1: places between pixels are read by a cubic curve

out vec4 found;

// Of the pixel before a place, the two beside it and the one behind.
vec4 cubic_weights(float s) {
  precise float before_it = s * (s * (1.0 - s * 0.5) - 0.5);
  precise float first = s * s * (s * 1.5 - 2.5) + 1.0;
  precise float second = s * (s * (2.0 - s * 1.5) + 0.5);
  precise float behind_it = s * s * (s * 0.5 - 0.5);
  return vec4(before_it, first, second, behind_it);
}

float compared_depth(float depth) {
  return floatBitsToUint(depth) == 0x7F800000u ? 65504.0 : depth;
}

// In bits: drivers turn comparisons around, which is wrong for NaN.
bool is_finite(vec2 v) {
  uvec2 size = floatBitsToUint(v) & 0x7FFFFFFFu;
  return size.x < 0x7F800000u && size.y < 0x7F800000u;
}

void main() {
  ivec2 last = textureSize(depths, 0) - 1;
  ivec2 here = ivec2(gl_FragCoord.xy);
  float own = compared_depth(texelFetch(depths, here, 0).a);
  float nearest = own, least = own, most = own;
  ivec2 of_motion = here;
  if (reach > 0) {
    ivec2 first = clamp(here - 1, ivec2(0), last);
    of_motion = first;
    nearest = compared_depth(texelFetch(depths, first, 0).a);
    least = nearest;
    most = nearest;
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) {
        ivec2 place = clamp(here + ivec2(i, j), ivec2(0), last);
        float depth = compared_depth(texelFetch(depths, place, 0).a);
        if (depth < least) {
          least = depth;
          of_motion = place;
        }
        most = depth > most ? depth : most;
      }
    }
  }
  precise float low = least - depth_tolerance * least;
  precise float high = most + depth_tolerance * most;
  vec2 motion = texelFetch(velocity, of_motion, 0).rg;
  precise float u = float(here.x) - motion.x;
  precise float v = float(here.y) - motion.y;
  found = vec4(0.0);
  bool is_inside = u > -1.0 && v > -1.0 && u < float(last.x + 1) && v < float(last.y + 1);
  if (!is_finite(motion) || !is_inside) return;
  float column = floor(u), line = floor(v);
  precise float s = u - column;
  precise float t = v - line;
  precise vec4 sum = vec4(0.0);
  precise float sum_of_weights = 0.0;
  for (int tap = 0; tap < 4; ++tap) {
    int i = tap % 2, j = tap / 2;
    precise float weight_x = i == 1 ? s : 1.0 - s;
    precise float weight_y = j == 1 ? t : 1.0 - t;
    precise float weight = weight_x * weight_y;
    ivec2 place = ivec2(int(column) + i, int(line) + j);
    ivec2 inside = clamp(place, ivec2(0), last);
    vec4 texel = texelFetch(before, inside, 0);
    float depth = compared_depth(texel.a);
    if (place == inside && weight > 0.0 && depth >= low && depth <= high) {
      sum = sum + weight * vec4(texel.rgb, texelFetch(frames, inside, 0).r);
      sum_of_weights = sum_of_weights + weight;
    }
  }
  if (sum_of_weights > 0.0) found = sum / sum_of_weights;
  if (cubic == 0 || !(s > 0.0 || t > 0.0)) return;
  vec4 of_columns = cubic_weights(s), of_rows = cubic_weights(t);
  precise vec3 curve = vec3(0.0);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      ivec2 place = ivec2(int(column) + i - 1, int(line) + j - 1);
      vec4 texel = texelFetch(before, clamp(place, ivec2(0), last), 0);
      float depth = compared_depth(texel.a);
      bool fits = depth >= low && depth <= high;
      if (place != clamp(place, ivec2(0), last) || !fits) return;
      precise float weight = of_columns[i] * of_rows[j];
      curve = curve + weight * texel.rgb;
    }
  }
  for (int c = 0; c < 3; ++c) found[c] = curve[c] > 0.0 ? curve[c] : 0.0;
}
