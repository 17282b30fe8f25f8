// A blur along a line: the first or second of a parallelogram's two passes. Beside
// dof/polygon/polygon_lines.cpp, which has the tables.
uniform sampler2D values;  // RGBA32F: colour, and in alpha the near field's opacity
uniform sampler2D sizes;   // RGBA32F: a cell's size, and what counts of it in the far field
uniform sampler2D taps;    // RGBA32F: dx, dy, share; row by row
uniform int reach;         // steps to either side
uniform int taps_a_step;
uniform float middle_a_size;
uniform float half_a_size;
uniform bool near_field;

out vec4 blurred;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(values, 0) - 1;
  int columns = textureSize(taps, 0).x;
  vec4 own = texelFetch(values, here, 0);
  if (!near_field) own.a = 0.0;
  blurred = own;
  float size = texelFetch(sizes, here, 0).r;
  if (!(size > 0.5)) return;
  precise float middle = size * middle_a_size;
  precise float half_length = size * half_a_size;
  precise float end = max(half_length, 0.5) + 0.5;
  precise float twice_inverse = 2.0 / size;
  precise vec4 sum = vec4(0.0);
  precise float weights = 0.0;
  for (int n = -reach; n <= reach; ++n) {
    precise float inside = clamp(end - abs(float(n) - middle), 0.0, 1.0);
    if (!(inside > 0.0)) continue;
    int first = (n + reach) * taps_a_step;
    for (int k = first; k < first + taps_a_step; ++k) {
      vec3 tap = texelFetch(taps, ivec2(k % columns, k / columns), 0).rgb;
      ivec2 at = clamp(here + ivec2(tap.xy), ivec2(0), last);
      vec4 value = texelFetch(values, at, 0);
      precise float weight = inside * tap.z;
      precise vec4 counted = value;
      if (!near_field) {
        precise float counts = min(texelFetch(sizes, at, 0).g * twice_inverse, 1.0);
        counted = vec4(own.rgb + counts * (value.rgb - own.rgb), 0.0);
      }
      sum = sum + weight * counted;
      weights = weights + weight;
    }
  }
  blurred = sum / weights;
}
