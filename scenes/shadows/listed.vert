// Flat shapes of a list: where they are, and each one's number in it. Beside tools/gl/doubles_on_gl.h.
layout(location = 0) in vec2 position;
layout(location = 1) in float number;
flat out float listed;

void main() {
  gl_Position = vec4(position, 0.0, 1.0);
  listed = number;
}
