// A filter kernel: the sum of the neighbours by a table of weights. A source larger than the target
// has a guard band around it. Beside raster/passes/kernel.cpp.
uniform sampler2D source;
uniform sampler2D weights;  // R32F, of the kernel's size, which is odd
uniform ivec2 guard;        // columns left and right, rows above and below

out vec4 filtered;

void main() {
  ivec2 last = textureSize(source, 0) - 1;
  ivec2 extent = textureSize(weights, 0);
  ivec2 here = ivec2(gl_FragCoord.xy) + guard;
  ivec2 corner = here - extent / 2;
  precise vec3 sum = vec3(0.0);
  for (int j = 0; j < extent.y; ++j) {
    for (int i = 0; i < extent.x; ++i) {
      vec3 colour = texelFetch(source, clamp(corner + ivec2(i, j), ivec2(0), last), 0).rgb;
      sum = sum + texelFetch(weights, ivec2(i, j), 0).r * colour;
    }
  }
  filtered = vec4(sum, texelFetch(source, here, 0).a);
}
