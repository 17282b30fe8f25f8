// One group of 2x2 pixels drawn anew, the rest as it was found in the frame before. Beside
// raster/temporal/refresh.cpp.
uniform sampler2D drawn;  // the frame, its depth in alpha
uniform sampler2D found;  // reprojected, and in alpha of how many frames; 0: none
uniform int groups;
uniform int turn;  // the group that is drawn

layout(location = 0) out vec4 shown;
layout(location = 1) out vec4 frames;

uint hash_of_place(ivec2 place) {
  uint hash = uint(place.x) * 0x9E3779B9u ^ uint(place.y) * 0x85EBCA77u;
  hash ^= hash >> 16;
  hash *= 0x85EBCA6Bu;
  hash ^= hash >> 13;
  hash *= 0xC2B2AE35u;
  return hash ^ hash >> 16;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 fresh = texelFetch(drawn, here, 0);
  vec4 old = texelFetch(found, here, 0);
  bool is_old = old.a > 0.0 && int(hash_of_place(here / 2) % uint(groups)) != turn;
  shown = vec4(is_old ? old.rgb : fresh.rgb, fresh.a);
  precise float count = old.a + 1.0;
  frames = vec4(is_old ? count : 1.0, 0.0, 0.0, 1.0);
}
