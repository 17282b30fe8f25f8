#pragma once
// The lens as photographers say it: what is in focus, the sensor, the blur at infinity.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/lens.h"
#include "tools/cli/option_values.h"
#include "tools/options/lens_options.h"
#include "tools/pictures/picture_file.h"
#include "tools/pictures/picture_notes.h"
#include "tools/refocus/depth/depth_map.h"
#include "tools/render/sharp_depths_option.h"

namespace softfocus {

/// The film or chip behind the lens.
struct Sensor {
  std::string name;
  double width_mm = 36.0;
  double height_mm = 24.0;
};

struct NamedSensor {
  std::string_view name;
  double width_mm, height_mm;
};
inline constexpr std::array kSensors{
    NamedSensor{"full-frame", 36.0, 24.0},  NamedSensor{"aps-c", 23.6, 15.6},
    NamedSensor{"aps-c-canon", 22.3, 14.9}, NamedSensor{"micro-four-thirds", 17.3, 13.0},
    NamedSensor{"1-inch", 13.2, 8.8},       NamedSensor{"phone", 9.8, 7.3},
    NamedSensor{"1/2.3-inch", 6.17, 4.55},  NamedSensor{"6x6cm", 56.0, 56.0},
    NamedSensor{"4x5-inch", 127.0, 102.0}};

/// The part of a picture that lies on the sensor.
struct Film {
  PictureBox box{};           ///< from the picture's first pixel
  double pixel_aspect = 1.0;  ///< a pixel's width over its height; circles are in heights
};

/// The lens as it was given.
struct PhotoLens {
  LensOptions lens;
  std::optional<double> fov_y_degrees;
  std::optional<Sensor> sensor;
  std::optional<Pixel> focus_at;
  bool autofocus = false;  ///< on what is at that pixel, or the middle
  bool focus_nearest = false;
  std::optional<SharpDepthRange> focus_range;
  std::optional<double> blur_at_infinity_px;  ///< a radius
  std::optional<PixelCoc> circles;            ///< in place of a lens: coc_of_circles()
  HeaderLens of_file;                         ///< where nothing above says it
  std::optional<Film> film;                   ///< none: all of the picture
};

void add_photo_lens_options(CLI::App& parser, PhotoLens& photo);

/// Throws UsageError for options that exclude each other.
void check_photo_lens(const CLI::App& parser);

/// How a lens was settled.
struct SettledLens {
  ThinLens lens{};
  double coc_scale = 1.0;
  double fov_y_degrees = 0.0;
  double pixel_aspect = 1.0;
  PixelCoc coc{};
  bool has_lens = true;  ///< false: --blur-at-infinity or --circles says how much is blurred
  std::optional<SharpDepthRange> range{};
  std::string focus_from;   ///< "--focus", "the median around pixel 3,4"
  std::string lens_from;    ///< "--focal-length and the default f-number"
  std::string camera_from;  ///< "--sensor full-frame", "the notes in a.exr"
};

/// The height of a picture over its height at distance 1, of the camera that was given or noted, or
/// by `focal_px`. A sensor's lens is focused at infinity.
double pixels_per_tangent(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                          std::optional<double> focal_px, int width, int height);

/// The depths that a lens is focused by: of a map, or of one that comes in bands of rows.
class FocusDepths {
 public:
  /// For a map of that size. Keeps the depths that `photo` asks for.
  FocusDepths(const PhotoLens& photo, int width, int height);
  /// The rows from `first_row` on.
  void add(std::span<const float> metres, int first_row);

  int width, height;
  Film film;
  Pixel pixel;                   ///< --focus-at, or the middle
  std::vector<float> around{};   ///< finite depths of the 5x5 pixels there
  std::size_t finite = 0;        ///< how many depths are, where the nearest are asked for
  std::vector<float> nearest{};  ///< of these the nearest thousandth and one more, or more

 private:
  std::size_t most_nearest_;  // 0: nobody asks
};

/// The lens for a picture of the map's size. The median around a pixel is of the 5x5 pixels there;
/// the nearest is the depth that one pixel in a thousand is nearer than. If nobody says what is in
/// focus, it is the middle or, where that is infinitely far, the nearest. Throws UsageError for a
/// lens that cannot be, a pixel outside, or a map in which nothing has a finite depth.
SettledLens settle_lens(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                        std::optional<double> focal_px, FocusDepths depths);
SettledLens settle_lens(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                        std::optional<double> focal_px, const DepthMap& depth);

/// Moves depths so that a lens focused at the range's near end leaves all within the range sharp,
/// and blurs what is nearer or farther as a lens does that is focused at that end: 1/z is what
/// circles are linear in, so 1/z' = 1/z + 1/near - 1/far beyond the range, and 1/near in it.
void move_range_into_focus(DepthMap& map, const SharpDepthRange& range);

}  // namespace softfocus
