// What a face of a shadow volume adds to a pixel's count. Blending adds up. Beside
// scenes/shadows/volumes/volume_mask.cpp, which has the equations.
#include "doubles.glsl"
uniform usampler2D faces;    // corners (x, y, w); their W in bits; how often it counts
uniform usampler2D samples;  // x and y, then q = 1 / w, of each pixel
flat in float listed;
out vec4 count;

dvec3 edge_between(dvec3 a, dvec3 b) {
  precise dvec3 edge = dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  return edge;
}

double at_sample(dvec3 edge, dvec2 at) {
  precise double value = (edge.x * at.x + edge.y * at.y) + edge.z;
  return value;
}

// A sample on an edge is on the side to which a step to the right, or else down, leads.
bool is_inside(dvec3 edge, double value) {
  bool owns = edge.x > 0.0 || (edge.x == 0.0 && edge.y > 0.0);
  return owns ? value >= 0.0 : value > 0.0;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  double q = packDouble2x32(texelFetch(samples, ivec2(2 * pixel.x + 1, pixel.y), 0).xy);
  if (q == 0.0) discard;
  dvec2 at = doubles_in(texelFetch(samples, ivec2(2 * pixel.x, pixel.y), 0));

  int first = 5 * int(listed);
  dvec2 a_xy = doubles_in(texel_of(faces, first));
  dvec2 a_w_b_x = doubles_in(texel_of(faces, first + 1));
  dvec2 b_yw = doubles_in(texel_of(faces, first + 2));
  dvec2 c_xy = doubles_in(texel_of(faces, first + 3));
  uvec4 last = texel_of(faces, first + 4);
  dvec3 a = dvec3(a_xy, a_w_b_x.x);
  dvec3 b = dvec3(a_w_b_x.y, b_yw);
  dvec3 c = dvec3(c_xy, packDouble2x32(last.xy));

  dvec3 bc = edge_between(b, c);
  dvec3 ca = edge_between(c, a);
  dvec3 ab = edge_between(a, b);
  if (bc == dvec3(0.0) || ca == dvec3(0.0) || ab == dvec3(0.0)) discard;
  double of_a = at_sample(bc, at);
  double of_b = at_sample(ca, at);
  double of_c = at_sample(ab, at);
  bool in_a = is_inside(bc, of_a);
  if (in_a != is_inside(ca, of_b) || in_a != is_inside(ab, of_c)) discard;

  precise double of_w = (of_a * a.z + of_b * b.z) + of_c * c.z;
  precise double finite = (of_a * double(last.z & 1u) + of_b * double(last.z >> 1 & 1u)) +
                          of_c * double(last.z >> 2);
  precise double beyond = q * of_w - finite;
#ifdef Z_PASS
  bool counts = in_a ? of_w > 0.0 && !(beyond > 0.0) : of_w < 0.0 && !(beyond < 0.0);
#else
  bool counts = in_a ? beyond > 0.0 : beyond < 0.0;
#endif
  if (!counts) discard;
  count = vec4(float(in_a ? int(last.w) : -int(last.w)));
}
