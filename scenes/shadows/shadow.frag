// A shadow falls on the pixels of its receiver alone. Beside scenes/shadows/shadow_mask.h.
uniform sampler2D receivers;
flat in float receiver;
out vec4 shadow;

void main() {
  if (texelFetch(receivers, ivec2(gl_FragCoord.xy), 0).x != receiver) discard;
  shadow = vec4(1.0);
}
