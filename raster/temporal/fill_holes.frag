// Holes of a forward reprojection take the farthest of the nearest pixels along four ways. Beside
// raster/temporal/forward_reproject.cpp.
uniform sampler2D scattered;  // depth in alpha, 0 in holes
uniform int reach;

out vec4 filled;

void main() {
  ivec2 size = textureSize(scattered, 0);
  ivec2 here = ivec2(gl_FragCoord.xy);
  filled = texelFetch(scattered, here, 0);
  if (filled.a > 0.0) return;
  for (int way = 0; way < 4; ++way) {
    int sign = way % 2 == 0 ? -1 : 1;
    ivec2 step = way < 2 ? ivec2(sign, 0) : ivec2(0, sign);
    for (int i = 1; i <= reach; ++i) {
      ivec2 place = here + i * step;
      if (place.x < 0 || place.y < 0 || place.x >= size.x || place.y >= size.y) break;
      vec4 texel = texelFetch(scattered, place, 0);
      if (texel.a > 0.0) {
        if (texel.a > filled.a) filled = texel;
        break;
      }
    }
  }
}
