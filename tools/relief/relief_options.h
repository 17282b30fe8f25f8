#pragma once
// The options of `softfocus relief`, and functions that its actions share.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "scenes/relief/impostors/impostor_schedule.h"
#include "scenes/relief/impostors/relief_box.h"
#include "tools/cli/option_values.h"
#include "tools/options/run_options.h"

namespace softfocus {

/// The part of a relief, or of six faces, that is shown.
enum class ReliefPart : std::uint8_t { image, depth, normals, faces, unseen };

/// When a turn's work is done (scenes/relief/impostors/impostor_schedule.h): in the frame by one
/// thread or by all, in slices, or beside the frames.
enum class TurnSchedule : std::uint8_t { serial, split, slices, own_thread };

struct ReliefOptions {
  std::string action, input;
  std::string output;
  FileFormat format = FileFormat::png;
  std::vector<std::filesystem::path> scene_path;
  double frame = 0.0;
  PictureSize size{1024, 1024};  ///< of pictures
  PictureSize texels{256, 256};  ///< of the relief
  int depth_bits = 8;
  ReliefProjection projection = ReliefProjection::orthographic;
  bool normals = false;
  bool unlit = false;
  std::optional<glm::vec3> light;  ///< towards it, in the world
  bool traced = false;
  bool height_field = false;  ///< the input is a picture of heights
  std::filesystem::path colour;
  double height_m = 0.25;  ///< of a height of 1, if the longer side has a metre
  std::optional<float> empty_height;
  double yaw_degrees = 0.0, pitch_degrees = 0.0;
  double distance = 2.5;  ///< of the eye from the relief's middle, in diagonals of its box
  ReliefPart part = ReliefPart::image;
  Resampling resampling = Resampling::intertwined;
  bool fixed = false;
  int frames = 360;  ///< of a turn
  int every = 10;    ///< errors are measured once in so many frames
  double tolerance = 8.0, texels_per_pixel = 1.0, zoom = 1.0;
  int regions = 1;
  double join_texels = WarpRule::kJoinAll;
  int turns = 1;
  double cache_mb = 0.0;
  bool no_sprites = false;
  TurnSchedule schedule = TurnSchedule::split;
  bool warps_aside = false;
  int update_frames = 0;  ///< 0: not fixed
  double slice_ms = 2.0;
  bool predicts = false;
  bool rival = false;  ///< turn an octahedral atlas instead
  int views = 6;       ///< of the atlas, each way
  bool hemisphere = false;
  int parallax = 1;  ///< steps of the atlas
  bool moving_light = false;
  bool lights_pixels = false;
  double approach = 0.0;  ///< the eye begins so many times as far away; 0: it turns
  int levels = 1;
  bool box = false;  ///< a turn of six faces
  int slices = 0;    ///< of six faces, in place of warps; 0: none
  int bisections = 0;
  int runs = 20;
  bool json = false;
  PoolOptions pool;
};

/// Adds all options; they must live as long as the parser.
void add_relief_options(CLI::App& parser, const std::shared_ptr<ReliefOptions>& options);

WarpRule warp_rule(const ReliefOptions& options);

BoxRule box_rule(const ReliefOptions& options);

/// A point in the middle of the relief's box, and the box's diagonal.
glm::dvec3 relief_middle(const ReliefTexture& relief);
double relief_diagonal(const ReliefTexture& relief);

/// A camera about the relief's middle, as the options turn it away from the relief's own view.
Camera camera_before(const ReliefTexture& relief, const ReliefOptions& options);

/// `v` turned about a unit axis (Rodrigues).
glm::dvec3 turned_about(glm::dvec3 v, glm::dvec3 axis, double degrees);

/// Throws UsageError unless this build can trace rays.
void check_can_trace();

/// A relief of the picture of heights that is the input.
ReliefTexture relief_of_height_file(const ReliefOptions& options);

// --- the actions; each returns the exit status ---

int make_relief_file(const ReliefOptions& options);
int show_relief(const ReliefOptions& options);
int warp_view(const ReliefOptions& options);
int bench_relief(const ReliefOptions& options);
int turn_impostor(const ReliefOptions& options);
int turn_octahedral(const ReliefOptions& options);
int walk_scene(const ReliefOptions& options);
int turn_box(const ReliefOptions& options);
int show_box(const ReliefOptions& options);

/// From a scene's middle to its camera, as the options turn it.
glm::dvec3 turned_arm(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options);

/// A camera about a scene's middle, as the options turn it away from the scene's own. A diagonal is
/// twice the radius.
Camera camera_about(const ReliefMaker& maker, const Scene& scene, const ReliefOptions& options);

/// Writes a whole file, or to standard output for "-".
void write_relief_output(const std::string& output, std::span<const std::byte> bytes);

/// Reads the scene that an action takes, and says what it lacks.
Scene relief_scene(const ReliefOptions& options);

}  // namespace softfocus
