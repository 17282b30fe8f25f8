// A triangle over the whole target, without a vertex buffer: corners (-1, -1), (3, -1)
// and (-1, 3). Beside raster/passes/fullscreen_pass.h. With AS_QUAD a strip of two, as programs
// often have it, to measure what its diagonal costs.
void main() {
#ifdef AS_QUAD
  gl_Position = vec4(float(gl_VertexID & 1), float(gl_VertexID >> 1), 0.5, 1.0) * 2.0 - 1.0;
#else
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
#endif
}
