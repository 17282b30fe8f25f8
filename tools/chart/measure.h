#pragma once
// A contender's picture held against the truth, and whose pictures the page shows: those of all
// points would fill hundreds of megabytes.

#include <cstddef>
#include <string>
#include <vector>

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

/// With this many points at most all have pictures: a page of some 25 MB.
inline constexpr std::size_t kMostPicturedPoints = 160;

/// With more scenes the page shows pictures of the worst alone, and no panel a scene.
inline constexpr std::size_t kMostPanels = 20;

struct PicturedPoint {
  std::size_t panel;
  std::size_t point;
};

/// All points; of too many, on each scene every method at its best setting; of too many scenes,
/// every method at its best setting, on the scene with its largest FLIP. In the order
/// of scenes and points. Needs settled panels.
std::vector<PicturedPoint> pictured_points(const std::vector<ChartPanel>& panels);

/// About how many pictured_points() will give, for that many points on each scene.
std::size_t expected_pictures(std::size_t scenes, std::size_t points_a_scene, std::size_t methods);

/// Which points have pictures, for the page: one sentence.
std::string pictured_text(const std::vector<ChartPanel>& panels);

}  // namespace softfocus
