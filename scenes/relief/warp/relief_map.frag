// A pre-warped plane on a camera's picture. Beside scenes/relief/warp/map_relief.cpp; the numbers before
// they are stored as halves.
uniform sampler2D texels;   // RGBA32F: codes, 0 to 255
uniform sampler2D depths;   // R32F: metres
uniform sampler2D lines;    // u, v and q of each row's pixel 0
uniform sampler2D light;    // of each code
uniform sampler2D picture;  // what was there, depth in alpha
uniform vec3 along;         // u, v and q a pixel
uniform ivec2 first;
uniform ivec2 end;
uniform float height_m;
uniform float k3;
out vec4 mapped;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  mapped = texelFetch(picture, here, 0);
  if (here.x < first.x || here.y < first.y || here.x >= end.x || here.y >= end.y) return;
  vec4 line = texelFetch(lines, ivec2(0, here.y), 0);
  float x = float(here.x);
  ivec2 size = textureSize(texels, 0);
  precise float q = line.z + x * along.z;
  if (!(q > 0.0)) return;
  precise float inverse = 1.0 / q;
  precise float u = (line.x + x * along.x) * inverse;
  precise float v = (line.y + x * along.y) * inverse;
  if (!(u >= 0.0 && v >= 0.0 && u < float(size.x - 1) && v < float(size.y - 1))) return;
  precise float in_u = u * 256.0 + 0.5;
  precise float in_v = v * 256.0 + 0.5;
  int place_u = min(int(in_u), (size.x - 1) * 256 - 1);
  int place_v = min(int(in_v), (size.y - 1) * 256 - 1);
  int weight_u = place_u & 255, weight_v = place_v & 255;
  ivec2 at = ivec2(place_u >> 8, place_v >> 8);
  ivec4 sum = ivec4(0);
  int most = -1;
  float depth = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 place = at + ivec2(i & 1, i >> 1);
    ivec4 code = ivec4(texelFetch(texels, place, 0));
    int weight = ((i & 1) == 1 ? weight_u : 256 - weight_u) *
                 ((i >> 1) == 1 ? weight_v : 256 - weight_v);
    sum += code * weight;
    if (code.a != 0 && weight > most) {
      most = weight;
      depth = texelFetch(depths, place, 0).r;
    }
  }
  if (2 * sum.a < (255 << 16)) return;
  precise float far = height_m * inverse * (1.0 + k3 * depth);
  float cut = far < 65504.0 ? far : 65504.0;
  if (!(cut < mapped.a)) return;
  for (int c = 0; c < 3; ++c) {
    precise float share = float(sum[c]) / float(sum.a);
    precise float code = share * 255.0 + 0.5;
    mapped[c] = texelFetch(light, ivec2(int(code), 0), 0).r;
  }
  mapped.a = cut;
}
