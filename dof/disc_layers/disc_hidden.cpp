#include "dof/disc_layers/disc_hidden.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "dof/disc_layers/disc_hidden_search.h"
#include "dof/disc_layers/disc_levels.h"
#include "dof/lens.h"
#include "dof/weights.h"
#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

// Rows of a task.
constexpr int kBand = kDiscBlock;

// The memory of a search.
struct SearchMemory {
  RowMemory<float> values;
  std::vector<HiddenStrip> known;
};

HiddenSearch make_search(const DofInput& input, SearchMemory& memory, MemoryShelf* shelf) {
  const int width = input.scene.width, height = input.scene.height;
  const int strips = (width + kStrip - 1) / kStrip;
  const std::ptrdiff_t stride = std::ptrdiff_t{strips + 2} * kStrip;
  const std::ptrdiff_t plane = stride * height;
  memory.values =
      make_row_memory<float>(static_cast<std::size_t>(plane + (3 * plane + 1) / 2), shelf);
  memory.known.assign(static_cast<std::size_t>(strips) * static_cast<std::size_t>(height), {});
  float* radii = memory.values.get();
  auto* distances = reinterpret_cast<std::uint16_t*>(radii + plane);
  const std::ptrdiff_t first = kStrip;  // before it a row's first pixel repeats
  return {input.settings,
          width,
          height,
          strips,
          input.settings.max_coc_px + 1.0f,
          first_far_half(input.settings),
          false,
          input.scene,
          input.scene,
          memory.known.data(),
          radii + first,
          distances + first,
          distances + plane + first,
          distances + 2 * plane + first,
          stride};
}

int bands_of(int height) { return (height + kBand - 1) / kBand; }

void sweep_columns(const HiddenSearch& search, ThreadPool& pool) {
  for_each_band(pool, search.strips, kSweptStrips,
                [&](int first, int end) { sweep_columns(search, first, end, pool.isa()); });
}

struct RowDistances {
  std::vector<std::int32_t> left, right;
};

// Looks along a row. Returns whether any of its pixels has a source.
bool search_row(const HiddenSearch& search, int y, RowDistances& along, Isa isa) {
  along.left.resize(static_cast<std::size_t>(search.strips * kStrip));
  along.right.resize(static_cast<std::size_t>(search.strips * kStrip));
  return sweep_along(search, y, along.left.data(), along.right.data(), isa);
}

// First round: hides what is found at once, since sources lie in the scene.
bool first_round(const HiddenSearch& search, const ImageView& made, HiddenPicture& hidden,
                 ThreadPool& pool) {
  sweep_columns(search, pool);
  for_each_row_with<RowDistances>(pool, search.height, kBand, [&](int y, auto& along) {
    if (search_row(search, y, along, pool.isa())) {
      hide_row(search, y, along.left.data(), along.right.data(), made, hidden, pool.isa());
    }
  });
  const auto any = [](std::uint8_t row) { return row != 0; };
  return std::any_of(hidden.rows.begin(), hidden.rows.end(), any);
}

// Adds a vector of pixels to the hidden picture. Its strip is the scene if nothing was hidden.
void hide(const HiddenTexels& found, const ImageView& made, HiddenPicture& hidden,
          const ConstImageView& scene) {
  const auto to = row<std::uint16_t>(made, found.y).begin();
  if (!hidden.strip(found.x / kStrip, found.y)) {
    const int x = found.x / kStrip * kStrip;
    std::copy_n(row<std::uint16_t>(scene, found.y).begin() + 4 * x,
                4 * std::min(kStrip, scene.width - x), to + 4 * x);
  }
  for (unsigned bits = found.bits; bits != 0; bits &= bits - 1) {
    const int lane = std::countr_zero(bits), x = found.x + lane;
    std::copy_n(found.texels + 4 * lane, 4, to + 4 * x);
    hidden.mark(x, found.y);
  }
}

// Second round: what it finds may be the source of other pixels, and must wait.
void second_round(HiddenSearch& search, const ImageView& made, HiddenPicture& hidden,
                  ThreadPool& pool) {
  search.second = true;
  search.from = made;
  sweep_columns(search, pool);
  std::vector<std::vector<HiddenTexels>> found(static_cast<std::size_t>(bands_of(search.height)));
  for_each_row_with<RowDistances>(pool, search.height, kBand, [&](int y, auto& along) {
    if (search_row(search, y, along, pool.isa())) {
      find_in_row(search, y, along.left.data(), along.right.data(),
                  found[static_cast<std::size_t>(y / kBand)], pool.isa());
    }
  });
  pool.for_each(bands_of(search.height), [&](int band) {
    for (const HiddenTexels& at : found[static_cast<std::size_t>(band)]) {
      hide(at, made, hidden, search.scene);
    }
  });
}

}  // namespace

