#pragma once
// The thin lens: the six equations of the thesis, and the circle of confusion in the form
// that the methods use, a signed radius in pixels.
//
//            object z             lens    image v
//   axis  -----|---------|---------()-------|---
//                        z_f focus          v0 = image of the focus plane
//
// Distances along the axis are metres in front of the lens. Focal length, aperture and
// everything on the film are millimetres.
//
// Two conventions for the size of the film differ by z_f / (z_f - f), 5.3 % for a 50 mm lens
// focused at 1 m. This program fixes the camera's field of view and puts the film where the
// lens is focused: the film's height is 2 v0 tan(fov/2). Then focusing does not zoom, and the
// film's circle of confusion, scaled to pixels, is exactly the footprint that rays through
// the aperture leave on a pinhole image.

#include <array>
#include <cstddef>
#include <string_view>

#include "raster/images/image_view.h"
#include "raster/numbers/parameter.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// A lens focused on the plane at `focus_m`.
struct ThinLens {
  double focal_length_mm = 50.0;
  double f_number = 2.0;
  double focus_m = 2.0;
  bool operator==(const ThinLens&) const = default;
};

namespace parameter {

/// What is not 0, and far past anything real: no circle of such a lens is too large for binary32,
/// for its radius is at most coc_scale / (2 f_number) times a picture's height over 2 tan(fov/2).
inline constexpr double kNearlyNothing = 1e-9, kLargest = 1e9;

// clang-format off
inline constexpr Parameter kFocus{"focus", "Distance in focus, along the axis",
    kNearlyNothing, kLargest, ThinLens{}.focus_m, "m", "METRES", "focus_m"};
inline constexpr Parameter kFocalLength{"focal-length", "Focal length: a longer lens blurs more",
    kNearlyNothing, kLargest, ThinLens{}.focal_length_mm, "mm", "MM", "focal_length_mm"};
inline constexpr Parameter kFNumber{"f-number",
    "Focal length over aperture: a full stop, times 1.41, halves the light and blurs less",
    kNearlyNothing, kLargest, ThinLens{}.f_number, "", "N", "f_number"};
inline constexpr Parameter kCocScale{"coc-scale",
    "Exaggeration of the circles; 1 is the lens itself",
    0.0, kLargest, 1.0, "", "S", "coc_scale"};
inline constexpr Parameter kFov{"fov", "Vertical field of view",
    0.001, 179.999, 40.0, "degrees", "DEGREES", "fov_degrees"};
inline constexpr Parameter kSensorSide{"sensor", "A side of the sensor",
    kNearlyNothing, kLargest, 36.0, "mm"};
inline constexpr Parameter kBlurAtInfinity{"blur-at-infinity",
    "In place of a lens: the radius of the circle of what is infinitely far",
    0.0, kLargest, 0.0, "px", "PIXELS", "blur_at_infinity_px"};
// clang-format on

}  // namespace parameter

/// A number of the lens. Options, scene files, notes in pictures, the page and C read this table.
struct LensNumber {
  const Parameter& parameter;
  double ThinLens::*place;
  bool has_keys;  ///< scene files and options may give it at some frames
};
inline constexpr std::array kLensNumbers{
    LensNumber{parameter::kFocus, &ThinLens::focus_m, true},
    LensNumber{parameter::kFocalLength, &ThinLens::focal_length_mm, false},
    LensNumber{parameter::kFNumber, &ThinLens::f_number, true}};

/// A value for each number of the lens, in the order of kLensNumbers.
template <class Value>
struct OfLensNumbers {
  std::array<Value, kLensNumbers.size()> values{};

  constexpr Value& operator[](double ThinLens::*place) { return values[index_of(place)]; }
  constexpr const Value& operator[](double ThinLens::*place) const {
    return values[index_of(place)];
  }

  static constexpr std::size_t index_of(double ThinLens::*place) {
    std::size_t index = 0;
    while (kLensNumbers[index].place != place) ++index;
    return index;
  }
};

/// The reason why a lens is unusable, as a sentence, or nullptr. A usable lens has finite,
/// positive values and is focused farther away than its focal length. All other functions
/// need a usable lens.
const char* lens_error(const ThinLens& lens);

/// Aperture diameter A = f / N in millimetres (eq. 3).
double aperture_mm(const ThinLens& lens);

/// The distance in millimetres behind the lens of the image of an object at `distance_m`:
/// v = f z / (z - f), from the lens law 1/f = 1/z + 1/v (eq. 1). Negative (a virtual image)
/// for an object nearer than the focal length.
double image_distance_mm(const ThinLens& lens, double distance_m);

