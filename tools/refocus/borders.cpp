#include "tools/refocus/borders.h"

#include <algorithm>

#include "raster/images/image.h"

namespace softfocus {
namespace {

/// The pixel of a line of `size` that a place `at`, which may lie outside, shows.
std::size_t shown(int at, int size, Border border) {
  if (border != Border::mirror) return static_cast<std::size_t>(std::clamp(at, 0, size - 1));
  const int period = 2 * size;
  const int place = (at % period + period) % period;
  return static_cast<std::size_t>(place < size ? place : period - 1 - place);
}

bool is_inside(int at, int size) { return at >= 0 && at < size; }

}  // namespace

std::string_view name_of(Border border) {
  constexpr std::string_view kNames[] = {"by-method", "clamp", "mirror", "black"};
  return kNames[static_cast<std::size_t>(border)];
}

Image with_border(const Image& picture, int margin, Border border) {
  Image result =
      make_image(picture.format, picture.width + 2 * margin, picture.height + 2 * margin);
  for (int y = -margin; y < picture.height + margin; ++y) {
    const auto from =
        row<std::uint16_t>(picture, static_cast<int>(shown(y, picture.height, border)));
    const auto to = row<std::uint16_t>(result, y + margin);
    for (int x = -margin; x < picture.width + margin; ++x) {
      const std::size_t place = 4 * shown(x, picture.width, border);
      const std::size_t at = 4 * static_cast<std::size_t>(x + margin);
      const bool is_black =
          border == Border::black && !(is_inside(x, picture.width) && is_inside(y, picture.height));
      for (std::size_t c = 0; c < 3; ++c)
        to[at + c] = is_black ? std::uint16_t{0} : from[place + c];
      to[at + 3] = from[place + 3];
    }
  }
  return result;
}

PlaneValues with_border(const PlaneValues& values, int width, int height, int margin,
                        Border border) {
  PlaneValues result;
  result.reserve(static_cast<std::size_t>(width + 2 * margin) *
                 static_cast<std::size_t>(height + 2 * margin));
  for (int y = -margin; y < height + margin; ++y) {
    const std::size_t start = shown(y, height, border) * static_cast<std::size_t>(width);
    for (int x = -margin; x < width + margin; ++x) {
      const bool is_black =
          border == Border::black && !(is_inside(x, width) && is_inside(y, height));
      result.push_back(is_black ? 0.0f : values[start + shown(x, width, border)]);
    }
  }
  return result;
}

Image without_border(const Image& picture, int margin) {
  Image result =
      make_image(picture.format, picture.width - 2 * margin, picture.height - 2 * margin);
  for (int y = 0; y < result.height; ++y) {
    const auto from = row<std::uint16_t>(picture, y + margin);
    const auto to = row<std::uint16_t>(result, y);
    std::copy_n(from.begin() + std::ptrdiff_t{4} * margin, to.size(), to.begin());
  }
  return result;
}

PlaneValues without_border(const PlaneValues& values, int width, int height, int margin) {
  PlaneValues result;
  for (int y = margin; y < height - margin; ++y) {
    const auto start = values.begin() + std::ptrdiff_t{y} * width;
    result.insert(result.end(), start + margin, start + width - margin);
  }
  return result;
}

}  // namespace softfocus
