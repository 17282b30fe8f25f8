// Each kind of attribute as it comes to the pixel. Beside raster/pipeline/interpolate.h.
#ifndef PLACE
#define PLACE
#endif
smooth PLACE in vec4 with_perspective;
noperspective PLACE in vec4 in_window;
flat in vec4 constant;
layout(location = 0) out vec4 perspective_value;
layout(location = 1) out vec4 linear_value;
layout(location = 2) out vec4 flat_value;

void main() {
  perspective_value = with_perspective;
  linear_value = in_window;
  flat_value = constant;
}
