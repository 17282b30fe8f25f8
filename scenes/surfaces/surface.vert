// The vertex stage of a lit, perhaps textured surface. Beside scenes/surfaces/surface_stages.h.
// Defined or not: TEXTURED, SPECULAR, TWO_SIDED, CUT_OUT, PEELED.
#include "lighting.glsl"

layout(location = 0) in vec3 mesh_position;
layout(location = 1) in vec3 mesh_normal;
layout(location = 2) in vec2 mesh_uv;
layout(location = 3) in vec3 mesh_colour;  // white where the mesh has none

uniform mat4 to_clip;  // y points down, so that row 0 is the top of the picture
uniform mat4 to_world;
uniform mat3 normal_to_world;
uniform vec3 eye;

out float depth_m;
out vec3 front_base;
#ifdef SPECULAR
out vec3 front_specular;
#endif
#ifdef TWO_SIDED
out vec3 back_base;
#ifdef SPECULAR
out vec3 back_specular;
#endif
#endif
#ifdef PEELED
uniform int first_triangle;  // of the draw, in the frame
flat out int triangle;       // vertices are not shared
#endif
#if defined(TEXTURED) || defined(CUT_OUT)
out vec2 uv;
#endif

vec4 transform_point(mat4 m, vec3 p) {
  precise vec4 result = ((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3];
  return result;
}

vec3 transform_direction(mat3 m, vec3 d) {
  precise vec3 result = (m[0] * d.x + m[1] * d.y) + m[2] * d.z;
  return result;
}

void main() {
  gl_Position = transform_point(to_clip, mesh_position);
  depth_m = gl_Position.w;
  vec3 world = transform_point(to_world, mesh_position).xyz;
  vec3 normal = unit(transform_direction(normal_to_world, mesh_normal));
  precise vec3 away = eye - world;
  vec3 towards_eye = unit(away);

  LitColour front = light_point(world, normal, towards_eye);
  front_base = front.base * mesh_colour;
#ifdef SPECULAR
  front_specular = front.specular;
#endif
#ifdef TWO_SIDED
  LitColour back = light_point(world, -normal, towards_eye);
  back_base = back.base * mesh_colour;
#ifdef SPECULAR
  back_specular = back.specular;
#endif
#endif
#if defined(TEXTURED) || defined(CUT_OUT)
  uv = mesh_uv;
#endif
#ifdef PEELED
  triangle = first_triangle + gl_VertexID / 3;
#endif
}
