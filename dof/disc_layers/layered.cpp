#include "dof/disc_layers/disc_layers.h"

#include <algorithm>
#include <cmath>

#include "dof/disc_layers/disc_hidden.h"
#include "dof/disc_layers/disc_hidden_search.h"
#include "dof/picture_planes.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// Whether a layer is farther than a pixel before the focus by more than the thing itself is deep.
bool is_behind(float radius_px, float of_radius_px) {
  return radius_px > of_radius_px + 1.0f + 0.25f * std::fabs(of_radius_px);
}

// A row's texels, four halves each.
std::uint16_t* texels_of(const ImageView& picture, int y) {
  return row<std::uint16_t>(picture, y).data();
}
const std::uint16_t* texels_of(const ConstImageView& picture, int y) {
  return row<std::uint16_t>(picture, y).data();
}

// The texel of the first layer behind a pixel, or null.
const std::uint16_t* texel_behind(const DofInput& input, int x, int y) {
  const float radius = split_texel(input, x, y).radius_px;
  if (!(radius < -1.0f)) return nullptr;
  DofInput of = input;
  for (const ConstImageView& layer : input.behind) {
    of.scene = layer;
    if (is_behind(split_texel(of, x, y).radius_px, radius)) return texels_of(layer, y) + 4 * x;
  }
  return nullptr;
}

// Puts what is known of a row in place of what is guessed. A strip in which nothing was hidden is
// the scene's, as the picture may not be defined there.
void know_row(const DofInput& input, std::uint32_t first_far, int y, const ImageView& made,
              HiddenPicture& hidden) {
  const int width = input.scene.width;
  const std::uint16_t* scene = texels_of(input.scene, y);
  for (int x = 0; x < width; ++x) {
    if (scene[4 * x + 3] >= first_far) continue;  // spares most pixels the rest
    const std::uint16_t* behind = texel_behind(input, x, y);
    if (behind == nullptr) continue;
    if (!hidden.strip(x / kHiddenStrip, y)) {
      const int first = x / kHiddenStrip * kHiddenStrip;
      std::copy_n(scene + 4 * first, 4 * std::min(kHiddenStrip, width - first),
                  texels_of(made, y) + 4 * first);
    }
    std::copy_n(behind, 4, texels_of(made, y) + 4 * x);
    hidden.mark(x, y);
  }
}

HiddenPicture find_known(const DofInput& input, ThreadPool& pool) {
  const int width = input.scene.width, height = input.scene.height;
  HiddenPicture hidden = find_hidden(input, pool);
  if (hidden.empty()) {
    const ImageView made = make_hidden_picture(hidden, width, height, &pool.memory());
    for (int y = 0; y < height; ++y) {
      std::copy_n(texels_of(input.scene, y), 4 * width, texels_of(made, y));
    }
  }
  const ImageView made{Format::rgba16f, width, height, hidden.picture.stride_bytes,
                       hidden.memory.get()};
  const std::uint32_t first_far = first_far_half(input.settings);
  // A task has whole blocks, in which it alone marks pixels.
  for_each_row(pool, height, kDiscBlock,
               [&](int y) { know_row(input, first_far, y, made, hidden); });
  const auto any = [](std::uint8_t row) { return row != 0; };
  if (std::any_of(hidden.rows.begin(), hidden.rows.end(), any)) return hidden;
  return nothing_hidden(width, height);
}

}  // namespace

void layered(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (input.behind.empty()) return disc_layers(input, result, pool);
  blur_discs(input, result, pool, find_known);
}

}  // namespace softfocus
