#pragma once
// Pictures of half and of twice the size, for wide blurs by a pyramid (Jimenez 2014): the way down
// does not flicker and the way up shows no blocks. All four channels are filtered alike.

#include <array>
#include <cstdint>
#include <functional>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// Weights of 6x6 pixels, in 128ths, with the result's pixel in their middle: five means of 4x4
/// pixels, one in the middle that counts half and four that overlap around it (a GPU reads them as
/// 13 bilinear samples). Symmetric: of the pixels at distances 1/2, 3/2 and 5/2 along each axis.
inline constexpr std::array<std::array<int, 3>, 3> kDownsample128ths{
    {{8, 6, 2}, {6, 5, 1}, {2, 1, 1}}};

/// Halves each side, rounded up. `result` is RGBA16F of (width + 1) / 2 by (height + 1) / 2 and
/// shares no memory with the source. At the edges pixels repeat.
///
/// Order: the sum begins with 0; row by row the products of columns 0, 2, 4 and then 1, 3, 5 are
/// added, each product and sum rounded to binary32.
void downsample(const ConstImageView& source, const ImageView& result, const Profile& profile,
                ThreadPool& pool);

/// How a picture is widened: by four pixels of the source along each axis, or by two.
enum class Widening : std::uint8_t {
  tent,      ///< of 3 bilinear samples, one pixel of the source apart, 1 2 1
  bilinear,  ///< one bilinear sample; blocks of the source can be seen
};

/// Weights of 4 pixels along an axis, in 16ths, for a result's pixel of even number; reversed for
/// an odd one.
inline constexpr std::array kTent16ths{1, 5, 7, 3};
inline constexpr std::array kBilinear16ths{0, 4, 12, 0};

struct Upsampling {
  float share = 1.0f;  ///< how much of the result comes from the source
  Widening widening = Widening::tent;
  bool alone = false;  ///< nothing of `own` but its alpha
};

/// The way back: the source has half of the result's width and height, rounded up. A result's
/// pixel (2k, 2m) is the weighted sum of the source's columns k - 2 to k + 1 and rows m - 2 to
/// m + 1. An odd column takes k - 1 to k + 2, an odd row m - 1 to m + 2. At the edges pixels
/// repeat. The sum s is mixed with `own`, of the result's size: own + share (s - own), operation by
/// operation in binary32; alone it stays s, with the alpha of `own`. The order of the sum is row by
/// row; a bilinear one leaves out the outer pixels.
void upsample(const ConstImageView& source, const ConstImageView& own, const Upsampling& how,
              const ImageView& result, const Profile& profile, ThreadPool& pool);

/// Rows of RGBA16F that are made when a pass needs them, so that they need not lie in memory as a
/// picture: by make(y, to), from several threads at once and for some rows more than once.
struct MadeRows {
  int width;
  int height;
  std::function<void(int y, std::uint16_t* to)> make;
};
using TakeRow = std::function<void(int y, const std::uint16_t* row)>;

/// As above, of made rows, and row by row into `take`. Need an isa with vectors.
void downsample_made(const MadeRows& source, const ImageView& result, const Profile& profile,
                     ThreadPool& pool);
void upsample_made(const ConstImageView& source, const MadeRows& own, const Upsampling& how,
                   const TakeRow& take, const Profile& profile, ThreadPool& pool);

/// The picture halved `levels` times, 1 or more, and widened as often, each alone ("dual filter",
/// after Bjørge 2015): a blur whose cost hardly grows with its width. Alpha stays.
void dual_filter(int levels, Widening widening, const ConstImageView& picture,
                 const ImageView& result, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
