// The bilateral filter. Beside raster/passes/bilateral.cpp; bilateral.h has the formula.
uniform sampler2D source;       // colour, and in alpha the depth
#ifdef TAPS                      // odd: what is known to a compiler is faster
uniform float weights[TAPS];
#else
uniform sampler2D weights;      // R32F, a row: the Gaussian
#endif
uniform float colour_factor;    // 1 / tolerance^2, or 0
uniform float depth_tolerance;  // a share of the depth, or 0

out vec4 filtered;

#ifdef TAPS
int tap_count() { return TAPS; }
float gaussian(int i) { return weights[i]; }
#else
int tap_count() { return textureSize(weights, 0).x; }
float gaussian(int i) { return texelFetch(weights, ivec2(i, 0), 0).r; }
#endif

float compared_depth(float depth) {
  return floatBitsToUint(depth) == 0x7F800000u ? 65504.0 : depth;
}

float likeness(float square) {
  precise float rest = 1.0 - square;
  return rest > 0.0 ? rest * rest : 0.0;
}

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 here = ivec2(gl_FragCoord.xy);
  int reach = tap_count() / 2;
  vec4 own = texelFetch(source, here, 0);
  float own_depth = compared_depth(own.a);
  precise float depth_scale = depth_tolerance * own_depth;
  precise vec3 sum = vec3(0.0);
  precise float sum_of_weights = 0.0;
  for (int j = -reach; j <= reach; ++j) {
    float row_weight = gaussian(reach + j);
    for (int i = -reach; i <= reach; ++i) {
      vec4 other = texelFetch(source, clamp(here + ivec2(i, j), ivec2(0), last), 0);
      precise float weight = gaussian(reach + i) * row_weight;
      if (i != 0 || j != 0) {
        precise vec3 off = other.rgb - own.rgb;
        precise float square = off.r * off.r + off.g * off.g + off.b * off.b;
        weight = weight * likeness(square * colour_factor);
        if (depth_tolerance > 0.0) {
          precise float ratio = (compared_depth(other.a) - own_depth) / depth_scale;
          weight = weight * likeness(ratio * ratio);
        }
      }
      sum = sum + weight * other.rgb;
      sum_of_weights = sum_of_weights + weight;
    }
  }
  filtered = vec4(sum / sum_of_weights, own.a);
}
