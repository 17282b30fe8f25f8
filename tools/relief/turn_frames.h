#pragma once
// Frames that `relief turn` draws, measures and writes, whichever contender it turns.

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "tools/relief/relief_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {

template <class Work>
double milliseconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// 0 of none.
double mean_of(const std::vector<double>& values);
/// The value at a share of 0..1 of the sorted ones; 0 of none.
double sorted_at(std::vector<double> values, double share);

/// About the object's middle, from the scene's camera on: a full turn in --frames, or none with
/// --approach. Throws UsageError if --zoom would take the eye into the object.
Camera turn_camera(const Scene& scene, const ReliefMaker& maker, const ReliefOptions& options);

/// The scene's background at the camera's far distance.
glm::vec4 turn_background(const Scene& scene, const Camera& camera);

/// A frame of the turn, by the pipeline; `prepared` has a depth buffer of the picture's size.
void redraw_turned(PreparedScene& prepared, const CameraMatrices& camera,
                   const ReliefOptions& options, std::span<const Light> lights, glm::vec4 clear,
                   Image& picture, ThreadPool& pool);

/// Copies a part from a blank RGBA16F picture of the same size. It reads the first row alone, which
/// stays in the cache: reading all takes longer than a warp.
void clear_area(const Image& blank, const Rectangle& area, Image& to, ThreadPool& pool);

/// Errors of the measured frames.
struct TurnErrors {
  std::vector<double> flip, object_flip, outline_px;
  double most_outline_px = 0.0;
  std::size_t lost = 0, gained = 0, seen = 0;  ///< pixels, of all measured frames
};

void measure_frame(const Image& redrawn, const Image& shown, std::uint16_t background_depth,
                   ThreadPool& pool, TurnErrors& errors);
void print_errors(const TurnErrors& errors);

/// The files of frames; none without -o.
struct TurnPictures {
  std::optional<NumberedName> name;
  FileFormat format = FileFormat::png;
};

/// Throws UsageError if -o has no number or no known ending.
TurnPictures turn_pictures(const ReliefOptions& options);

/// The redrawn frame, and what is shown to its right.
void write_pair(const TurnPictures& pictures, int frame, const Image& redrawn, const Image& shown);

}  // namespace softfocus
