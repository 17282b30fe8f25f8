#ifndef SOFTFOCUS_ISA

#include "dof/auto/depth_range.h"

#include <algorithm>
#include <array>
#include <vector>

#define SOFTFOCUS_KERNELS "dof/auto/depth_range.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

constexpr int kBandHeight = 32;

DepthRange range_of_band(const ConstImageView& picture, Isa isa, int begin, int end) {
  DepthRange range;
  std::array<std::uint32_t, 2 * kMostLanes> lanes{};
  const auto used = isa == Isa::scalar ? std::size_t{0} : static_cast<std::size_t>(lanes_of(isa));
  std::fill_n(lanes.begin(), used, 0xFFFFu);
  for (int y = begin; y < end; ++y) {
    const auto texels = row<std::uint16_t>(picture, y);
    int x = 0;
    if (used != 0) {
      x = SOFTFOCUS_KERNEL(isa, widen_range)(texels.data(), picture.width, lanes.data());
    }
    for (auto at = static_cast<std::size_t>(4 * x + 3); at < texels.size(); at += 4) {
      range.least = std::min(range.least, texels[at]);
      range.most = std::max(range.most, texels[at]);
    }
  }
  for (std::size_t i = 0; i < used; ++i) {
    range.least = static_cast<std::uint16_t>(std::min<std::uint32_t>(range.least, lanes[i]));
    range.most = static_cast<std::uint16_t>(std::max<std::uint32_t>(range.most, lanes[used + i]));
  }
  return range;
}

}  // namespace

DepthRange depth_range(const ConstImageView& picture, ThreadPool& pool) {
  const int bands = (picture.height + kBandHeight - 1) / kBandHeight;
  std::vector<DepthRange> of_bands(static_cast<std::size_t>(bands));
  pool.for_each(bands, [&](int band) {
    const int begin = band * kBandHeight;
    of_bands[static_cast<std::size_t>(band)] =
        range_of_band(picture, pool.isa(), begin, std::min(begin + kBandHeight, picture.height));
  });
  DepthRange range;
  for (const DepthRange& band : of_bands) {
    range.least = std::min(range.least, band.least);
    range.most = std::max(range.most, band.most);
  }
  return range;
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

/// Takes a row's whole vectors into a range: kLanes least depths, then kLanes greatest, as the
/// bits of halves. Returns how many pixels it has taken.
int widen_range(const std::uint16_t* row, int width, std::uint32_t* range) {
  Bits least = load(range), most = load(range + kLanes);
  int x = 0;
  for (; x + kLanes <= width; x += kLanes) {
    const Bits depth = load_half_texels(row + 4 * x).a;
    least = select(depth < least, depth, least);
    most = select(depth > most, depth, most);
  }
  store(range, least);
  store(range + kLanes, most);
  return x;
}

#endif
