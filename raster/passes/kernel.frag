// A filter kernel: the sum of the neighbours by a table of weights. A source larger than the target
// has a guard band around it. Beside raster/passes/kernel.cpp.
uniform sampler2D source;
#ifdef COLUMNS  // and ROWS, both odd: what is known to a compiler is faster
uniform float weights[COLUMNS * ROWS];
#else
uniform sampler2D weights;  // R32F, of the kernel's size, which is odd
#endif
uniform ivec2 guard;        // columns left and right, rows above and below

out vec4 filtered;

#ifdef COLUMNS
ivec2 kernel_size() { return ivec2(COLUMNS, ROWS); }
float weight(int i, int j) { return weights[j * COLUMNS + i]; }
#else
ivec2 kernel_size() { return textureSize(weights, 0); }
float weight(int i, int j) { return texelFetch(weights, ivec2(i, j), 0).r; }
#endif

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 extent = kernel_size();
  ivec2 here = ivec2(gl_FragCoord.xy) + guard;
  ivec2 corner = here - extent / 2;
  precise vec3 sum = vec3(0.0);
  for (int j = 0; j < extent.y; ++j) {
    for (int i = 0; i < extent.x; ++i) {
      vec3 colour = texelFetch(source, clamp(corner + ivec2(i, j), ivec2(0), last), 0).rgb;
      sum = sum + weight(i, j) * colour;
    }
  }
  filtered = vec4(sum, texelFetch(source, here, 0).a);
}
