// Second pass of the tiled filters: how far the taps of a tile's pixels must go. Drawn into
// RGBA32F, a pixel a tile. A neighbour weighs something if its radius exceeds its distance, so
// the reach is the largest radius among the tile itself and those tiles whose largest radius
// exceeds the gap between the two. All farther taps weigh nothing: the filter gives the same
// bits without them.
uniform sampler2D row_radius;  // what tile_rows.frag made
uniform int tile_px;
uniform int farthest;   // how many tiles away a circle of max_coc_px can come from
uniform bool diagonal;  // false: only tiles of the same row or column, all that two_pass needs

out vec4 reach;  // by tiles of the same row; of the same column; all

float tile_radius(ivec2 tile) {
  int end = min((tile.y + 1) * tile_px, textureSize(row_radius, 0).y);
  float largest = 0.0;
  for (int y = tile.y * tile_px; y < end; ++y) {
    float radius = texelFetch(row_radius, ivec2(tile.x, y), 0).r;
    largest = radius > largest ? radius : largest;
  }
  return largest;
}

// The least distance between pixels of two tiles in the same row or column.
int gap_px(int tiles) { return tiles == 0 ? 0 : (tiles - 1) * tile_px + 1; }

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  ivec2 tiles = textureSize(row_radius, 0);
  tiles.y = (tiles.y + tile_px - 1) / tile_px;
  vec3 largest = vec3(0.0);
  for (int dy = -farthest; dy <= farthest; ++dy) {
    for (int dx = -farthest; dx <= farthest; ++dx) {
      ivec2 tile = here + ivec2(dx, dy);
      if (tile.x < 0 || tile.y < 0 || tile.x >= tiles.x || tile.y >= tiles.y) continue;
      if (!diagonal && dx != 0 && dy != 0) continue;
      float radius = tile_radius(tile);
      if (!(radius > float(gap_px(max(abs(dx), abs(dy)))))) continue;
      if (dy == 0 && radius > largest.x) largest.x = radius;
      if (dx == 0 && radius > largest.y) largest.y = radius;
      if (radius > largest.z) largest.z = radius;
    }
  }
  reach = vec4(largest, 0.0);
}
