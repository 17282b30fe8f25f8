#pragma once
// What can be set of the lens and of the methods. The texts are the help's and the page's.

#include "dof/dof.h"
#include "raster/numbers/parameter.h"

namespace softfocus::parameter {

/// What is not 0, and far past anything real: no circle of such a lens is too large for binary32,
/// for its radius is at most coc_scale / (2 f_number) times a picture's height over 2 tan(fov/2).
inline constexpr double kNearlyNothing = 1e-9, kLargest = 1e9;

// clang-format off
// --- the lens ---
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

// --- the methods ---
inline constexpr Parameter kMaxCoc{"max-coc",
    "Filter size: the largest radius, to which larger circles are cut; a larger filter takes "
    "longer",
    0.0, double{kLargestMaxCoc}, double{DofSettings{}.max_coc_px}, "px", "PIXELS", "max_coc_px"};
inline constexpr Parameter kLeak{"leak",
    "How readily a background gives its colour to what is before it",
    0.0, kLargest, double{DofSettings{}.leak}, "", "A"};
inline constexpr Parameter kBudget{"budget",
    "Of importance-ordered: the share of one-pass's work to do",
    0.0, 1.0, double{DofSettings{}.budget}, "", "SHARE"};
inline constexpr Parameter kMaxError{"max-error",
    "Of auto: the cheapest method whose mean FLIP should be at most this",
    0.0, 1.0, 0.02, "", "E", "max_error"};
inline constexpr Parameter kMaxTime{"max-time",
    "Of auto: the most accurate method that two cores of the reference machine should do in this "
    "time, beside drawing",
    0.0, kLargest, 0.0, "milliseconds", "MS"};
inline constexpr Parameter kApertureTurn{"aperture-turn",
    "Turns the blades counter-clockwise; without, a corner is up",
    -360.0, 360.0, 0.0, "degrees", "DEGREES"};
inline constexpr Parameter kAnamorphic{"anamorphic", "Height over width of what is out of focus",
    1.0 / double{kMostApertureStretch}, double{kMostApertureStretch}, 1.0, "", "RATIO"};
// clang-format on

}  // namespace softfocus::parameter
