#pragma once
// The table of methods that draw the scene: most draw lens views, pictures from many points of
// the lens, whose mean, over enough points, is the ground truth for the filters of dof/dof.h. A
// method is one entry: adding one touches its own file, the table and a test.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/scene.h"

namespace softfocus {

/// How the lens is sampled.
struct Sampling {
  int samples = 256;    ///< 1 to kMostSamples; with `until`, the most
  bool jitter = false;  ///< looks through all of the pixel, not through its centre alone
  /// Stops when half_set_rms() is at most this, which is tried at 16, 32, 64, ... samples.
  std::optional<double> until = {};
  ApertureShape aperture = {};
  /// Each tile takes as few samples as it needs, `samples` at most (samples_by_tile.h). Not with
  /// `until`.
  bool by_tile = false;
  /// How long the shutter is open, in frames, with the picture's frame in the middle
  /// (parameter::kShutter). The camera and the objects move on, focus and f-number do not. Of
  /// methods with LensViewMethod::has_shutter.
  double shutter_frames = 0.0;
  /// Of warped-accumulation: the views that are drawn, 1 to kMostDrawnViews; the others are warped.
  int drawn_views = 7;
};

/// The radius of the aperture in metres: A / 2, times the user's exaggeration of the circles.
double aperture_radius_m(const ThinLens& lens, double coc_scale);

struct SampleSums;
struct AccumulationBuffer;
struct FilteredViewsBuffer;
struct WarpedViewsBuffer;

/// What views of a scene leave for the next that differ in the lens alone: each method has its own.
struct LensViewMemory {
  std::shared_ptr<AccumulationBuffer> accumulation{};
  std::shared_ptr<FilteredViewsBuffer> filtered_views{};
  std::shared_ptr<WarpedViewsBuffer> warped_views{};
};

struct LensViewInput {
  const Scene& scene;
  const CameraMatrices& camera;  ///< the pinhole
  double frame = 0.0;
  /// The scene as that camera sees it, RGBA16F: gives the size, and the result its alpha.
  const Image& pinhole;
  double focus_m = 1.0;
  double aperture_radius_m = 0.0;
  Sampling sampling;
  Profile profile;
  /// Told how many samples are in, now and then, on the calling thread. May be empty.
  std::function<void(int samples)> progress;
  /// The prepared scene of the pinhole's picture, to be moved from. Null: the scene is prepared
  /// anew if the method needs it.
  PreparedScene* prepared = nullptr;
  LensViewMemory* memory = nullptr;             ///< to use again, if there is one
  std::shared_ptr<const StandIns> stand_ins{};  ///< of the scene's views, if any
  /// Of accumulation, filtered-views and ray-traced without `until` and `by_tile`: the samples that
  /// are in, if `progress` has thrown. The picture goes on from there, to the same bits. Of no
  /// samples at first; null: it cannot go on.
  SampleSums* begun = nullptr;
};

struct SampledPicture {
  Image picture;    ///< RGBA16F: linear colour, in alpha the pinhole's depth
  int samples = 0;  ///< that it is the mean of
  /// With `until`, half_set_rms() at the end; none if there were too few samples.
  std::optional<double> half_set_rms = {};
  /// With `by_tile`, of all pixels; `samples` is then the most that a tile has.
  std::optional<double> mean_samples = {};
  /// Of views that are warped: the share of their pixels that no drawn view has seen.
  std::optional<double> unseen = {};
};

struct LensViewMethod {
  std::string_view name;
  std::string_view summary;
  std::string_view needs;
  /// If this build lacks something: what, and how to get it. Else empty.
  std::string_view missing;
  /// The same bits for any number of threads. Throws std::runtime_error if a library fails.
  SampledPicture (*render)(const LensViewInput& input, ThreadPool& pool);
  /// Whether it takes notice of LensViewInput::sampling.
  bool samples_lens = true;
  /// Sampling::samples where none are given.
  int usual_samples = Sampling{}.samples;
  /// The same for Sampling::by_tile. 0: it cannot do that.
  int usual_most_by_tile = 0;
  /// Whether it can take Sampling::shutter_frames.
  bool has_shutter = false;
  /// Whether it takes Sampling::drawn_views, and then neither jitter nor until.
  bool warps_views = false;
};

std::span<const LensViewMethod> lens_view_methods();

/// The method of that name, or nullptr.
const LensViewMethod* find_lens_view_method(std::string_view name);

}  // namespace softfocus
