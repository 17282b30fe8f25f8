#pragma once
// `chart`'s findings about one contender on one scene.

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "dof/measure/measures.h"
#include "tools/chart/settings.h"
#include "tools/report/worst_crop.h"

namespace softfocus {

/// How far a picture is from the truth. NaN for a region without pixels; by region in the order
/// of Region.
struct ChartErrors {
  double psnr_db = std::numeric_limits<double>::infinity();
  double ssim = 1.0;
  double flip = 0.0;
  std::array<double, kRegions> flip_by_region{};
  double hdr_flip = 0.0;
  std::array<double, kRegions> hdr_flip_by_region{};
  /// Pixels times lights, of a chart of shadows, that are in the light and should be in shadow, or
  /// the other way about. NaN of other subjects.
  double wrong_pixels = std::numeric_limits<double>::quiet_NaN();
  /// Figures of a chart of impostors: wrong pixels a pixel of outline, how often a turn was drawn
  /// anew, and the most memory that was taken. NaN of other subjects.
  double outline_px = std::numeric_limits<double>::quiet_NaN();
  double renewals = std::numeric_limits<double>::quiet_NaN();
  double megabytes = std::numeric_limits<double>::quiet_NaN();
};

/// Needs pictures measured with HDR-FLIP.
ChartErrors chart_errors(const MeasuredPictures& measured);

/// One of the errors, as a member of JSON and as a column.
struct ChartMeasure {
  std::string key;    ///< "flip_near"
  std::string title;  ///< "near"
  std::string group;  ///< "FLIP"; empty: of no group
  int places;         ///< decimal ones
  std::function<double&(ChartErrors&)> of;
  bool is_own = false;  ///< of some subjects alone: NaN of others

  double value(ChartErrors errors) const { return of(errors); }
};

/// All, in the order of members and columns.
const std::vector<ChartMeasure>& chart_measures();

/// One of the errors by which contenders are ranked.
struct RankedError {
  std::string_view key;    ///< "flip", as in chart.json
  std::string_view title;  ///< "FLIP"
  double ChartErrors::*value;
  int places = 4;                ///< decimal ones, in tables
  double least_shown = 1e-5;     ///< stands for 0 in plots: it has no logarithm
  double least_in_ratio = 1e-6;  ///< stands for 0 where errors are divided
};

/// The first decides which setting is best and what is on the front.
using RankedErrors = std::array<RankedError, 2>;
inline constexpr RankedErrors kPictureErrors{
    RankedError{"flip", "FLIP", &ChartErrors::flip},
    RankedError{"hdr_flip", "HDR-FLIP", &ChartErrors::hdr_flip}};
inline constexpr RankedErrors kShadowErrors{
    RankedError{"wrong_pixels", "wrong pixels", &ChartErrors::wrong_pixels, 0, 0.5, 0.5},
    RankedError{"flip", "FLIP", &ChartErrors::flip}};

/// The pinhole, which redraws, has no error: it stands a little below the others.
inline constexpr RankedErrors kTurnErrors{
    RankedError{"flip", "FLIP", &ChartErrors::flip, 4, 2e-3, 1e-6},
    RankedError{"outline_px", "outline, px", &ChartErrors::outline_px, 3, 0.1, 1e-3}};

/// Milliseconds, run by run: of the whole frame, from the drawing to the result, and of the
/// filter's share in it. Nothing is filtered in an accumulation: `filter_ms` is empty.
struct ChartTimes {
  std::vector<double> frame_ms;
  std::vector<double> filter_ms;
};

/// PNG files in base64, for a page that needs no other file.
struct ChartPictures {
  std::string picture;      ///< reduced
  std::string error;        ///< reduced: the heat map of FLIP
  std::string worst;        ///< where it is worst, every pixel
  std::string worst_truth;  ///< the truth there
  std::string worst_error;

  bool empty() const { return picture.empty(); }
};

struct KeptPicture {
  const char* name;
  std::string ChartPictures::*picture;
};
inline constexpr std::array kKeptPictures{KeptPicture{"picture", &ChartPictures::picture},
                                          KeptPicture{"error", &ChartPictures::error},
                                          KeptPicture{"worst", &ChartPictures::worst},
                                          KeptPicture{"worst_truth", &ChartPictures::worst_truth},
                                          KeptPicture{"worst_error", &ChartPictures::worst_error}};

inline constexpr double kNotTimed = std::numeric_limits<double>::quiet_NaN();

struct ChartPoint {
  ChartEntry entry;
  std::uint64_t picture_hash = 0;
  ChartErrors errors{};
  Crop worst{};
  ChartPictures pictures{};  ///< of chosen points only: pictured_points()
  ChartTimes times{};

  // Settled by settle_points().
  double median_ms = kNotTimed;
  double pinhole_frames = kNotTimed;  ///< median_ms in frames of the scene's pinhole
  bool on_front = false;              ///< no contender is both faster and nearer to the truth
  bool best_setting = false;          ///< the least FLIP of its series on this scene
};

/// A scene with all its contenders.
struct ChartPanel {
  std::string scene;
  std::string title;
  int truth_samples = 0;
  ChartErrors noise_floor{};    ///< one half of the truth's samples against the other
  std::string truth_picture{};  ///< reduced; empty if no point has pictures
  std::vector<ChartPoint> points{};
  std::string given_name{};  ///< as --scenes has it
  std::string key{};         ///< under which its points are kept
  RankedErrors ranked = kPictureErrors;
};

}  // namespace softfocus
