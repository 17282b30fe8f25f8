// The depth of the frame in place of a count of frames. Beside put_depths() in
// raster/temporal/reproject.cpp.
uniform sampler2D drawn;  // the frame, its depth in alpha
uniform sampler2D found;  // reprojected, and in alpha of how many frames; 0: none

out vec4 result;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  result = texelFetch(found, here, 0);
  if (result.a > 0.0) result.a = texelFetch(drawn, here, 0).a;
}
