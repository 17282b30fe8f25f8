// The mean of 3x3 pixels in four bilinear reads. Beside raster/passes/kernel.cpp.
uniform sampler2D source;  // bilinear, clamped to its edges
uniform vec2 texel;        // 1 / its size

out vec4 filtered;

const vec3 kReads[4] = vec3[](vec3(-0.5, -0.5, 4.0 / 9.0), vec3(1.0, -0.5, 2.0 / 9.0),
                              vec3(-0.5, 1.0, 2.0 / 9.0), vec3(1.0, 1.0, 1.0 / 9.0));

void main() {
  precise vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    precise vec2 place = (gl_FragCoord.xy + kReads[i].xy) * texel;
    sum = sum + kReads[i].z * textureLod(source, place, 0.0).rgb;
  }
  filtered = vec4(sum, texelFetch(source, ivec2(gl_FragCoord.xy), 0).a);
}
