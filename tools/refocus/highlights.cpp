#include "tools/refocus/highlights.h"

#include <algorithm>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

/// Multiplies each colour by what `raised` makes of its luminance.
template <class Curve>
void bend(const PlaneValues& opacity, Image& picture, const Curve& raised) {
  constexpr double kMost = 65504.0;
  std::size_t pixel = 0;
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < halves.size(); i += 4, ++pixel) {
      const double whole = opacity.empty() ? 1.0 : static_cast<double>(opacity[pixel]);
      const auto colour = [&](std::size_t c) {
        return static_cast<double>(half_to_float(halves[i + c]));
      };
      const double light = 0.2126 * colour(0) + 0.7152 * colour(1) + 0.0722 * colour(2);
      const double luminance = light / whole;
      const double wanted = raised(luminance);
      if (!(whole > 0.0) || !(luminance > 0.0) || wanted == luminance) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = std::clamp(colour(c) * (wanted / luminance), -kMost, kMost);
        halves[i + c] = float_to_half(static_cast<float>(value), HalfRounding::nearest_even);
      }
    }
  }
}

}  // namespace

HighlightCurve parse_highlights(const std::string& text) {
  constexpr const char* kWanted =
      "a gain from 1 and a threshold from 0 as GAIN,THRESHOLD, such as 8,0.9";
  const auto comma = text.find(',');
  try {
    if (comma != text.npos) {
      return {parse_number("", text.substr(0, comma), 1.0, 1e4, ""),
              parse_number("", text.substr(comma + 1), 0.0, 1e4, "")};
    }
  } catch (const UsageError&) {  // which knows one number alone
  }
  throw UsageError("--highlights '" + text + "': give " + kWanted);
}

void raise_highlights(const HighlightCurve& highlights, const PlaneValues& opacity,
                      Image& picture) {
  bend(opacity, picture, [&](double luminance) {
    return luminance + (highlights.gain - 1.0) * std::max(luminance - highlights.threshold, 0.0);
  });
}

void lower_highlights(const HighlightCurve& highlights, const PlaneValues& opacity,
                      Image& picture) {
  bend(opacity, picture, [&](double luminance) {
    const double above = luminance - highlights.threshold;
    return above > 0.0 ? highlights.threshold + above / highlights.gain : luminance;
  });
}

}  // namespace softfocus
