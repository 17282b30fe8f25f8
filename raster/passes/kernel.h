#pragma once
// Filter kernels: tables of weights that a full-screen pass sums its neighbours by
// (Akenine-Moller et al. 2018, section 12.1).

#include <span>
#include <string_view>
#include <vector>

#include "raster/images/image_view.h"
#include "raster/images/sampler.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Weights of the pixels around a pixel.
struct Kernel {
  int width;                   ///< odd
  int height;                  ///< odd
  std::vector<float> weights;  ///< row by row from the top; of (0, 0) in the middle
};

struct NamedKernel {
  std::string_view name;
  std::string_view summary;
  Kernel kernel;
};

/// edge-detection, sharpen, box-3, gaussian-3, gaussian-5.
std::span<const NamedKernel> kernels();

/// The kernel of that name, or nullptr.
const Kernel* find_kernel(std::string_view name);

/// Weights of a Gaussian along one axis, an odd number of them, which sum to 1: exp(-d^2 / (2
/// sigma^2)) for whole distances d up to 3 sigma, divided by their sum in binary64. `sigma_px` is
/// from 0, which gives one weight of 1, to 341.
std::vector<float> gaussian_weights(double sigma_px);

/// A kernel of one row, for a pass along x, or of one column, for a pass along y.
Kernel row_kernel(std::vector<float> weights);
Kernel column_kernel(std::vector<float> weights);
/// Both at once: the square of the reads, one rounding to halves instead of two.
Kernel square_kernel(const std::vector<float>& weights);

/// The sum of weight(d) * source(p + d) at each pixel p of `result`. Both are RGBA16F and share no
/// memory. Alpha is that of source(p).
///
/// A result smaller than the source lies in its middle: what is around it in the source is a guard
/// band. Beyond the source its outermost pixels repeat. Both differences of size are even, 0 or
/// more.
///
/// Order: the sum begins with 0; products are added row by row from the top left. Each product and
/// sum is rounded to binary32, and the last sum as the profile stores halves.
void convolve(const Kernel& kernel, const ConstImageView& source, const ImageView& result,
              const Profile& profile, ThreadPool& pool);

/// The mean of 3x3 pixels by four bilinear reads of a texture in place of nine: between the four
/// pixels at the upper left (4/9), between two at the right (2/9) and two below (2/9), and the one
/// at the lower right (1/9). The first level is RGBA16F of the result's size; its edges repeat.
/// Alpha is the pixel's own.
///
/// The read between pixels is the profile's texture unit's. Coordinates are rounded, so weights are
/// a half only to about the place in pixels times 2^-24, but where a unit has 8-bit weights.
///
/// Order, in binary32: u = (x + 0.5 + dx) (1 / width); the sum of weight times read, beginning with
/// the first.
void box_in_four_reads(const Texture& source, const ImageView& result, const Profile& profile,
                       ThreadPool& pool);

}  // namespace softfocus
