// Three parallelograms become a hexagon, the mean of their pictures; or six become a pentagon: the
// least of the three around it, mixed with the most of the three inside, channel by channel. Beside
// dof/polygon/polygon_lines.cpp.
uniform sampler2D part_0;
uniform sampler2D part_1;
uniform sampler2D part_2;
uniform sampler2D part_3;
uniform sampler2D part_4;
uniform sampler2D part_5;
uniform float least_share;  // 0: the mean of the first three

out vec4 polygon;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 a = texelFetch(part_0, here, 0), b = texelFetch(part_1, here, 0);
  vec4 c = texelFetch(part_2, here, 0);
  if (least_share == 0.0) {
    precise vec4 mean = ((a + b) + c) * (1.0 / 3.0);
    polygon = mean;
    return;
  }
  vec4 least = min(min(a, b), c);
  vec4 most = max(max(texelFetch(part_3, here, 0), texelFetch(part_4, here, 0)),
                  texelFetch(part_5, here, 0));
  precise vec4 mixed = most + least_share * (least - most);
  polygon = mixed;
}
