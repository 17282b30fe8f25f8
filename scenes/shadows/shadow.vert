// Triangles of shadows on receivers. Beside scenes/shadows/shadow_mask.h.
layout(location = 0) in vec2 position;
layout(location = 1) in float on;
flat out float receiver;

void main() {
  gl_Position = vec4(position, 0.0, 1.0);
  receiver = on;
}
