#pragma once
// Frames that take from the frames before: temporal anti-aliasing, refresh in groups, and frames
// that are reprojected in place of drawn.

#include <glm/vec2.hpp>
#include <vector>

#include "raster/effects/effect.h"
#include "raster/images/image.h"
#include "raster/temporal/frame_passes.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {

/// Of temporal-aa, refresh or reproject.
FrameEffect frame_effect(const ChosenEffect& chosen);

/// Frames that are drawn before the first, as its parameter warm-up says.
int warm_up_frames(const ChosenEffect& chosen);

/// What the next frame gets.
struct FrameHistory {
  int count = 0;                               ///< of the frames so far
  double frame = 0.0;                          ///< the last of them
  Image picture{};                             ///< what it shows, RGBA16F, depth in alpha
  Image frames{};                              ///< R32F: of how many frames each pixel is made
  double shaded_share = 1.0;                   ///< of its pixels
  Image key{};                                 ///< of Reproject: the last that was drawn
  double key_frame = 0.0;                      ///< and its frame
  Image drawn{}, velocity{}, found{}, next{};  ///< memory to use again
};

/// Draws a frame of the scene that follows on the history, which is then the frame's own.
void draw_next(PreparedScene& prepared, const FrameEffect& effect, double frame, int width,
               int height, FrameHistory& history, ThreadPool& pool);

/// Frame i of a sequence is first + i step. It begins `warm-up` frames before the first that is
/// asked for, so that a frame's bits depend on where the sequence begins, but not on which of its
/// frames are made anew.
struct FrameSequence {
  double first = 0.0;
  double step = 1.0;
  FrameHistory history{};
};

/// Draws what is missing up to this frame, from the beginning if the history is past it. The frame
/// is then history.picture.
void draw_up_to(PreparedScene& prepared, const ChosenEffect& effect, double frame, int width,
                int height, FrameSequence& sequence, ThreadPool& pool);

/// Whether the next frame is drawn and takes nothing from those before.
bool is_drawn_whole(const FrameEffect& effect, const FrameHistory& history);

/// draw_next() without its passes: draws what they read into history.drawn and history.velocity.
void draw_sources(PreparedScene& prepared, const FrameEffect& effect, double frame, int width,
                  int height, FrameHistory& history, ThreadPool& pool);

/// What the passes read then, if the next frame is not drawn whole: images of the history.
FrameSources sources_of(const FrameEffect& effect, const FrameHistory& history);

/// n offsets from the pixel's centre, in pixels from -0.5 to 0.5, as Halton's sequence in bases 2
/// and 3 goes, each axis moved to the middles of n equal columns or rows: so their mean is 0 and an
/// edge along an axis is as smooth as n places can make it.
std::vector<glm::dvec2> places_in_pixel(int count);

/// What temporal-aa shows of the scene at one moment after so many frames, 1 or more.
Image temporal_picture(PreparedScene& prepared, const TemporalAa& settings, double frame,
                       int frames, int width, int height, ThreadPool& pool);

}  // namespace softfocus
