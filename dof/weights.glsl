// The weights that the two-pass and the one-pass filter share: equations 10 to 14 of the
// thesis, after Zhou, Chen and Pullen 2007. Beside dof/weights.h, which has the formulas
// and the reasons; the order of operations here is the same.
//
// `precise` keeps a compiler from rearranging sums and products; before GLSL 4.00 define
// it away.

uniform sampler2D source;  // linear colour, and in alpha the depth in metres

// The lens: signed radius of the circle of confusion in pixels, by depth z:
// (radius_at_infinity_px * (z - focus_m)) / z
uniform float radius_at_infinity_px;
uniform float focus_m;

uniform float max_coc_px;  // larger radii are cut to this
uniform float leak;        // how readily a background gives its colour

struct FilterTexel {
  vec3 colour;
  float radius_px;
  float intensity;
  bool beyond_focus;
};

struct Gather {
  vec3 colour;
  float weight;
};

float filter_radius(float depth_m) {
  precise float radius = abs(radius_at_infinity_px * (depth_m - focus_m) / depth_m);
  return radius < max_coc_px ? radius : max_coc_px;
}

float intensity(float radius_px) {
  precise float radius = radius_px > 1.0 ? radius_px : 1.0;
  precise float result = 1.0 / (radius * radius);
  return result;
}

float overlap(float radius_px, float distance_px) {
  precise float reach = radius_px - distance_px;
  return reach > 0.0 ? (reach < 1.0 ? reach : 1.0) : 0.0;
}

float leakage(float receiver_radius_px) {
  precise float share = leak * receiver_radius_px;
  return share < 1.0 ? share : 1.0;
}

FilterTexel filter_texel(vec4 texel) {
  float radius = filter_radius(texel.a);
  return FilterTexel(texel.rgb, radius, intensity(radius), texel.a > focus_m);
}

// The nearest texel of the picture: its edges repeat outwards.
vec4 fetch(ivec2 at) { return texelFetch(source, clamp(at, ivec2(0), textureSize(source, 0) - 1), 0); }

Gather begin_gather(FilterTexel centre) {
  precise vec3 colour = centre.colour * centre.intensity;
  return Gather(colour, centre.intensity);
}

// A neighbour of weight 0 is left out, not added as 0 * colour, so that an infinite or
// NaN pixel harms what its own circle covers and nothing else.
void add_neighbour(inout Gather gather, ivec2 at, float distance_px, float receiver_leakage) {
  FilterTexel p = filter_texel(fetch(at));
  precise float weight = (overlap(p.radius_px, distance_px) * p.intensity) *
                         (p.beyond_focus ? receiver_leakage : 1.0);
  if (!(weight > 0.0)) return;
  precise vec3 colour = gather.colour + p.colour * weight;
  precise float sum = gather.weight + weight;
  gather = Gather(colour, sum);
}

// Into what a half holds; NaN stays NaN. Not as in weights.h, by two comparisons with a limit:
// Mesa makes min and max of those, which lose NaN.
float clamp_to_half(float value) {
  return abs(value) > 65504.0 ? (value > 0.0 ? 65504.0 : -65504.0) : value;
}

vec3 resolve(Gather gather) {
  precise vec3 colour = gather.colour / gather.weight;
  return vec3(clamp_to_half(colour.r), clamp_to_half(colour.g), clamp_to_half(colour.b));
}
