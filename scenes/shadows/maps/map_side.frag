// The nearness of a caster in a side of a shadow map. Blending keeps the largest. Beside
// scenes/shadows/maps/draw_map_side.cpp.
#include "doubles.glsl"
uniform usampler2D triangles;
flat in float listed;
out vec4 nearness;

void main() {
  int first = 3 * int(listed);
  dvec2 over = doubles_in(texel_of(triangles, first));
  dvec2 from = doubles_in(texel_of(triangles, first + 1));  // at the origin; the least
  double most = doubles_in(texel_of(triangles, first + 2)).x;
  precise double at_row = over.y * double(gl_FragCoord.y) + from.x;
  precise double plain = over.x * double(gl_FragCoord.x) + at_row;
  precise double raised = plain < from.y ? from.y : plain;
  precise double kept = most < raised ? most : raised;
  if (isnan(kept)) discard;
  nearness = vec4(float(kept));
}
