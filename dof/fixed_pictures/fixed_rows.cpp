#include "dof/fixed_pictures/fixed_rows.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <vector>

namespace softfocus {
namespace {

struct RowFilter {
  const ConstImageView& picture;
  const std::uint8_t* codes;
  std::size_t code_bytes;
  const fixed::Weights* table;
  fixed::Settings settings;  ///< of the whole picture
  const ImageView& result;
};

const std::byte* bytes_of(const ConstImageView& image, int y) {
  return image.texels + y * image.stride_bytes;
}
std::byte* bytes_of(const ImageView& image, int y) { return image.texels + y * image.stride_bytes; }

void filter_rows(const RowFilter& filter, int y_begin, int y_end) {
  const int first = std::max(y_begin - filter.settings.reach, 0);
  const int last = std::min(y_end + filter.settings.reach, filter.picture.height);
  fixed::Settings settings = filter.settings;
  settings.height = static_cast<std::uint16_t>(last - first);
  std::vector<std::uint32_t> memory(fixed::memory_bytes(settings) / sizeof(std::uint32_t) + 1);
  std::vector<std::byte> unwanted(bytes_per_texel(filter.result.format) *
                                  static_cast<std::size_t>(filter.result.width));
  fixed::Stream stream;
  const auto begin = settings.colour == SOFTFOCUS_FIXED_RGBA16F ? softfocus_fixed_begin_half
                                                                : softfocus_fixed_begin;
  [[maybe_unused]] const int error =
      begin(&stream, &settings, filter.table, memory.data(), memory.size() * sizeof(std::uint32_t));
  assert(error == 0);
  int out = first;
  const auto place = [&] {
    return out >= y_begin && out < y_end ? bytes_of(filter.result, out) : unwanted.data();
  };
  for (int y = first; y < last; ++y) {
    const std::size_t code = static_cast<std::size_t>(y) * settings.width * filter.code_bytes;
    out += softfocus_fixed_put_row(
        &stream, static_cast<std::uint32_t>(y - first), bytes_of(filter.picture, y),
        filter.codes != nullptr ? filter.codes + code : nullptr, place());
  }
  while (out < y_end && softfocus_fixed_finish_row(&stream, place()) == 1) ++out;
}

}  // namespace

void fixed_two_pass_rows(const ConstImageView& picture, softfocus_fixed_depth depth,
                         const void* codes, std::span<const fixed::Weights> table,
                         const ImageView& result, ThreadPool& pool) {
  const bool bytes = picture.format == Format::rgba8;
  assert(bytes || picture.format == Format::rgba16f);
  int reach = 0;
  for (const fixed::Weights& weights : table) reach = std::max(reach, int{weights.reach});
  const RowFilter filter{
      picture,
      static_cast<const std::uint8_t*>(codes),
      depth == SOFTFOCUS_FIXED_DEPTH8 ? std::size_t{1} : std::size_t{2},
      table.data(),
      {static_cast<std::uint16_t>(picture.width), static_cast<std::uint16_t>(picture.height),
       static_cast<std::uint8_t>(reach),
       static_cast<std::uint8_t>(bytes ? SOFTFOCUS_FIXED_RGBA8 : SOFTFOCUS_FIXED_RGBA16F),
       static_cast<std::uint8_t>(depth)},
      result};
  // Strips high enough that what lies around them is little, and enough for all threads.
  const int rows =
      std::max(4 * reach + 16, (picture.height + 4 * pool.threads() - 1) / (4 * pool.threads()));
  pool.for_each((picture.height + rows - 1) / rows, [&](int strip) {
    filter_rows(filter, strip * rows, std::min((strip + 1) * rows, picture.height));
  });
}

}  // namespace softfocus
