#pragma once
// The lens with a sensor behind it, or any camera whose field of view is not known in degrees.

#include "dof/lens.h"

namespace softfocus {

/// The pixels of a millimetre on a sensor: the picture is the largest part of it that has the
/// picture's shape, upright if the picture is. Times the distance between lens and sensor in
/// millimetres it is `pixels_per_tangent` of sensor_coc().
double pixels_per_sensor_mm(double sensor_width_mm, double sensor_height_mm, int width_px,
                            int height_px);

/// As pixel_coc(). `pixels_per_tangent` is the picture's height in pixels over the height that it
/// shows at distance 1: height / (2 tan(fov/2)).
PixelCoc sensor_coc(const ThinLens& lens, double pixels_per_tangent, double coc_scale);

}  // namespace softfocus
