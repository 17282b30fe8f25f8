// Triangles in clip space with an attribute of each kind of interpolation; PLACE is `centroid` or
// nothing. Beside raster/pipeline/interpolate.h.
layout(location = 0) in vec4 position;
layout(location = 1) in vec4 perspective_value;
layout(location = 2) in vec4 linear_value;
layout(location = 3) in vec4 flat_value;
#ifndef PLACE
#define PLACE
#endif
smooth PLACE out vec4 with_perspective;
noperspective PLACE out vec4 in_window;
flat out vec4 constant;

void main() {
  gl_Position = position;
  with_perspective = perspective_value;
  in_window = linear_value;
  constant = flat_value;
}
