// What a driver's shaders make of a * b + c: one rounding or two, and subnormals kept or
// not. With PRECISE defined the compiler is told not to rearrange. Beside
// raster/numbers/lerp.h.
uniform sampler2D first;
uniform sampler2D second;
uniform sampler2D third;
out vec4 result;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 a = texelFetch(first, here, 0);
  vec4 b = texelFetch(second, here, 0);
  vec4 c = texelFetch(third, here, 0);
#ifdef PRECISE
  precise vec4 sum = a * b + c;
#else
  vec4 sum = a * b + c;
#endif
  result = sum;
}