/// Diameter in millimetres of the circle of confusion on the film (eq. 2):
/// c = A |v - v0| / v = A f |z - z_f| / (z (z_f - f)).
double coc_on_film_mm(const ThinLens& lens, double distance_m);

/// The hyperfocal distance in metres: H = f^2 / (N c) + f (eq. 4, and the + f that makes it
/// exact). With the focus at H, everything from H/2 to infinity has a circle of at most
/// `largest_coc_mm`.
double hyperfocal_m(const ThinLens& lens, double largest_coc_mm);

/// The distances between which the circle on film stays within `largest_coc_mm`. With the
/// focus at the hyperfocal distance H or farther, `far_m` is infinite. With the focus at H/n
/// they are H/(n+1) and H/(n-1) (eq. 5 and 6, exact but for the + f in H).
struct SharpRange {
  double near_m;
  double far_m;
};
SharpRange sharp_range(const ThinLens& lens, double largest_coc_mm);

/// The circle of confusion as a signed radius in pixels, negative nearer than the focus:
///
///   r = (A/2) (z - z_f) / (z z_f) * height / (2 tan(fov/2)) * coc_scale
///     = radius_at_infinity_px * (z - z_f) / z
///
/// One constant a frame, three operations a pixel.
struct PixelCoc {
  float radius_at_infinity_px = 0.0f;  ///< of the horizon's circle, 0 or more
  float focus_m = 1.0f;                ///< more than 0
  bool operator==(const PixelCoc&) const = default;
};

/// `height_px` is the picture's height, `fov_y_degrees` its vertical field of view, between 0
/// and 180, `coc_scale` the user's exaggeration, 0 or more (1: the lens as it is).
PixelCoc pixel_coc(const ThinLens& lens, double fov_y_degrees, int height_px, double coc_scale);

/// The signed radius in pixels at a depth in metres, in binary32 and this order of operations.
/// Depth 0 gives -infinity.
inline float coc_radius_px(const PixelCoc& coc, float depth_m) {
  return coc.radius_at_infinity_px * (depth_m - coc.focus_m) / depth_m;
}

/// The height in millimetres of the film that sees `fov_y_degrees`: 2 v0 tan(fov/2).
double film_height_mm(const ThinLens& lens, double fov_y_degrees);

// The shape of the lens's opening, and so of every point that is out of focus.

inline constexpr int kMostApertureBlades = 64;
inline constexpr float kMostApertureStretch = 16.0f;

/// The method that has other apertures than round ones (scatter/aperture_scatter.h).
inline constexpr std::string_view kApertureMethod = "scatter-aperture";

/// Within the circle of confusion, which it touches. Things nearer than the focus show it upside
/// down.
struct Aperture {
  int blades = 0;             ///< corners of a regular polygon, 3 to kMostApertureBlades; 0: round
  float turn_degrees = 0.0f;  ///< counter-clockwise; without it a corner is up
  /// Height over width, 1/16 to 16: above 1 the width shrinks (an anamorphic lens), below 1 the
  /// height.
  float stretch = 1.0f;
  bool operator==(const Aperture&) const = default;
};

/// What is wrong with it, as a sentence, or nullptr.
const char* aperture_error(const Aperture& aperture);

// The lens with a sensor behind it, or any camera whose field of view is not known in degrees.

/// The pixels of a millimetre on a sensor: the picture is the largest part of it that has the
/// picture's shape, upright if the picture is. Times the distance between lens and sensor in
/// millimetres it is `pixels_per_tangent` of sensor_coc().
double pixels_per_sensor_mm(double sensor_width_mm, double sensor_height_mm, int width_px,
                            int height_px);

/// As pixel_coc(). `pixels_per_tangent` is the picture's height in pixels over the height that it
/// shows at distance 1: height / (2 tan(fov/2)).
PixelCoc sensor_coc(const ThinLens& lens, double pixels_per_tangent, double coc_scale);

// How large a picture's circles of confusion are: what a largest radius cuts, and what it would
// have to be to cut nothing.

struct CircleSizes {
  /// The largest radius in pixels, at most kLargestMaxCoc; 0 if no depth has a circle.
  float largest_px = 0.0f;
  /// The share of pixels, 0 to 1, whose circle is larger than the limit.
  double beyond_limit = 0.0;
};

/// `scene` is RGBA16F, depth in alpha. A NaN depth has no circle; an infinite one has the
/// horizon's.
CircleSizes circle_sizes(const ConstImageView& scene, const PixelCoc& coc, float limit_px,
                         ThreadPool& pool);

}  // namespace softfocus
