#pragma once
// Tone mapping: light of any strength into 0 to 1, as a screen shows it. Curves of quotients of
// polynomials, colour by colour.

#include <array>
#include <string_view>

#include "raster/images/image_view.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"

namespace softfocus {

/// (x (a x + b) + c) / (x (d x + e) + f) + g, times h.
struct ToneCurve {
  float a, b, c, d, e, f, g, h;
};

struct NamedToneCurve {
  std::string_view name;
  std::string_view summary;
  ToneCurve curve;
};

/// Reinhard et al. 2002: x / (1 + x). Narkowicz 2016: a fit of ACES's curve, cut to 1. Hable 2010,
/// with a white of 11.2.
inline constexpr std::array kToneCurves{
    NamedToneCurve{"reinhard",
                   "x / (1 + x), after Reinhard et al. 2002",
                   {0.0f, 1.0f, 0.0f, 0.0f, 1.0f, 1.0f, 0.0f, 1.0f}},
    NamedToneCurve{"aces",
                   "a fit of the ACES film curve, after Narkowicz 2016",
                   {2.51f, 0.03f, 0.0f, 2.43f, 0.59f, 0.14f, 0.0f, 1.0f}},
    NamedToneCurve{"hable",
                   "a film curve with a toe, white at 11.2, after Hable 2010",
                   {0.15f, 0.05f, 0.004f, 0.15f, 0.5f, 0.06f, -0.02f / 0.3f, 1.3790642f}}};

/// The curve of that name, or nullptr.
const ToneCurve* find_tone_curve(std::string_view name);

/// The curve of exposure times each colour, cut to 0 and 1; what is below 0 or NaN is 0, infinity
/// the largest half. Alpha stays. Order as the formula reads, each operation rounded to binary32.
void tone_map(const ToneCurve& curve, float exposure, const ConstImageView& picture,
              const ImageView& result, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
