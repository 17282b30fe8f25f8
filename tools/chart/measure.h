#pragma once
// A contender's picture held against the truth.

#include "tools/chart/point.h"
#include "tools/chart/scene.h"

namespace softfocus {

/// The longer side of the pictures in the page, at most: with 150 points it stays below 25 MB.
inline constexpr int kPagePicturePx = 205;

/// Fills in the errors, the worst place and the pictures of a point.
void measure_point(ChartPoint& point, const Image& picture, const Image& truth, const Image& labels,
                   ThreadPool& pool);

/// A picture small enough for a page with a hundred of them: PNG in base64.
std::string page_picture(const Image& picture);

}  // namespace softfocus
