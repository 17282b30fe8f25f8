#include "dof/sensor.h"

#include <algorithm>

namespace softfocus {

double pixels_per_sensor_mm(double sensor_width_mm, double sensor_height_mm, int width_px,
                            int height_px) {
  const bool turned = (width_px < height_px) != (sensor_width_mm < sensor_height_mm);
  const double across = turned ? sensor_height_mm : sensor_width_mm;
  const double down = turned ? sensor_width_mm : sensor_height_mm;
  return std::max(width_px / across, height_px / down);
}

PixelCoc sensor_coc(const ThinLens& lens, double pixels_per_tangent, double coc_scale) {
  const double aperture_radius_m = aperture_mm(lens) / 1000.0 / 2.0;
  return {static_cast<float>(aperture_radius_m / lens.focus_m * pixels_per_tangent * coc_scale),
          static_cast<float>(lens.focus_m)};
}

}  // namespace softfocus
