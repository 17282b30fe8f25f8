#pragma once
// What a render did and how long it took, to read or as JSON. The text follows the
// thesis's report: times without depth of field, with it, and its cost.

#include <optional>
#include <string>

#include "dof/lens.h"
#include "scenes/scene.h"
#include "tools/render/options.h"

namespace softfocus {

/// Milliseconds of wall time.
struct StageTimes {
  double load = 0.0;
  double draw = 0.0;
  double focus = 0.0;   ///< finding the focus and the per-frame constants
  double choose = 0.0;  ///< of auto: looking at the picture and at the table
  double check = 0.0;   ///< of auto: holding the picture against views of the lens
  double filter = 0.0;  ///< the method, or the map that --show asks for
  double encode = 0.0;
  double write = 0.0;
};

/// The lens and filter as they were used.
struct UsedLens {
  ThinLens lens;
  double coc_scale = 1.0;
  DofSettings settings;
  std::optional<Pixel> autofocus_pixel;  ///< where the focus was found
  std::vector<SharpDepths> sharp_depths;
  std::vector<float> radii_px;  ///< by sharp_depths
};

/// What was at work: as it was asked for, or as auto chose it.
struct UsedMethod {
  MethodChoice method;
  Sampling sampling;
  std::optional<AutoMethod> choice;      ///< of auto
  std::optional<double> measured_error;  ///< of auto, if it was checked
};

/// What a method that draws the scene came to.
struct UsedSamples {
  int samples = 0;
  std::optional<double> half_set_rms;
  std::optional<double> mean_samples;  ///< of a pixel, with Sampling::by_tile
  std::optional<double> unseen = {};   ///< of views that are warped: SampledPicture::unseen
};

struct RenderRecord {
  std::string scene_name;
  std::string scene_title;
  std::size_t triangles = 0;
  Camera camera;                   ///< at the frame
  std::uint64_t picture_hash = 0;  ///< hash_image()
  std::string gl_renderer;         ///< of --gl; else empty
  UsedMethod used;
  std::optional<UsedLens> lens;        ///< none where the picture needs none
  std::optional<UsedSamples> sampled;  ///< if the method samples the lens
  std::vector<ChosenEffect> effects;   ///< on the finished picture
  std::optional<double> shaded_share;  ///< of pixels, where frames take from those before
  StageTimes ms;
};

std::string_view name_of(Show show);

/// Whether the method was at work, and not a map or the picture before it.
bool has_depth_of_field(const RenderOptions& options);

std::string text_report(const RenderOptions& options, const RenderRecord& record);
std::string json_report(const RenderOptions& options, const RenderRecord& record);

}  // namespace softfocus
