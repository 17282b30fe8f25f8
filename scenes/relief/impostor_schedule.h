#pragma once
// When an impostor's work is done (7.4 and 8.3 to 8.7 of Clua 2004). A frame clears, maps what is
// ready, and is shown. An *update* is what makes something new ready:
//
//   renewals aside   the object drawn anew as a relief; each frame warps the relief that is there
//   warps aside      the warp, too, and a new relief first if it is stale: Clua's schedules. A
//   frame
//                    maps the last warp that is done, as it is
//
//   in the frame     a frame does all it needs; the threads of its pool share each step. With one
//                    thread this is 8.3, with several 8.7, but for the join, which is not needed
//   slices           after a frame's own work a slice of the update is done. Fixed slices (8.4): an
//                    update takes so many frames. Variable ones (8.5): pieces until time is up
//   own thread       a thread does the update beside the frames (8.6)
//
// An update that begins in frame f with `update_frames` K is shown from frame f + K on, whatever
// its slices or its thread have taken: pictures depend on no clock. With K = 0 it is shown in the
// first frame that finds it done, which does.
//
// With prediction (7.4) an update is for the eye that will be (eye_motion.h): it begins K frames
// before its relief is stale, and the relief is drawn for an eye farther on, from which the one of
// that frame is just within the tolerance. So a relief serves before its eye is reached, and after.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "raster/threads/background.h"
#include "scenes/relief/eye_motion.h"
#include "scenes/relief/impostor.h"

namespace softfocus {

enum class ScheduleKind : std::uint8_t { in_frame, slices, own_thread };

struct ImpostorSchedule {
  ScheduleKind kind = ScheduleKind::in_frame;
  bool warps_aside = false;  ///< not of in_frame
  int update_frames = 0;     ///< K, 0 to kMostUpdateFrames
  bool predicts = false;
};
inline constexpr int kMostUpdateFrames = 64;

/// What is being made ready.
struct ImpostorUpdate {
  int begun;          ///< the frame
  bool draws, warps;  ///< a relief; a warp
  ReliefView view;    ///< of the relief
  ReliefForm form;
  glm::dvec3 warp_eye;  ///< of the warp
  int warp_frame;       ///< the frame in which the eye is there
  double pixel_tangent;
  int draw_parts, strips;  ///< pieces: these parts, the reading of the texels, these strips
  int done = 0;            ///< pieces
  bool was_due = false;    ///< it is ready, but what is shown is still better
  ReliefTexture texture;
  std::optional<DrawnRelief> relief;
  WarpedRelief warped, strip;
};

struct ScheduledImpostor {
  ImpostorSchedule schedule;
  Impostor shown;
  int shown_warp_frame = 0;  ///< the frame for whose eye it is warped
  int frame = 0;             ///< the next
  std::optional<ImpostorUpdate> update;
  int last_update_frames = 8;  ///< that one took; the first may take as many
  int stale_frames = 0;        ///< in a row
  std::optional<glm::dvec3> eye;
  EyeMotion motion;
  WarpedRelief spare_warp, spare_strip;  ///< memory to use again
  // Of an own thread, which ends first.
  std::unique_ptr<ThreadPool> own_pool;
  std::unique_ptr<Background> thread;
};

/// `isa` is that of the frames' pool.
ScheduledImpostor scheduled_impostor(const ImpostorSchedule& schedule, Isa isa);

/// What was done for a frame.
struct ScheduledFrame {
  ImpostorStep step = ImpostorStep::warp;  ///< renew: a new relief is shown from now on
  int renewals = 0;                        ///< reliefs drawn, or begun to be
  int pieces = 0;                          ///< of an update, done in this frame
  bool takes = false;                      ///< an update is shown from now on
  std::optional<int> begins_for = {};      ///< an update begins, for the eye of this frame
  bool stalls = false;    ///< nothing could be shown before an update or a renewal was done
  bool is_stale = false;  ///< the relief's error is above the tolerance
  /// With warps aside, frames since the eye was where the warp is for; below 0 if it will be. Else
  /// frames since the relief
  /// came to be stale.
  int late_frames = 0;
};

/// Does a frame's share of the work. `has_time` is asked after each piece of a variable slice. The
/// maker must be used for nothing else while an own thread draws: finish_update() ends that.
ScheduledFrame update_scheduled(ScheduledImpostor& impostor, ReliefMaker& maker,
                                const ImpostorSettings& settings, const CameraMatrices& camera,
                                glm::dvec3 up, int height_px, ThreadPool& pool,
                                const std::function<bool()>& has_time);

/// Waits for the own thread.
void finish_update(ScheduledImpostor& impostor);

/// How many frames before it reaches the relief's eye, moving so, an eye would be served by it.
int lead_frames(const DrawnRelief& relief, const ImpostorSettings& settings,
                const EyeMotion& motion, double pixel_tangent);
inline constexpr int kMostLead = 256;
/// Of what the tolerance has above a texel: the next relief is another view, whose error grows in
/// another way. More, and some reliefs of a turn are too far ahead (impostors.md).
inline constexpr double kLeadShare = 0.55;

}  // namespace softfocus
