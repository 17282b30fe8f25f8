// Triangles in clip space, and what each adds to the pixels that it covers. Beside
// raster/pipeline/draw.h.
layout(location = 0) in vec4 position;
layout(location = 1) in float amount;
flat out float count;

void main() {
  gl_Position = position;
  count = amount;
}
