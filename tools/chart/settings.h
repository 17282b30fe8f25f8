#pragma once
// `chart`'s list of settings for each method of depth of field. subject.h has other subjects.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "dof/fixed_pictures/arithmetic.h"
#include "raster/effects/effect.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/relief/warp/resample.h"
#include "scenes/scene.h"
#include "scenes/shadows/volumes/volume_mask.h"
#include "tools/files/json.h"

namespace softfocus {

/// Shadows of all lights.
struct ChartShadows {
  ShadowKind kind = ShadowKind::projected;
  ShadowMapSettings map{};
  VolumeCount count = VolumeCount::z_fail;
  bool by_rays = false;
  bool kept = false;  ///< from frame to frame; else all is found anew
};

/// How an object is shown through a turn.
enum class TurnBy : std::uint8_t { redraw, impostor, slices, bisection, octahedral };
struct ChartTurn {
  TurnBy by = TurnBy::redraw;
  int frames = 192;  ///< a multiple of 16
  Resampling resampling = Resampling::intertwined;
  int regions = 1;
  double tolerance_texels = 8.0;
  int slices = 0;
  int views = 0;  ///< of an atlas, each way
  int parallax = 0;
};

/// A setting of an effect, of shadows or of a turn: "sigma", 2.
struct EffectSetting {
  std::string name{};
  double value = 0.0;
};

/// One contender: a method with its settings. Settings without effect on it are left out.
struct ChartEntry {
  std::string method;
  /// Null: accumulation, filtered or warped views of `samples` pictures, auto, another method that
  /// needs the scene, or what is_of_effects().
  const Method* filter = nullptr;
  const LensViewMethod* of_scene = nullptr;  ///< which takes no samples
  std::string profile = "ieee";              ///< a known profile
  std::optional<float> max_coc_px{};
  Arithmetic arithmetic = Arithmetic::floats;  ///< of two-pass
  int samples = 0;
  int drawn_views = 0;                  ///< of warped-accumulation
  std::optional<double> max_error{};    ///< of auto, which chooses from the others
  std::string chosen{};                 ///< by auto, once it has: "disc-layers, radius 16"
  std::vector<ChosenEffect> effects{};  ///< on the pinhole's picture, one after the other
  int supersample = 1;                  ///< drawn at so many times the width and height
  int multisample = 1;                  ///< samples of a pixel
  std::optional<ChartShadows> shadows{};
  std::optional<ChartTurn> turn{};
  EffectSetting setting{};  ///< in what effects, shadows or turns differ from others of the method
};

/// Whether it is the pinhole's picture with effects, or drawn larger and halved.
bool is_of_effects(const ChartEntry& entry);

/// Whether it is the pinhole's picture with something more: effects, a larger size, shadows; or a
/// turn.
bool is_of_pinhole(const ChartEntry& entry);

inline constexpr std::string_view kPinhole = "pinhole";
inline constexpr std::string_view kOfFilteredViews = "filtered-views";
inline constexpr std::string_view kOfWarpedViews = "warped-accumulation";

/// The names that --methods takes: every filter of dof/dof.h, accumulation, filtered-views,
/// warped-accumulation, what draws the scene in one go, and auto.
std::vector<std::string> chart_methods();

/// The settings of one method for pictures of that height; fewer if `quick`. Integers have radii
/// up to 64 pixels. A method without a line of its own in the table gets the last one.
std::vector<ChartEntry> chart_entries(const std::string& method, int height_px, bool quick);

/// {"max_coc_px": 16, "profile": "ieee"}, {"max_coc_px": 16, "profile": "ieee", "arithmetic":
/// "fixed-8"}, {"samples": 32}, {}, {"sigma": 2} or {"max_error": 0.02, "chosen": "disc-layers,
/// radius 16"}.
Json settings_json(const ChartEntry& entry);

/// "max-coc 16, d3d11", "32 samples", "max-error 0.02: disc-layers, radius 16"; the profile
/// ieee is left out.
std::string settings_text(const ChartEntry& entry);

/// Entries of one series differ in radius, in the number of samples or in the error alone:
/// "two-pass", "two-pass, d3d11".
std::string series_name(const ChartEntry& entry);

/// How an entry differs from others of its series: "max-coc 16", "32 samples", "max-error 0.02".
std::string setting_within_series(const ChartEntry& entry);

/// A name of its own for each entry, for files and for addresses in the page:
/// "two-pass-r16-d3d11".
std::string entry_id(const ChartEntry& entry);

}  // namespace softfocus
