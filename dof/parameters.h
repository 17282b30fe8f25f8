#pragma once
// What can be set of the methods; dof/lens.h has the lens. The texts are the help's and the page's.

#include "dof/dof.h"
#include "raster/numbers/parameter.h"

namespace softfocus::parameter {

// clang-format off
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
inline constexpr Parameter kApertureBlades{"aperture-blades",
    "Straight blades of the aperture, 3 to 64; 0: it is round",
    0, kMostApertureBlades, 0, "", "N", "aperture_blades", 1};
inline constexpr Parameter kApertureTurn{"aperture-turn",
    "Turns the blades counter-clockwise; without, a corner is up",
    -360.0, 360.0, 0.0, "degrees", "DEGREES"};
inline constexpr Parameter kAnamorphic{"anamorphic", "Height over width of what is out of focus",
    1.0 / double{kMostApertureStretch}, double{kMostApertureStretch}, 1.0, "", "RATIO"};
// clang-format on

}  // namespace softfocus::parameter
