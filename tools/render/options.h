// Everything that `render` is told.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/frame/frame.h"
#include "tools/cli/option_values.h"
#include "tools/cli/parser.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"
#include "tools/options/effect_options.h"
#include "tools/options/lens_options.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"
#include "tools/options/scene_options.h"
#include "tools/pictures/image_file.h"
#include "tools/render/sharp_depths_option.h"
#include "tools/sequence/sequence_options.h"

namespace softfocus {

inline constexpr std::array kShows{
    Choice<Show>{"image", Show::image}, Choice<Show>{"pinhole", Show::pinhole},
    Choice<Show>{"coc", Show::coc}, Choice<Show>{"depth", Show::depth},
    Choice<Show>{"wireframe", Show::wireframe}};

struct RenderOptions {
  std::string scene;
  std::string output;  ///< "-" for standard output
  FileFormat format = FileFormat::png;
  std::vector<std::filesystem::path> scene_path;
  PictureSize size;
  EffectOptions effects;  ///< on the finished picture
  int supersample = 1;    ///< what is drawn and filtered has so many times the width and height
  int samples = 4;        ///< of a pixel; complete() makes it 1 where options leave edges no place
  bool samples_are_given = false;
  double frame = 0.0;
  SceneLook look;  ///< in place of what the scene says
  MapOptions map;
  LightOptions lights;
  SequenceOptions sequence;  ///< of many pictures
  Profile profile;
  std::string profile_name = "ieee";
  std::filesystem::path profile_file;  ///< empty if the profile is a known one
  const Driver* gl = nullptr;          ///< renders the frame instead of the emulation
  Shaders shaders;                     ///< of --gl
  PoolOptions pool;
  MethodChoice method = find_method_choice(kDefaultMethod);
  Arithmetic arithmetic = Arithmetic::floats;
  Sampling sampling;           ///< of a method that draws the scene
  std::optional<Shard> shard;  ///< of the samples, whose sums `output` gets
  AutoGoal goal;               ///< of auto
  Verify verify = Verify::in_doubt;
  LensOptions lens;
  bool autofocus = false;
  std::optional<Pixel> autofocus_pixel;       ///< the picture's centre if none
  std::vector<SharpDepthRange> sharp_depths;  ///< in place of a focus, unless empty
  std::optional<float> max_coc_px;
  float leak = DofSettings{}.leak;
  float budget = DofSettings{}.budget;
  Aperture aperture;  ///< of kApertureMethod
  Show show = Show::image;
  std::optional<std::size_t> layers;  ///< of --layers
  std::optional<std::filesystem::path> report;
  std::optional<std::string> depth_output;
  bool json = false;
  bool verbose = false;
  bool quiet = false;
};

/// The size that is drawn.
PictureSize drawn_size(const RenderOptions& options);

/// How many surfaces of each pixel are drawn: as many as were asked for, or as the method needs.
std::size_t layers_of(const RenderOptions& options);

/// The memory that a picture takes while it is made, without the scene.
std::uint64_t bytes_of_a_frame(const RenderOptions& options);

void add_render_options(CLI::App& parser, RenderOptions& options);

/// Checks options against each other: throws UsageError for options that are missing, exclude each
/// other or do not fit together, and settles the format.
void complete(RenderOptions& options, const CLI::App& parser);

/// Gives the scene its look, and its lights what else is said of them. Throws UsageError for too
/// many lights, and for a way to draw that has no shadows.
void settle_scene(const RenderOptions& options, Scene& scene);

/// Throws UsageError if there is not the memory for the whole picture. complete() leaves it to
/// callers if the picture may be made by rows.
void check_whole_memory(const RenderOptions& options);

/// Throws UsageError if there is not the memory for what the scene needs besides: transparent
/// surfaces, soft shadows, samples of materials with shaders.
void check_scene_memory(const RenderOptions& options, const Scene& scene);

/// --autofocus may stand without a value, and CLI11 would take the next argument for
/// it, a scene perhaps. So what follows is joined to it with "=": the pixel, or "centre".
std::vector<std::string> with_autofocus_joined(std::vector<std::string> arguments);

// From the options of `render` to the shot that the frame maker takes.

/// What is asked for of this scene. Throws UsageError for a lens that cannot be. `sequence` is that
/// of frames that depend on those before.
Shot asked_shot(const RenderOptions& options, const Scene& scene, FrameSequence& sequence);

/// Says in the words of the options why a lens cannot be.
[[noreturn]] void refuse_lens(const LensError& error, const RenderOptions& options);

/// That of --frames, or of the one frame.
FrameSequence frame_sequence(const RenderOptions& options);

/// The effect that makes frames from those before, if there is one. Throws UsageError if it does
/// not go with the other options.
std::optional<ChosenEffect> checked_effect_of_frames(const RenderOptions& options,
                                                     const Scene& scene);

}  // namespace softfocus
