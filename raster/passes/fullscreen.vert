// A triangle over the whole target, without a vertex buffer: corners (-1, -1), (3, -1)
// and (-1, 3). Beside raster/passes/fullscreen_pass.h.
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
