#pragma once
// A contender's picture held against the truth.

#include "tools/chart/point.h"
#include "tools/chart/scene.h"

namespace softfocus {

/// The longer side of the pictures in the page, at most.
inline constexpr int kPagePicturePx = 171;

/// Errors of a picture.
ChartErrors measure_picture(const Image& picture, const Image& truth, const Image& labels,
                            ThreadPool& pool);

/// Fills in the worst place of a point and its pictures.
void add_point_pictures(ChartPoint& point, const Image& picture, const Image& truth,
                        ThreadPool& pool);

/// A hash of what the measures, regions, crops and reduced pictures give for a small fixed pair of
/// pictures with light of up to 8. It differs whenever a measure has changed.
std::uint64_t measures_hash(ThreadPool& pool);

/// A picture small enough for a page with a hundred of them: PNG in base64.
std::string page_picture(const Image& picture);

}  // namespace softfocus
