// Samples a texture where another says: (u, v, level of detail, unused) a pixel.
// Beside raster/images/sampler.h.
uniform sampler2D picture;
uniform sampler2D coordinates;
out vec4 colour;

void main() {
  vec4 at = texelFetch(coordinates, ivec2(gl_FragCoord.xy), 0);
  colour = textureLod(picture, at.xy, at.z);
}
