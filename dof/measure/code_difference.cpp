#include "dof/measure/code_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "raster/numbers/half.h"
#include "raster/numbers/srgb.h"

namespace softfocus {
namespace {

using Codes = std::array<std::uint8_t, 3>;

// A picture's codes, row by row.
struct CodePicture {
  int width, height;
  std::vector<Codes> pixels;

  const Codes& at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

CodePicture codes_of(const Image& image) {
  CodePicture codes{image.width, image.height, {}};
  codes.pixels.reserve(static_cast<std::size_t>(image.width) *
                       static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    const auto values = row<std::uint16_t>(image, y);
    for (std::size_t i = 0; i < values.size(); i += 4) {
      Codes pixel{};
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = linear_to_srgb8(half_to_float(values[i + c]));
      codes.pixels.push_back(pixel);
    }
  }
  return codes;
}

std::array<double, 3> between(const Codes& a, const Codes& b) {
  return {static_cast<double>(a[0] - b[0]), static_cast<double>(a[1] - b[1]),
          static_cast<double>(a[2] - b[2])};
}

double luma(const std::array<double, 3>& rgb) {
  return rgb[0] * 0.29889531 + rgb[1] * 0.58662247 + rgb[2] * 0.11448223;
}

double yiq_distance(const Codes& a, const Codes& b) {
  const std::array<double, 3> d = between(a, b);
  const double y = luma(d);
  const double i = d[0] * 0.59597799 - d[1] * 0.27417610 - d[2] * 0.32180189;
  const double q = d[0] * 0.21147017 - d[1] * 0.52261711 + d[2] * 0.31114694;
  return 0.5053 * y * y + 0.299 * i * i + 0.1957 * q * q;
}

// The up to eight pixels around one; 1 if it lies at the border, else 0.
template <class Visit>
int around(const CodePicture& picture, int x, int y, const Visit& visit) {
  const int left = std::max(x - 1, 0), right = std::min(x + 1, picture.width - 1);
  const int top = std::max(y - 1, 0), bottom = std::min(y + 1, picture.height - 1);
  for (int column = left; column <= right; ++column) {
    for (int line = top; line <= bottom; ++line) {
      if (column != x || line != y) visit(column, line);
    }
  }
  return x == left || x == right || y == top || y == bottom ? 1 : 0;
}

// Whether more than two pixels around it, the border counted as one, have its colour.
bool has_many_siblings(const CodePicture& picture, int x, int y) {
  int same = 0;
  const int border = around(picture, x, y, [&](int column, int line) {
    same += picture.at(column, line) == picture.at(x, y) ? 1 : 0;
  });
  return same + border > 2;
}

// Whether a pixel is on an edge that is smooth: among its neighbours are a darker and a brighter
// one, few as bright as itself, and the darkest or the brightest belongs to an area in both
// pictures.
bool is_smooth_edge(const CodePicture& picture, int x, int y, const CodePicture& other) {
  int equal = 0;
  double least = 0.0, most = 0.0;
  int least_x = 0, least_y = 0, most_x = 0, most_y = 0;
  const int border = around(picture, x, y, [&](int column, int line) {
    const double brighter = luma(between(picture.at(x, y), picture.at(column, line)));
    if (brighter == 0.0) {
      ++equal;
    } else if (brighter < least) {
      least = brighter;
      least_x = column;
      least_y = line;
    } else if (brighter > most) {
      most = brighter;
      most_x = column;
      most_y = line;
    }
  });
  if (equal + border > 2 || least == 0.0 || most == 0.0) return false;
  const auto is_area = [&](int column, int line) {
    return has_many_siblings(picture, column, line) && has_many_siblings(other, column, line);
  };
  return is_area(least_x, least_y) || is_area(most_x, most_y);
}

}  // namespace

CodeDifference compare_codes(const Image& a, const Image& b, double threshold) {
  const CodePicture codes_a = codes_of(a), codes_b = codes_of(b);
  CodeDifference found;
  const double limit = kMostYiq * threshold * threshold;
  std::uint64_t sum = 0, squares = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      const Codes &one = codes_a.at(x, y), &other = codes_b.at(x, y);
      if (one == other) continue;
      ++found.pixels;
      for (std::size_t c = 0; c < 3; ++c) {
        const int error = std::abs(one[c] - other[c]);
        sum += static_cast<std::uint64_t>(error);
        squares += static_cast<std::uint64_t>(error) * static_cast<std::uint64_t>(error);
        if (error <= found.max_error) continue;
        found.max_error = error;
        found.max_x = x;
        found.max_y = y;
      }
      if (!(yiq_distance(one, other) > limit)) continue;
      const bool is_edge =
          is_smooth_edge(codes_a, x, y, codes_b) || is_smooth_edge(codes_b, x, y, codes_a);
      ++(is_edge ? found.anti_aliased : found.beyond);
    }
  }
  const double values = 3.0 * static_cast<double>(codes_a.pixels.size());
  found.mean_error = static_cast<double>(sum) / (255.0 * values);
  found.rms_error = std::sqrt(static_cast<double>(squares) / values) / 255.0;
  found.psnr_db =
      squares == 0 ? std::numeric_limits<double>::infinity() : -20.0 * std::log10(found.rms_error);
  return found;
}

}  // namespace softfocus
