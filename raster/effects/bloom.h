#pragma once
// Bloom: bright light that a lens and the eye scatter over its surroundings, by a pyramid (Jimenez
// 2014), and by one Gaussian.

#include <limits>

#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

struct BloomSettings {
  float threshold = 1.0f;  ///< what is darker does not bloom
  float knee = 0.5f;       ///< half the width of the way from nothing to all, 0 to threshold
  float strength = 0.1f;   ///< the share of the bright light that is scattered, 0 to 1
  int levels = 6;          ///< of the pyramid, 1 to 12: the widest is 2^levels pixels
  float spread = 0.6f;     ///< how much of each level comes from wider ones, 0 to 1
  /// Whether bright pixels count less in the first mean, so that those that move by a part of a
  /// pixel do not flicker (Karis 2013). They lose light by it.
  bool is_steady = false;
};

/// What the bright pass computes with; the shaders get it so.
struct BrightPass {
  float threshold, knee;
  float begin;          ///< threshold - knee
  float double_knee;    ///< 2 knee
  float square_factor;  ///< 1 / (4 knee), or 0
  bool is_steady;
  /// What has less in alpha is not bright.
  float beyond = -std::numeric_limits<float>::infinity();
};
BrightPass bright_pass_of(const BloomSettings& settings);
inline constexpr BrightPass kNothingBright{65504.0f, 0.0f, 65504.0f, 0.0f, 0.0f, false};

/// picture + strength (scattered - bright). So light is moved, and its sum stays but for what the
/// edges repeat and `is_steady` takes. With m the largest of red, green and blue:
///
///   bright    = colour max(m - threshold, x^2 / (4 knee)) / m,  x = m - threshold + knee cut to 0
///               and 2 knee
///   D_1       = downsample(bright), D_i+1 = downsample(D_i); pyramid.h
///   B_n       = D_n, B_i = D_i + spread (upsample(B_i+1) - D_i), scattered = upsample(B_1)
///
/// Steady: D_1 = downsample(w bright) / downsample(w), w = 1 / (1 + the largest of bright). A
/// colour below 0 or NaN is 0 to bloom, one above the largest half that half. Alpha stays. Each
/// picture is RGBA16F.
void bloom(const BloomSettings& settings, const ConstImageView& picture, const ImageView& result,
           const Profile& profile, ThreadPool& pool);

struct GaussianBloomSettings {
  float threshold = 1.0f;  ///< these three as of BloomSettings
  float knee = 0.5f;
  float strength = 0.1f;
  double sigma_px = 8.0;  ///< the standard deviation, 0 to 341
};
BrightPass bright_pass_of(const GaussianBloomSettings& settings);

/// Bloom as it is written first (after James and O'Rorke 2004): picture + strength (scattered -
/// bright). `scattered` is the bright light through one Gaussian of the picture's own size, along x
/// and then along y (kernel.h). Its cost grows with sigma.
void bloom_by_gaussian(const GaussianBloomSettings& settings, const ConstImageView& picture,
                       const ImageView& result, const Profile& profile, ThreadPool& pool);

/// The passes of both: `bright`, by its weight, and the weight in alpha; and picture + strength
/// (scattered - bright).
void find_bright_light(const BrightPass& pass, const ConstImageView& picture,
                       const ImageView& result, const Profile& profile, ThreadPool& pool);
/// Whether find_bright_light() would find any: it looks no further than the first.
bool has_bright_light(const BrightPass& pass, const ConstImageView& picture, ThreadPool& pool);
/// What add_scattered_light() gives for light that is 0 everywhere, if nothing is bright.
void add_no_light(const ConstImageView& picture, const ImageView& result, const Profile& profile,
                  ThreadPool& pool);
void add_scattered_light(const BrightPass& pass, float strength, const ConstImageView& picture,
                         const ConstImageView& scattered, const ImageView& result,
                         const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
