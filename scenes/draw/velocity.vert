// The vertex stage of velocity: clip x, y and w at two instants. Beside scenes/draw/velocity.cpp.
// Defined or not: CUT_OUT.
layout(location = 0) in vec3 mesh_position;
layout(location = 2) in vec2 mesh_uv;

uniform mat4 shown_to_clip;
uniform mat4 later_to_clip;
uniform mat4 earlier_to_clip;

out vec3 to;
out vec3 from;
#ifdef CUT_OUT
out vec2 uv;
#endif

vec4 transform_point(mat4 m, vec3 p) {
  precise vec4 result = ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3];
  return result;
}

void main() {
  gl_Position = transform_point(shown_to_clip, mesh_position);
  to = transform_point(later_to_clip, mesh_position).xyw;
  from = transform_point(earlier_to_clip, mesh_position).xyw;
#ifdef CUT_OUT
  uv = mesh_uv;
#endif
}
