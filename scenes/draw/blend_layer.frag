// Lays a layer of transparent surfaces over a picture: colour times opacity, opacity in alpha. Beside
// raster/passes/over.h and scenes/draw/transparent_layers.h.
uniform sampler2D below;
uniform sampler2D layer;
uniform sampler2D layer_depth;
uniform float inverse_far;
uniform float inverse_near_less_far;
out vec4 blended;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 behind = texelFetch(below, at, 0);
  vec4 over = texelFetch(layer, at, 0);
  precise vec3 colour = over.rgb + (1.0 - over.a) * behind.rgb;
  // No arithmetic where there is nothing: it would change -0.
  if (over == vec4(0.0)) colour = behind.rgb;
  precise float left = 1.0 - texelFetch(layer_depth, at, 0).r;
  precise float depth_m = 1.0 / (inverse_far + (left > 0.0 ? left : 0.0) * inverse_near_less_far);
  blended = vec4(colour, over.a >= 0.5 ? min(depth_m, 65504.0) : behind.a);
}
