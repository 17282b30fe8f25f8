// As many lines of diffusion.cpp as there are lanes, at once.

namespace {

/// b of a node.
SOFTFOCUS_INLINE Floats heat_flow(Floats radius_px) {
  return select(absolute(radius_px) > 0.5f, radius_px * radius_px * 0.125f, splat(0.0f));
}

/// Solves the systems of `count` nodes, each a vector of radius, red, green and blue.
SOFTFOCUS_INLINE void diffuse_lines(float* nodes, int count) {
  Floats ratio = splat(0.0f), before = splat(0.0f);
  Floats r = splat(0.0f), g = splat(0.0f), b = splat(0.0f);
  Floats here = heat_flow(load(nodes));
  for (int i = 0; i < count; ++i) {
    float* node = nodes + i * 4 * kLanes;
    const Floats next = i + 1 < count ? heat_flow(load(node + 4 * kLanes)) : splat(0.0f);
    const Floats after = smaller(here, next);
    const Floats through = 1.0f + before * ratio;
    const Floats scale = 1.0f / (through + after);
    ratio = through * scale;
    r = (load(node + kLanes) + before * r) * scale;
    g = (load(node + 2 * kLanes) + before * g) * scale;
    b = (load(node + 3 * kLanes) + before * b) * scale;
    store(node, after * scale);
    store(node + kLanes, r);
    store(node + 2 * kLanes, g);
    store(node + 3 * kLanes, b);
    before = after;
    here = next;
  }
  r = g = b = splat(0.0f);
  for (int i = count - 1; i >= 0; --i) {
    float* node = nodes + i * 4 * kLanes;
    const Floats share = load(node);
    r = load(node + kLanes) + share * r;
    g = load(node + 2 * kLanes) + share * g;
    b = load(node + 3 * kLanes) + share * b;
    store(node + kLanes, r);
    store(node + 2 * kLanes, g);
    store(node + 3 * kLanes, b);
  }
}

}  // namespace

/// Along kLanes rows, `padded` pixels long of which `width` count. `rows` are those of the
/// red plane, as many as there are lanes; of them `height` are written.
void diffuse_rows(float* const* rows, int height, std::ptrdiff_t plane, int width, int padded,
                  float* nodes) {
  for (int x = 0; x < padded; x += kLanes) {
    for (int channel = 0; channel < 4; ++channel) {
      Floats block[kLanes];
      for (int i = 0; i < kLanes; ++i) block[i] = load(rows[i] + (channel + 3) % 4 * plane + x);
      transpose(block);
      for (int i = 0; i < kLanes; ++i) store(nodes + ((x + i) * 4 + channel) * kLanes, block[i]);
    }
  }
  diffuse_lines(nodes, width);
  for (int x = 0; x < padded; x += kLanes) {
    for (int channel = 1; channel < 4; ++channel) {
      Floats block[kLanes];
      for (int i = 0; i < kLanes; ++i) block[i] = load(nodes + ((x + i) * 4 + channel) * kLanes);
      transpose(block);
      for (int i = 0; i < height; ++i) store(rows[i] + (channel - 1) * plane + x, block[i]);
    }
  }
}

/// Down kLanes columns that begin at `top`, in the red plane.
void diffuse_columns(float* top, std::ptrdiff_t stride, std::ptrdiff_t plane, int height,
                     float* nodes) {
  for (int y = 0; y < height; ++y) {
    for (int channel = 0; channel < 4; ++channel) {
      store(nodes + (y * 4 + channel) * kLanes, load(top + y * stride + (channel + 3) % 4 * plane));
    }
  }
  diffuse_lines(nodes, height);
  for (int y = 0; y < height; ++y) {
    for (int channel = 1; channel < 4; ++channel) {
      store(top + y * stride + (channel - 1) * plane, load(nodes + (y * 4 + channel) * kLanes));
    }
  }
}
