#pragma once
// The contenders of a chart of impostors: a scene, taken as one object, through a full turn of the
// camera. Their picture is a sheet of 4 x 4 views of the turn.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenes/relief/impostors/impostor.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "tools/chart/scene.h"

namespace softfocus {

/// The pinhole, which is redrawn; pre-warped reliefs; reliefs that rays march through; octahedral
/// atlases.
std::vector<std::string> turn_methods();
std::vector<ChartEntry> turn_entries(const std::string& method, int height_px, bool quick);

/// Views of the sheet each way.
inline constexpr int kSheetViews = 4;

/// The sheet, redrawn; also what a scene's pinhole is for this subject.
Image truth_of_turn(const ChartScene& chart, ThreadPool& pool);

class TurnContenders {
 public:
  /// Both outlive it. Throws UsageError if the scene has no triangle, or if a sheet of that size
  /// has no whole pixels.
  TurnContenders(const ChartScene& chart, ThreadPool& pool);

  /// A full turn; the sheet's views go into `sheet`. Returns milliseconds a frame: the mean over
  /// the turn, renewals included. An atlas is drawn before, and is no part of it.
  double run(const ChartTurn& turn, Image& sheet);

  /// Adds the last turn's outline, renewals and memory, against the truth's sheet.
  void add_errors(const Image& truth, const Image& sheet, ChartErrors& errors) const;

 private:
  void show(const ChartTurn& turn, const CameraMatrices& view);
  void show_impostor(const ChartTurn& turn, const CameraMatrices& view);
  void show_marched(const ChartTurn& turn, const CameraMatrices& view);
  const OctahedralAtlas& atlas_of(int views);

  const ChartScene& chart_;
  ThreadPool& pool_;
  int width_, height_;  ///< of a view
  ReliefMaker maker_;
  PreparedScene prepared_;
  Camera camera_;
  double distance_m_;
  Image blank_, shown_;
  Impostor impostor_;
  std::map<int, OctahedralAtlas> atlases_;
  // The last turn's.
  int renewals_ = 0;
  std::size_t most_bytes_ = 0;
};

}  // namespace softfocus
