#pragma once
// The way of a frame: a shot is drawn, the lens focuses on what was drawn, a method makes the
// picture, and effects finish it. make_frame() does all of it. Callers that keep the drawing for
// another lens, or time a part alone, call the parts.

#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/sharp_depths.h"
#include "scenes/auto/auto_picture.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/lens_views/sample_sums.h"
#include "scenes/lens_views/shard.h"
#include "scenes/temporal/frame_history.h"

namespace softfocus {

/// The name that lets the scene choose its method (dof/auto/auto_method.h).
inline constexpr std::string_view kAutoMethod = "auto";

/// A method of either table: a filter of the drawn picture or one that draws the scene. If it is
/// neither, the scene chooses.
struct MethodChoice {
  const Method* filter = nullptr;
  const LensViewMethod* of_scene = nullptr;

  bool is_auto() const { return filter == nullptr && of_scene == nullptr; }
  std::string_view name() const {
    return is_auto() ? kAutoMethod : filter != nullptr ? filter->name : of_scene->name;
  }
  /// The opaque surfaces of a pixel that it reads.
  std::size_t layers() const { return filter != nullptr ? filter->layers : 1; }
  bool samples_lens() const { return of_scene != nullptr && of_scene->samples_lens; }
  bool warps_views() const { return of_scene != nullptr && of_scene->warps_views; }
  /// Whether the aperture may have blades, and whether these may be turned and stretched.
  bool has_blades() const { return samples_lens() || has_any_aperture(); }
  bool has_any_aperture() const { return name() == kApertureMethod; }
  bool has_shutter() const { return of_scene != nullptr && of_scene->has_shutter; }
  /// Whether it can have all circles at no cost.
  bool takes_any_radius() const { return filter != nullptr && filter->any_radius_costs_the_same; }
};

/// The method of that name, or of the pipeline's file of that name (scenes/load/pipeline_file.h,
/// which says what is thrown); of any other name, auto.
MethodChoice find_method_choice(std::string_view name);

/// Which picture is wanted: with depth of field, without, or a map of what it works from.
/// A wireframe has the colours of pixels at the borders of triangles that are seen, and elsewhere
/// the background.
enum class Show : std::uint8_t { image, pinhole, coc, depth, wireframe };

/// Neither with depth of field nor without.
inline bool is_map(Show show) { return show != Show::image && show != Show::pinhole; }

/// The lens as it is asked for.
struct ShotLens {
  ThinLens lens{};
  double coc_scale = 1.0;
  /// The pixel of the picture whose depth is the focus, in place of the lens's.
  std::optional<glm::ivec2> focus_at = {};
  bool focuses_on_a_thing = false;  ///< the nearest pixel to focus_at that is no background
  /// In pixels of what is drawn. `coc` is not looked at.
  DofSettings settings = {};
  bool cuts_no_circle = false;  ///< max_coc_px is the largest circle of what is drawn
  std::vector<SharpDepths> sharp_depths = {};  ///< in place of a focus, unless empty
};

struct Shot {
  const Scene* scene = nullptr;  ///< null: of a picture, which `DrawnFrame` holds
  double frame = 0.0;
  int width = 0, height = 0;  ///< of the picture
  int supersample = 1;        ///< 1 or 2: what is drawn has so many times the width and height
  /// Of a pixel, 1, 4 or 8: several make edges smooth. 1 where they cannot be found.
  int samples = 1;
  Show show = Show::image;
  MethodChoice method = {};
  Arithmetic arithmetic = Arithmetic::floats;  ///< of two-pass
  /// The opaque surfaces of a pixel that are drawn, in place of as many as the method reads. 0: one
  /// picture alone, which what is transparent is blended into.
  std::optional<std::size_t> layers = {};
  /// Whether what is drawn is wanted as one picture too, with what is transparent: a filter and its
  /// lens do without.
  bool blends = true;
  std::optional<ShotLens> lens = {};  ///< none: the picture needs none
  Sampling sampling = {};
  std::optional<Shard> shard = {};  ///< of accumulation's samples
  AutoGoal goal = {};
  Verify verify = Verify::in_doubt;
  std::optional<float> most_coc_px = {};   ///< that auto must keep to
  std::vector<ChosenEffect> effects = {};  ///< in their order; one of frames comes first
  FrameSequence* sequence = nullptr;       ///< for an effect of frames; null: it begins here
  /// Of the scene's impostors, kept over frames; null: they are made for this one.
  std::shared_ptr<const StandIns> stand_ins = {};
  Profile profile = {};
};

/// A scene's shot by its own camera, lens, shutter and effects, with `method`.
Shot shot_of(const Scene& scene, double frame, int width, int height, const MethodChoice& method);

/// A frame before its depth of field.
struct DrawnFrame {
  CameraMatrices view{};
  FrameParts parts{};
  /// The opaque surfaces of a pixel that `parts` has, with those that are transparent. 0: a picture
  /// alone; a method that reads more has it drawn.
  std::size_t layers = 0;
  std::shared_ptr<const StandIns> stand_ins{};  ///< by which it was drawn, if any
  /// That were drawn as such; none: all of the scene's.
  std::optional<std::size_t> triangles{};
  std::vector<std::uint16_t> objects{};  ///< DofInput::objects, if the method reads them
  std::optional<double> shaded_share{};  ///< of the pixels, where frames take from those before
};

/// The lens as a frame uses it, in pixels of what is drawn, or, once a frame is made, of the
/// picture.
struct UsedLens {
  ThinLens lens{};
  double coc_scale = 1.0;
  double aperture_radius_m = 0.0;  ///< exaggerated by coc_scale
  DofSettings settings{};
  std::vector<float> radii_px{};            ///< by ShotLens::sharp_depths
  std::optional<glm::ivec2> focus_at = {};  ///< whose depth became the focus
};

/// A lens that cannot be, once its focus is known, or that Shot::arithmetic cannot hold.
struct LensError : std::runtime_error {
  LensError(const char* error, const UsedLens& used) : std::runtime_error(error), lens(used) {}
  UsedLens lens;
};

struct Frame {
  Image picture{};              ///< RGBA16F, depth in alpha; of a shard, the pinhole's
  std::vector<Image> behind{};  ///< the layers behind, shown likewise, unless it is an image
  CameraMatrices view{};
  std::optional<UsedLens> lens{};
  MethodChoice method{};  ///< as it was asked for, or as auto chose it; so is `sampling`
  Sampling sampling{};
  std::optional<SampledPicture> sampled{};  ///< without its picture, if the lens was sampled
  std::optional<AutoPicture> chosen{};      ///< of auto, without its picture
  SampleSums sums{};                        ///< of a shard
  std::optional<double> shaded_share{};     ///< DrawnFrame's
  int samples = 1;                          ///< of a pixel
};

enum class FrameStage : std::uint8_t {
  drawing,
  focusing,
  choosing,
  filtering,  ///< or showing a map
  sampling,
  checking,
  halving,
  effects,
  done
};

/// Callbacks between the stages; any may be empty.
struct FrameHooks {
  std::function<void(FrameStage)> on_stage;  ///< told as each begins
  std::function<void(int samples)> on_samples;
  std::function<void(int points)> on_light_points;  ///< of soft shadows
  std::function<void(bool are_placed)> on_shadows;  ///< as PreparedScene has it
  /// Told of what was drawn, before the method.
  std::function<void(const DrawnFrame&, const std::optional<UsedLens>&)> on_drawn;
  /// A driver that draws and filters in place of the emulation.
  std::function<FrameParts(const CameraMatrices&, int width, int height, std::size_t layers)> draw;
  std::function<Image(const Method&, const DofSettings&, const Image&)> filter;
};

/// Memory that a frame leaves for the next of the same scene and profile.
struct FrameMemory {
  std::optional<PreparedScene> prepared{};
  LensViewMemory views{};
  Image picture{};       ///< memory for the next, if it has its size
  bool is_last = false;  ///< views of the lens may take `prepared`
  /// If the picture is to go on after FrameHooks::on_samples has thrown: as LensViewInput has it.
  std::optional<SampleSums> begun{};
};

/// The frame of a shot. Throws LensError, and what a library throws that fails. The same bits for
/// any number of threads.
Frame make_frame(const Shot& shot, ThreadPool& pool, const FrameHooks& hooks = {});

// --- its parts, in their order ---

/// Draws the shot, into the memory of `drawn`.
void draw_shot(const Shot& shot, FrameMemory& memory, DrawnFrame& drawn, ThreadPool& pool,
               const FrameHooks& hooks = {});

/// Focuses the shot's lens, if it has one, on what was drawn.
std::optional<UsedLens> focused_lens(const Shot& shot, const DrawnFrame& drawn, ThreadPool& pool);

/// By any method: a filter, views of the lens, or what auto chooses of these. Or a map.
Frame make_picture(const Shot& shot, const DrawnFrame& drawn, const std::optional<UsedLens>& lens,
                   FrameMemory& memory, ThreadPool& pool, const FrameHooks& hooks = {});

/// Halves a picture that was drawn at twice the size, with its lens's lengths, and adds effects.
void finish_picture(const Shot& shot, Frame& frame, ThreadPool& pool, const FrameHooks& hooks = {});

/// The scene as seen from the lens, for callers that take views step by step. It refers to the
/// arguments.
LensViewInput lens_views_of(const Shot& shot, const DrawnFrame& drawn, const UsedLens& lens);

// --- effects ---

/// Whether it makes frames of a scene from those before (scenes/temporal).
inline bool is_of_frames(const Effect& effect) { return effect.filter == nullptr; }

/// Makes the velocity that an effect reads, of the picture as it comes to the effect.
using MakeVelocity = std::function<Image(const ChosenEffect& chosen, const Image& picture)>;

/// The picture with all of them, in their order, but for the one of frames. `make_velocity` is
/// called for those that read one.
Image with_effects(Image picture, const std::vector<ChosenEffect>& effects,
                   const MakeVelocity& make_velocity, const Profile& profile, ThreadPool& pool);

}  // namespace softfocus