std::uint32_t first_far_half(const DofSettings& settings) {
  if (!(settings.coc.radius_at_infinity_px >= 0.0f)) return 0x8000u;  // none
  std::uint32_t near = 0, far = kHalfInfinity;
  while (near < far) {
    const std::uint32_t middle = (near + far) / 2;
    const float depth_m = half_to_float(static_cast<std::uint16_t>(middle));
    const bool before = coc_radius_px(settings.coc, depth_m) < 0.0f;
    if (before && filter_radius(settings, depth_m) > 1.0f) {
      near = middle + 1;
    } else {
      far = middle;
    }
  }
  return far;
}

void HiddenPicture::mark(int x, int y) {
  rows[static_cast<std::size_t>(y)] = 1;
  blocks[static_cast<std::size_t>(y / kDiscBlock * block_columns + x / kDiscBlock)] = 1;
  strips[static_cast<std::size_t>(y) * static_cast<std::size_t>(strip_columns) +
         static_cast<std::size_t>(x / kHiddenStrip)] = 1;
}

HiddenPicture nothing_hidden(int width, int height) {
  HiddenPicture hidden;
  hidden.block_columns = (width + kDiscBlock - 1) / kDiscBlock;
  hidden.block_rows = (height + kDiscBlock - 1) / kDiscBlock;
  hidden.rows.resize(static_cast<std::size_t>(height));
  hidden.strip_columns = (width + kHiddenStrip - 1) / kHiddenStrip;
  hidden.strips.resize(static_cast<std::size_t>(hidden.strip_columns) *
                       static_cast<std::size_t>(height));
  hidden.blocks.resize(static_cast<std::size_t>(hidden.block_columns * hidden.block_rows));
  return hidden;
}

ImageView make_hidden_picture(HiddenPicture& hidden, int width, int height, MemoryShelf* shelf) {
  constexpr std::size_t kTexelBytes = 8;
  const std::size_t stride =
      (static_cast<std::size_t>(width) + kStrip - 1) / kStrip * kStrip * kTexelBytes;
  hidden.memory = make_row_memory<std::byte>(stride * static_cast<std::size_t>(height), shelf);
  const ImageView picture{Format::rgba16f, width, height, static_cast<std::ptrdiff_t>(stride),
                          hidden.memory.get()};
  hidden.picture = picture;
  return picture;
}

HiddenPicture find_hidden(const DofInput& input, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) return find_hidden_oracle(input);
  const int width = input.scene.width, height = input.scene.height;
  SearchMemory memory;
  HiddenSearch search = make_search(input, memory, &pool.memory());
  HiddenPicture hidden = nothing_hidden(width, height);
  for_each_row(pool, height, kBand, [&](int y) { split_row(search, y, pool.isa()); });
  const auto near = [](const HiddenStrip& strip) { return strip.near != 0; };
  if (std::none_of(memory.known.begin(), memory.known.end(), near)) return hidden;
  const ImageView made = make_hidden_picture(hidden, width, height, &pool.memory());
  if (!first_round(search, made, hidden, pool)) return nothing_hidden(width, height);
  second_round(search, made, hidden, pool);
  return hidden;
}

bool hidden_near(const HiddenPicture& hidden, int x, int y, int width, int height) {
  if (hidden.empty()) return false;
  const auto block = [](int at, int blocks) { return std::clamp(at / kDiscBlock, 0, blocks - 1); };
  const int left = block(std::max(x - kDiscApron, 0), hidden.block_columns);
  const int right = block(x + width - 1 + kDiscApron, hidden.block_columns);
  const int top = block(std::max(y - kDiscApron, 0), hidden.block_rows);
  const int bottom = block(y + height - 1 + kDiscApron, hidden.block_rows);
  for (int row = top; row <= bottom; ++row) {
    for (int column = left; column <= right; ++column) {
      if (hidden.blocks[static_cast<std::size_t>(row * hidden.block_columns + column)] != 0) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace softfocus
