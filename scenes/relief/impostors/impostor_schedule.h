#pragma once
// When an impostor's work is done (7.4 and 8.3 to 8.7 of Clua 2004). A frame clears, maps what is
// ready, and is shown. An *update* makes something new ready, one of two things:
//
//   renewals aside   a relief of the object; each frame warps the relief that is there
//   warps aside      a warp, and before it a new relief if the old one is stale (Clua's schedules);
//                    each frame maps the last finished warp as it is
//
// It is done at one of three times:
//
//   in the frame     a frame does all it needs; the threads of its pool share each step. With one
//                    thread this is 8.3, with several 8.7, but for the join, which is not needed
//   slices           a slice of the update follows each frame's own work. With fixed slices (8.4)
//                    an update takes a number of frames, with variable ones (8.5) a frame does
//                    pieces until its time is up
//   own thread       a thread does the update beside the frames (8.6)
//
// An update that begins in frame f with `update_frames` K is shown from frame f + K on, however
// long its slices or its thread have taken: pictures depend on no clock. With K = 0 it is shown in
// the first frame that finds it done, and pictures depend on the clock.
//
// With prediction (7.4) an update is for a later eye (eye_motion.h). It begins K frames before its
// relief is stale, and the relief is drawn for an eye still farther on: as far as it serves within
// the tolerance. So a relief serves before its eye is reached, and after.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "raster/threads/background.h"
#include "scenes/relief/impostors/eye_motion.h"
#include "scenes/relief/impostors/impostor.h"

namespace softfocus {

enum class ScheduleKind : std::uint8_t { in_frame, slices, own_thread };

struct ImpostorSchedule {
  ScheduleKind kind = ScheduleKind::in_frame;
  bool warps_aside = false;  ///< not of in_frame
  int update_frames = 0;     ///< K, 0 to kMostUpdateFrames
  bool predicts = false;
};
inline constexpr int kMostUpdateFrames = 64;

/// An update that is being made ready.
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
  int last_update_frames = 8;  ///< of the last update; a guess before the first
  int stale_frames = 0;        ///< in a row
  std::optional<glm::dvec3> eye;
  EyeMotion motion;
  WarpedRelief spare_warp, spare_strip;  ///< memory to use again
  // Of an own thread. The thread is the last member, so that it ends first.
  std::unique_ptr<ThreadPool> own_pool;
  std::unique_ptr<Background> thread;
};

/// `isa` is that of the frames' pool.
ScheduledImpostor scheduled_impostor(const ImpostorSchedule& schedule, Isa isa);

/// The work done for a frame.
struct ScheduledFrame {
  ImpostorStep step = ImpostorStep::warp;  ///< renew: a new relief is shown from now on
  int renewals = 0;                        ///< reliefs drawn, or begun to be
  int pieces = 0;                          ///< of an update, done in this frame
  bool takes = false;                      ///< an update is shown from now on
  std::optional<int> begins_for = {};      ///< an update begins, for the eye of this frame
  bool stalls = false;    ///< nothing could be shown before an update or a renewal was done
  bool is_stale = false;  ///< the relief's error is above the tolerance
  /// With warps aside, frames since the eye was at the place that the warp is for; below 0 if it is
  /// yet to come there. Else frames since the relief became stale.
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

/// For how many frames before it reaches the relief's eye, by this motion, an eye is served by the
/// relief, with kLeadShare of the tolerance.
int lead_frames(const DrawnRelief& relief, const ImpostorSettings& settings,
                const EyeMotion& motion, double pixel_tangent);
inline constexpr int kMostLead = 256;
/// The share of the tolerance above one texel. Not all, because the next relief is another view,
/// whose error grows in another way: with more, some reliefs of a turn are too far ahead
/// (docs/impostors.md).
inline constexpr double kLeadShare = 0.55;

}  // namespace softfocus
