#pragma once
// The table of depth encodings: what the numbers of a depth map mean. Adding one is a line of the
// table and its two functions.
//
//   code        the number in the file; of the encodings `by_full_scale`, 255 or 65535 counts as 1
//   distance_m  metres, along the axis or along the ray (DepthAlong)

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/lens.h"
#include "dof/parameters.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {

/// Numbers that encodings need beside the code: options of the command line.
struct DepthNumbers {
  std::optional<double> near_m{};
  std::optional<double> far_m{};
  std::optional<double> scale{};
  std::optional<double> offset{};
  std::optional<double> baseline_m{};
  std::optional<double> focal_px{};
  /// The least and the largest code of the map, for encodings that know nothing else.
  double least_code = 0.0;
  double largest_code = 1.0;
};

struct OfDepth {
  Parameter number;
  std::optional<double> DepthNumbers::*place;
};
// clang-format off
inline constexpr double kMostDepthNumber = 1e12;
inline constexpr std::array kDepthNumbers{
    OfDepth{{"near", "Of the encodings that need it: the near plane, or the nearest depth",
        parameter::kNearlyNothing, parameter::kLargest, 0.0, "m", "METRES", "near_m"},
        &DepthNumbers::near_m},
    OfDepth{{"far", "Likewise the far plane, or the farthest depth",
        parameter::kNearlyNothing, parameter::kLargest, 0.0, "m", "METRES", "far_m"},
        &DepthNumbers::far_m},
    OfDepth{{"scale", "Of metres, inverse, disparity: what a code is multiplied by",
        -kMostDepthNumber, kMostDepthNumber, 1.0, "", "S"}, &DepthNumbers::scale},
    OfDepth{{"offset", "Likewise what is added then; of middlebury its doffs",
        -kMostDepthNumber, kMostDepthNumber, 0.0, "", "O"}, &DepthNumbers::offset},
    OfDepth{{"baseline", "Of disparities: between the two cameras",
        parameter::kNearlyNothing, parameter::kLargest, 0.0, "m", "METRES", "baseline_m"},
        &DepthNumbers::baseline_m},
    OfDepth{{"focal-px",
        "Of disparities: focal length in pixels of the colour picture; also its field of view",
        1e-3, kMostDepthNumber, 0.0, "px", "PIXELS", "focal_px"}, &DepthNumbers::focal_px}};
// clang-format on

/// Whether a distance is measured along the camera's axis, as a depth buffer has it, or along the
/// pixel's ray, as a laser scanner has it.
enum class DepthAlong : std::uint8_t { axis, ray };

struct DepthEncoding {
  std::string_view name;
  std::string_view summary;
  /// The options it cannot do without: "near far", "baseline focal-px".
  std::string_view needs;
  /// Options that it understands beside them: "scale offset", 1 and 0 unless given.
  std::string_view takes;
  DepthAlong along = DepthAlong::axis;
  bool by_full_scale = false;  ///< whole numbers of a file are divided by their largest
  bool zero_is_missing = false;
  /// Whether what is infinitely far, or nothing, is said by infinity; else infinity is missing.
  bool infinity_is_far = false;
  /// Metres of a code. May give infinity; NaN or a number of 0 or less means missing.
  double (*distance_m)(double code, const DepthNumbers& numbers);
  /// The inverse.
  double (*code)(double distance_m, const DepthNumbers& numbers);
  bool by_ends = false;  ///< needs the map's least and largest code
};

std::span<const DepthEncoding> depth_encodings();

// Radii of circles in pixels in place of a depth, negative before the focus: read as depths at
// which coc_of_circles() has these circles. By R and f of that lens a radius r lies at f R / (R -
// r), so R must be above all of them, but little above, for R - r is what the halves of a picture
// know to a 2048th.

/// In no table: it is asked for by an option of its own.
const DepthEncoding& circles_encoding();

PixelCoc coc_of_circles(const DepthNumbers& numbers);

/// The encoding of that name, or nullptr.
const DepthEncoding* find_depth_encoding(std::string_view name);

/// Throws UsageError if a number that the encoding needs was not given, if one was given that it
/// does not understand (but for focal_px, which gives a field of view, too), or if near is not
/// before far.
void check_depth_numbers(const DepthEncoding& encoding, const DepthNumbers& numbers);

// The encoding that a depth map's numbers suggest if nobody says.

/// Findings in a plane's numbers.
struct NumbersSeen {
  std::size_t count = 0;
  std::size_t nans = 0;
  std::size_t infinities = 0;
  std::size_t zeros = 0;
  std::size_t negatives = 0;
  std::size_t different = 0;  ///< distinct whole numbers, of types that are; else 0
  std::size_t eighths = 0;    ///< of these the multiples of 8
  double least = 0.0;         ///< of finite numbers; 0 if there is none
  double largest = 0.0;
};

/// Looks at numbers that come in pieces.
class NumberCounter {
 public:
  explicit NumberCounter(NumberType type);
  void add(std::span<const float> values);
  NumbersSeen seen() const;

 private:
  NumbersSeen seen_{};
  double least_, largest_;
  std::vector<bool> there_;  // of whole numbers up to 16 bits
};

/// Whether there are numbers, but all are NaN.
bool knows_nothing(const NumbersSeen& seen);

NumbersSeen numbers_seen(const PlaneValues& values, NumberType type);

struct BelievedEncoding {
  const DepthEncoding* encoding = nullptr;  ///< or none: it cannot be told
  std::string why;                          ///< one sentence without its full stop
};

/// `is_ours`: the file has softfocus's notes, whose depths are metres. `channel` is the plane's
/// name, which tells Unreal's.
BelievedEncoding believed_encoding(const NumbersSeen& seen, NumberType type, bool is_ours,
                                   std::string_view channel);

}  // namespace softfocus
