#pragma once
// The bilateral filter (Tomasi and Manduchi 1998): a blur that leaves out neighbours unlike the
// pixel. Likeness of depth makes it a joint one (Petschnigg et al. 2004).

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct BilateralSettings {
  /// Standard deviation of the distance's Gaussian in pixels, 0 to 20; it reaches as far as
  /// gaussian_weights().
  double sigma_px = 2.0;
  /// The distance of two colours, in linear light, from which on they are unlike; 0: none are.
  float colour_tolerance = 0.1f;
  /// The same of depths, as a share of the pixel's; 0: none are.
  float depth_tolerance = 0.0f;
};

/// Each pixel p of RGBA16F becomes the mean of its neighbours q, the picture's edges repeating, by
/// weights
///
///   g(dx) g(dy) l(|c_q - c_p|^2 / colour_tolerance^2) l((z_q - z_p)^2 / (depth_tolerance z_p)^2)
///
/// with g of gaussian_weights(), l(s) = (1 - s)^2 up to s = 1 and then 0 (Tukey's biweight, which
/// needs no exponential), and 1 for the pixel itself. z is alpha, up to 65504, which stays.
/// `result` has the source's size and shares no memory with it.
///
/// Order, in binary32, row by row from the top left:
///   s_c = ((r r + g g) + b b) f with the differences r, g, b and f = 1 / colour_tolerance^2
///   q = (z_q - z_p) / (depth_tolerance z_p);  s_d = q q
///   w = ((g(dx) g(dy)) l(s_c)) l(s_d);  sum += w c_q;  weight += w;  sum / weight
/// A neighbour whose s is NaN counts nothing, if its colour is finite.
void bilateral(const BilateralSettings& settings, const ConstImageView& source,
               const ImageView& result, const Profile& profile, ThreadPool& pool);

/// f of the formula; 0 without a tolerance. The shader gets it so.
float bilateral_colour_factor(const BilateralSettings& settings);

}  // namespace softfocus
