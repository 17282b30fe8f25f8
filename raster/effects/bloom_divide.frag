// Of a steady bloom, after the first halving: the mean of the light by its weights.
uniform sampler2D source;

out vec4 light;

void main() {
  vec4 sums = texelFetch(source, ivec2(gl_FragCoord.xy), 0);
  light = vec4(sums.rgb / sums.a, 1.0);
}
