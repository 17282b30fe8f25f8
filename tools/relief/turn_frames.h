#pragma once
// Frames that `relief turn` draws, measures and writes, whichever contender it turns.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "tools/cli/progress.h"
#include "tools/files/findings.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {

/// The stage of a turn: the scene, about the object's middle from the scene's camera on, a full
/// turn in --frames, or none with --approach.
struct TurnStage {
  /// Throws UsageError if -o has no number or no known ending, or if --zoom would take the eye into
  /// the object.
  explicit TurnStage(const ReliefOptions& told);
  TurnStage(const TurnStage&) = delete;
  TurnStage& operator=(const TurnStage&) = delete;

  const ReliefOptions& options;
  FileFormat format = FileFormat::png;  ///< by the name, which is set after it
  std::optional<NumberedName> name;     ///< of the files of frames; none without -o
  Scene scene;
  ThreadPool pool;
  ReliefMaker maker;       ///< refers to the scene, as does `prepared`
  PreparedScene prepared;  ///< with a depth buffer of the pictures' size
  Camera camera;
  glm::vec4 clear;                 ///< the scene's background at the camera's far distance
  std::uint16_t background_depth;  ///< its alpha, a half
  Image redrawn, shown, blank;     ///< RGBA16F; `shown` is blank at first
  Progress progress{};
  TimeLeft left{};
  std::chrono::steady_clock::time_point shown_at{};
};

/// Names by -o, which must have a number.
std::optional<NumberedName> frame_names(const ReliefOptions& options, FileFormat& format);

/// Two pictures side by side.
void write_pair(const Image& left, const Image& right, const std::filesystem::path& file,
                FileFormat format);

/// Says, twice a second, which of the frames comes next. Call it where nothing is timed.
void show_frame(TurnStage& stage, int frame, int frames);

/// The scene's background at the camera's far distance.
glm::vec4 turn_background(const Scene& scene, const Camera& camera);

CameraMatrices turned_camera(const TurnStage& stage, double frame);

/// Draws a frame by the pipeline.
void redraw(TurnStage& stage, const CameraMatrices& camera, std::span<const Light> lights);

/// Copies a part from a blank RGBA16F picture of the same size. It reads the first row alone, which
/// stays in the cache: reading all takes longer than a warp.
void clear_area(const Image& blank, const Rectangle& area, Image& to, ThreadPool& pool);

/// Errors of the measured frames.
struct TurnErrors {
  std::vector<double> flip, object_flip, outline_px;
  double most_outline_px = 0.0;
  std::size_t lost = 0, gained = 0, seen = 0;  ///< pixels, of all measured frames
};

/// Compares a frame with the redrawn one, and writes both, side by side, if there is -o.
void measure_frame(TurnStage& stage, int frame, const Image& shown, TurnErrors& errors);
void add_errors(const TurnErrors& errors, Findings& found);

/// The report's first line: whether frames take less time by `what` than redrawn, and how far off
/// they are. `why` says what the time is for.
void add_verdict(const std::string& what, double shown_ms, double redrawn_ms,
                 const std::string& why, const TurnErrors& errors, Findings& found);

}  // namespace softfocus
