#pragma once
// A running average over frames, c = a new + (1 - a) old, where `old` was reprojected and is held
// to what the pixel's neighbours show now: temporal anti-aliasing (Karis 2014; Salvi 2016; Yang et
// al. 2020).

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// What `old` is cut to, in each axis of a space of brightness and two differences of colours,
/// where colours of one surface lie close to a line.
enum class HistoryBox {
  none,
  extent,    ///< from the least to the largest of 3x3 pixels
  variance,  ///< the mean of 3x3 pixels, more or less some standard deviations
};

struct AccumulateSettings {
  float least_share = 0.1f;  ///< of the new frame, above 0 to 1
  HistoryBox box = HistoryBox::variance;
  float deviations = 1.0f;  ///< of HistoryBox::variance
};

/// Frames are counted up to so many.
inline constexpr float kLongestHistory = 1024.0f;

/// All of one size. `old` is what reverse_reproject() found: RGBA16F, of n frames in alpha. Writes
/// the average, RGBA16F with the alpha of `now`, and into `frames`, R32F, of how many frames it is.
/// For each pixel, in binary32:
///
///   where n > 0 and the sum of red, green and blue, without signs, is below 2^18
///     Y = (r + b) / 4 + g / 2, Co = (r - b) / 2, Cg = g / 2 - (r + b) / 4
///     old cut to the box in Y, Co and Cg; and if any was cut
///       t = Y - Cg, g = Y + Cg, b = t - Co, r = t + Co
///     a = the larger of 1 / (n + 1) and the least share
///     old + a (now - old), and the lesser of n + 1 and kLongestHistory
///   else now, and 1
///
/// The box of variance: m = sum / 9, v = the larger of sum of squares / 9 - m m and 0, m - d
/// sqrt(v) to m + d sqrt(v), summed row by row from the top left. At the edges pixels repeat.
void accumulate(const AccumulateSettings& settings, const ConstImageView& now,
                const ConstImageView& old, const ImageView& result, const ImageView& frames,
                const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
