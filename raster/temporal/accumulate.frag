// The running average of frames. Beside raster/temporal/accumulate.cpp; accumulate.h has the
// formula.
uniform sampler2D now;  // the frame, its depth in alpha
uniform sampler2D old;  // reprojected, and in alpha of how many frames; 0: none
uniform int box;        // 0: none, 1: extent, 2: variance
uniform float deviations;
uniform float least_share;
uniform float samples;  // 9: as a constant a driver might divide by it in another way

layout(location = 0) out vec4 average;
layout(location = 1) out vec4 frames;

vec3 apart(vec3 colour) {
  precise float sides = (colour.r + colour.b) * 0.25;
  precise float middle = colour.g * 0.5;
  precise float brightness = sides + middle;
  precise float orange = (colour.r - colour.b) * 0.5;
  precise float green = middle - sides;
  return vec3(brightness, orange, green);
}

vec3 together(vec3 v) {
  precise float rest = v.x - v.z;
  precise float red = rest + v.y;
  precise float green = v.x + v.z;
  precise float blue = rest - v.y;
  return vec3(red, green, blue);
}

float cut(float value, float low, float high) {
  return value < low ? low : (value > high ? high : value);
}

vec3 cut_to_box(vec3 colour, ivec2 here, ivec2 last) {
  vec3 least = apart(texelFetch(now, clamp(here - 1, ivec2(0), last), 0).rgb);
  vec3 most = least;
  precise vec3 sum = vec3(0.0);
  precise vec3 squares = vec3(0.0);
  for (int j = -1; j <= 1; ++j) {
    for (int i = -1; i <= 1; ++i) {
      vec3 other = apart(texelFetch(now, clamp(here + ivec2(i, j), ivec2(0), last), 0).rgb);
      for (int c = 0; c < 3; ++c) {
        least[c] = other[c] < least[c] ? other[c] : least[c];
        most[c] = other[c] > most[c] ? other[c] : most[c];
      }
      sum = sum + other;
      squares = squares + other * other;
    }
  }
  if (box == 2) {
    precise vec3 mean = sum / samples;
    precise vec3 variance = squares / samples - mean * mean;
    for (int c = 0; c < 3; ++c) variance[c] = variance[c] > 0.0 ? variance[c] : 0.0;
    precise vec3 reach = deviations * sqrt(variance);
    precise vec3 low = mean - reach;
    precise vec3 high = mean + reach;
    least = low;
    most = high;
  }
  vec3 own = apart(colour);
  vec3 inside = vec3(cut(own.x, least.x, most.x), cut(own.y, least.y, most.y),
                     cut(own.z, least.z, most.z));
  return inside.x != own.x || inside.y != own.y || inside.z != own.z ? together(inside) : colour;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(now, 0) - 1;
  vec4 fresh = texelFetch(now, here, 0);
  vec4 found = texelFetch(old, here, 0);
  average = fresh;
  frames = vec4(1.0, 0.0, 0.0, 1.0);
  precise float light = abs(found.r) + abs(found.g) + abs(found.b);
  if (!(found.a > 0.0 && light < 262144.0)) return;
  vec3 kept = box == 0 ? found.rgb : cut_to_box(found.rgb, here, last);
  precise float count = found.a + 1.0;
  precise float mean_share = 1.0 / count;
  float share = mean_share > least_share ? mean_share : least_share;
  precise vec3 mixed = kept + share * (fresh.rgb - kept);
  average = vec4(mixed, fresh.a);
  frames.r = count < 1024.0 ? count : 1024.0;
}
