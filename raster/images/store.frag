// Stores a texture's texels in the target's format: what the driver does to a float on
// its way into a half or a byte. Beside raster/images/texel.h.
#ifdef SAMPLES
uniform sampler2DMS values;
uniform int number;
#else
uniform sampler2D values;
const int number = 0;
#endif
out vec4 stored;

void main() { stored = texelFetch(values, ivec2(gl_FragCoord.xy), number); }
