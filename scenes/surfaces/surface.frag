// The fragment stage of a lit, perhaps textured surface: linear colour, and the depth in
// metres in alpha. Beside scenes/surfaces/surface_stages.h. Defined or not: TEXTURED, SPECULAR,
// TWO_SIDED, CUT_OUT, BLENDED, PEELED.
//
// PEELED, after Everitt 2001: a fragment is discarded unless it lies behind the one that `layer_before` has. Depth alone
// cannot say so where several fragments have the same; the number of the triangle, counted over the
// frame, then gives the order of submission.
//
// BLENDED: the colour is multiplied by the opacity, which is in alpha in place of the depth. PEELED, the
// fragment also lies before what is opaque.
in float depth_m;
in vec3 front_base;
#ifdef SPECULAR
in vec3 front_specular;
#endif
#ifdef TWO_SIDED
in vec3 back_base;
#ifdef SPECULAR
in vec3 back_specular;
#endif
#endif
#if defined(TEXTURED) || defined(CUT_OUT)
in vec2 uv;
#endif
#ifdef TEXTURED
uniform sampler2D surface_texture;
#endif
#ifdef CUT_OUT
uniform sampler2D opacity_texture;
uniform float least_texel;
#endif
#ifdef BLENDED
uniform float surface_opacity;
uniform int cuts_out;
#ifdef PEELED
uniform sampler2D opaque_depth;
#endif
#endif

#ifdef PEELED
uniform sampler2D layer_before;  // depth and number of its fragments' triangles
flat in int triangle;            // number in the frame
layout(location = 0) out vec4 colour_and_depth;
layout(location = 1) out vec4 peeled;  // likewise of this layer
#else
out vec4 colour_and_depth;
#endif

void main() {
  precise vec3 colour = front_base;
#ifdef TWO_SIDED
  if (!gl_FrontFacing) colour = back_base;
#endif
#ifdef TEXTURED
  colour *= texture(surface_texture, uv).rgb;
#endif
#ifdef SPECULAR
#ifdef TWO_SIDED
  colour += gl_FrontFacing ? front_specular : back_specular;
#else
  colour += front_specular;
#endif
#endif
#ifdef CUT_OUT
  // Last: a texture is sampled with its neighbours in the quad.
  float red = texture(opacity_texture, uv).r;
  if (red < least_texel) discard;
#endif
#ifdef PEELED
  vec2 before = texelFetch(layer_before, ivec2(gl_FragCoord.xy), 0).rg;
  if (gl_FragCoord.z < before.r) discard;
  if (gl_FragCoord.z == before.r && float(triangle) <= before.g) discard;
#ifdef BLENDED
  if (gl_FragCoord.z >= texelFetch(opaque_depth, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  peeled = vec4(gl_FragCoord.z, float(triangle), 0.0, 0.0);
#endif
#ifdef BLENDED
  precise float hides = surface_opacity;
#ifdef CUT_OUT
  if (cuts_out == 0) hides *= red;
#endif
  colour *= hides;
  colour_and_depth = vec4(colour, hides);
#else
  colour_and_depth = vec4(colour, depth_m < 65504.0 ? depth_m : 65504.0);
#endif
}
