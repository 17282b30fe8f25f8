// The fragment stage of a lit, perhaps textured surface: linear colour, and the depth in
// metres in alpha. Beside scenes/draw/surface_stages.h. Defined or not: TEXTURED, SPECULAR,
// TWO_SIDED.
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
#ifdef TEXTURED
in vec2 uv;
uniform sampler2D surface_texture;
#endif

out vec4 colour_and_depth;

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
  colour_and_depth = vec4(colour, depth_m < 65504.0 ? depth_m : 65504.0);
}
