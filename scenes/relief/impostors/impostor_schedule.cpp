#include "scenes/relief/impostors/impostor_schedule.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace softfocus {
namespace {

/// The eye comes no nearer than this, in the object's radii, as far as is foreseen.
constexpr double kNearestEye = 1.2;

// Pieces of variable slices: so many triangles, or such a part of a warp. Each piece finds the
// places of all vertices of its objects.
constexpr std::size_t kPartTriangles = 32768;
constexpr int kVariableStrips = 8;

/// update_scheduled()'s arguments.
struct ScheduledWork {
  ReliefMaker& maker;
  const ImpostorSettings& settings;
  const CameraMatrices& camera;
  glm::dvec3 up;
  int height_px;
  double pixel_tangent;
  ThreadPool& pool;
  int frame;
};

ReliefForm form_for(const ScheduledWork& work, glm::dvec3 eye) {
  CameraMatrices camera = work.camera;
  camera.eye = eye;
  return impostor_form(work.maker, camera, work.settings, work.up, work.height_px);
}

ReliefView view_for(const ScheduledWork& work, glm::dvec3 eye) {
  CameraMatrices camera = work.camera;
  camera.eye = eye;
  return impostor_view(work.maker, camera, work.settings, work.up);
}

/// How many frames ahead of `frames` from now a relief is drawn: lead_frames(), but for an eye that
/// comes so near that it would have many more texels than one for the eye now.
int lead_for(const ScheduledImpostor& impostor, const ScheduledWork& work, int frames) {
  if (!impostor.schedule.predicts || !impostor.shown.drawn) return 0;
  int lead = lead_frames(*impostor.shown.drawn, work.settings, impostor.motion, work.pixel_tangent);
  const double most = work.settings.sharpness * form_for(work, work.camera.eye).height;
  while (lead > 0 &&
         form_for(work, moved_eye(impostor.motion, work.camera.eye, frames + lead)).height > most) {
    lead /= 2;
  }
  return lead;
}

// --- pieces of an update ---

int pieces_of(const ImpostorUpdate& update) {
  return (update.draws ? update.draw_parts + 1 : 0) + (update.warps ? update.strips : 0);
}

/// One strip of the warp's columns.
void warp_strip(ImpostorUpdate& update, const DrawnRelief& relief, const WarpRule& rule, int number,
                ThreadPool& pool) {
  const std::optional<PlaneRectangle> all =
      warped_extent(relief.texture, relief.extent, update.warp_eye);
  if (!all) {
    update.warped.place = {0, 0, 0, 0};
    return;
  }
  if (update.strips == 1) {
    warp_relief(relief.texture, relief.extent, update.warp_eye, *all, rule, update.warped, pool);
    return;
  }
  const int begin = all->width * number / update.strips;
  const int width = all->width * (number + 1) / update.strips - begin;
  const auto row_texels = static_cast<std::size_t>(all->width);
  if (number == 0) {
    update.warped.place = *all;
    update.warped.colours.resize(row_texels * static_cast<std::size_t>(all->height));
    update.warped.depths_m.resize(row_texels * static_cast<std::size_t>(all->height));
  }
  if (width == 0) return;
  warp_relief(relief.texture, relief.extent, update.warp_eye,
              {all->x_begin + begin, all->y_begin, width, all->height}, rule, update.strip, pool);
  for (int y = 0; y < all->height; ++y) {
    const std::size_t from = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    const std::size_t to =
        static_cast<std::size_t>(y) * row_texels + static_cast<std::size_t>(begin);
    std::copy_n(update.strip.colours.data() + from, width, update.warped.colours.data() + to);
    std::copy_n(update.strip.depths_m.data() + from, width, update.warped.depths_m.data() + to);
  }
}

/// Does the next piece. `old` is the relief that is shown; it is read only.
void run_piece(ImpostorUpdate& update, ReliefMaker& maker, const ImpostorSettings& settings,
               const std::optional<DrawnRelief>& old, ThreadPool& pool) {
  int piece = update.done++;
  if (update.draws) {
    if (piece < update.draw_parts && maker.trace) {
      update.texture = make_relief(maker, update.view, update.form, pool);
      return;
    }
    if (piece == 0) {
      update.texture = begin_relief(
          maker, relief_camera(maker, update.view, update.form.width, update.form.height),
          update.form);
    }
    if (piece < update.draw_parts) {
      draw_relief_part(maker, update.texture, update.form, update.view.eye, piece,
                       update.draw_parts, pool);
      return;
    }
    if (piece == update.draw_parts) {
      if (!maker.trace) read_relief(maker, update.form, update.view.eye, update.texture, pool);
      update.relief = known_relief(std::move(update.texture), settings, update.view.eye, pool);
      // The eye may have been foreseen where it does not come.
      if (update.warps && update.relief && old &&
          !is_fresh(*update.relief, settings, update.warp_eye, update.pixel_tangent) &&
          impostor_error(*old, update.warp_eye) < impostor_error(*update.relief, update.warp_eye)) {
        update.relief.reset();
      }
      return;
    }
    piece -= update.draw_parts + 1;
  }
  const std::optional<DrawnRelief>& relief = update.relief ? update.relief : old;
  if (relief) warp_strip(update, *relief, settings.warp, piece, pool);
}

/// Does pieces until so many are done.
void run_pieces(ImpostorUpdate& update, int until, const ScheduledWork& work,
                const std::optional<DrawnRelief>& old) {
  while (update.done < until) run_piece(update, work.maker, work.settings, old, work.pool);
}

// --- frames ---

bool is_stale_at(const Impostor& shown, const ScheduledWork& work, glm::dvec3 eye) {
  return !shown.drawn || !is_fresh(*shown.drawn, work.settings, eye, work.pixel_tangent);
}

/// Whether the relief can be seen at all from the eye, however wrong it is.
bool can_be_shown(const Impostor& shown, glm::dvec3 eye) {
  return shown.drawn && warped_extent(shown.drawn->texture, shown.drawn->extent, eye).has_value();
}

/// A relief in the frame. With prediction it is drawn for an eye ahead, as far as that serves.
void renew_in_frame(ScheduledImpostor& impostor, const ScheduledWork& work, ScheduledFrame& frame) {
  Impostor& shown = impostor.shown;
  const glm::dvec3 eye = work.camera.eye;
  int lead = lead_for(impostor, work, 0);
  keep_stale(shown, work.settings, eye);
  for (;; lead /= 2) {
    const glm::dvec3 drawn_for = moved_eye(impostor.motion, eye, lead);
    const glm::dvec3 own_eye = lead == 0 ? eye : drawn_for;
    shown.drawn = known_relief(
        make_relief(work.maker, view_for(work, own_eye), form_for(work, own_eye), work.pool),
        work.settings, own_eye, work.pool);
    ++frame.renewals;
    if (lead == 0 || !is_stale_at(shown, work, eye)) break;
  }
  frame.step = ImpostorStep::renew;
}

/// Shows the update, which is done, if it is better than what is shown.
void take_update(ScheduledImpostor& impostor, const ScheduledWork& work, ScheduledFrame& frame) {
  ImpostorUpdate& update = *impostor.update;
  Impostor& shown = impostor.shown;
  const glm::dvec3 eye = work.camera.eye;
  if (update.draws && !update.warps && update.relief && shown.drawn) {
    const bool is_old_stale = is_stale_at(shown, work, eye);
    const bool is_better = is_fresh(*update.relief, work.settings, eye, work.pixel_tangent) ||
                           impostor_error(*update.relief, eye) < impostor_error(*shown.drawn, eye);
    if (!is_better) {
      // Ready before the eye is there; or the eye went elsewhere.
      if (is_old_stale) impostor.update.reset();
      return;
    }
  }
  if (update.draws && (update.relief || !update.warps)) {
    keep_stale(shown, work.settings, eye);
    shown.drawn = std::move(update.relief);
    frame.step = ImpostorStep::renew;
  }
  if (update.warps) {
    std::swap(shown.warped, update.warped);
    shown.warped_level = 0;
    std::swap(impostor.spare_warp, update.warped);
    std::swap(impostor.spare_strip, update.strip);
    shown.warped_for = update.warp_eye;
    impostor.shown_warp_frame = update.warp_frame;
  }
  frame.takes = true;
  impostor.update.reset();
}

/// Whether a relief in the cache serves an eye.
bool is_kept_for(const Impostor& shown, const ScheduledWork& work, glm::dvec3 eye) {
  for (const DrawnRelief& kept : shown.cache) {
    if (can_be_recalled(kept, work.settings, eye, work.pixel_tangent)) return true;
  }
  return false;
}

bool recall(Impostor& shown, const ScheduledWork& work) {
  std::optional<DrawnRelief> kept =
      recalled(shown, work.settings, work.camera.eye, work.pixel_tangent);
  if (!kept) return false;
  keep_stale(shown, work.settings, work.camera.eye);
  shown.drawn = std::move(kept);
  return true;
}

/// Warps in the frame, if the last warp does not serve as a sprite.
void warp_in_frame(ScheduledImpostor& impostor, const ScheduledWork& work, bool is_new,
                   ScheduledFrame& frame) {
  Impostor& shown = impostor.shown;
  const glm::dvec3 eye = work.camera.eye;
  impostor.shown_warp_frame = work.frame;
  if (!is_new && work.settings.sprites && shown.drawn &&
      parallax_tangent(shown.drawn->texture, shown.warped_for, eye) <= work.pixel_tangent) {
    frame.step = ImpostorStep::sprite;
    return;
  }
  warp_impostor(shown, work.settings, eye, work.pixel_tangent, work.pool);
}

void do_in_frame(ScheduledImpostor& impostor, const ScheduledWork& work, ScheduledFrame& frame) {
  Impostor& shown = impostor.shown;
  const bool is_new = is_stale_at(shown, work, work.camera.eye);
  if (is_new) {
    if (recall(shown, work)) {
      frame.step = ImpostorStep::recall;
    } else {
      renew_in_frame(impostor, work, frame);
    }
  }
  warp_in_frame(impostor, work, is_new, frame);
}

// --- updates aside ---

bool is_due(const ScheduledImpostor& impostor, int frame) {
  const ImpostorUpdate& update = *impostor.update;
  const int wanted = impostor.schedule.update_frames;
  if (wanted > 0) return frame >= update.begun + wanted;
  return impostor.thread ? !impostor.thread->is_running() : update.done == pieces_of(update);
}

/// Does what is left of an update.
void complete(ScheduledImpostor& impostor, const ScheduledWork& work) {
  if (impostor.thread) impostor.thread->wait();
  run_pieces(*impostor.update, pieces_of(*impostor.update), work, impostor.shown.drawn);
}

void begin_update(ScheduledImpostor& impostor, const ScheduledWork& work, ScheduledFrame& frame) {
  const ImpostorSchedule& schedule = impostor.schedule;
  const Impostor& shown = impostor.shown;
  const glm::dvec3 eye = work.camera.eye;
  // The next may take longer than the last.
  const int last = impostor.last_update_frames;
  const int wanted = schedule.update_frames > 0 ? schedule.update_frames : last + last / 4 + 1;
  const int ahead = schedule.predicts ? wanted : 0;
  const glm::dvec3 target = ahead == 0 ? eye : moved_eye(impostor.motion, eye, ahead);
  const bool draws = is_stale_at(shown, work, target) &&
                     (schedule.warps_aside || !is_kept_for(shown, work, target));
  const bool warps =
      schedule.warps_aside &&
      (draws || !work.settings.sprites ||
       parallax_tangent(shown.drawn->texture, shown.warped_for, target) > work.pixel_tangent);
  if (!draws && !warps) return;
  const int lead = draws ? lead_for(impostor, work, ahead) : 0;
  const glm::dvec3 view_eye = lead == 0 ? target : moved_eye(impostor.motion, eye, ahead + lead);
  ImpostorUpdate update{};
  update.begun = work.frame;
  update.draws = draws;
  update.warps = warps;
  update.view = view_for(work, view_eye);
  if (draws) update.form = form_for(work, view_eye);
  update.warp_eye = target;
  update.warp_frame = work.frame + ahead;
  update.pixel_tangent = work.pixel_tangent;
  if (schedule.kind == ScheduleKind::own_thread) {
    update.draw_parts = update.strips = 1;
  } else if (schedule.update_frames > 0) {
    update.draw_parts = std::max(schedule.update_frames - 1, 1);
    update.strips = schedule.update_frames;
  } else {
    update.draw_parts = static_cast<int>(std::clamp<std::size_t>(
        triangle_count(*work.maker.scene) / kPartTriangles, 1, kMostUpdateFrames));
    update.strips = kVariableStrips;
  }
  if (work.maker.trace) update.draw_parts = 1;
  // The last warp's picture is memory to use again.
  std::swap(update.warped, impostor.spare_warp);
  std::swap(update.strip, impostor.spare_strip);
  impostor.update = std::move(update);
  frame.begins_for = work.frame + ahead + lead;
  if (draws) ++frame.renewals;
  if (!impostor.thread) return;
  impostor.thread->begin([job = &*impostor.update, maker = &work.maker, settings = work.settings,
                          old = &impostor.shown.drawn, pool = impostor.own_pool.get()] {
    while (job->done < pieces_of(*job)) run_piece(*job, *maker, settings, *old, *pool);
  });
}

/// A slice of the update that goes on.
void do_slice(ScheduledImpostor& impostor, const ScheduledWork& work,
              const std::function<bool()>& has_time, ScheduledFrame& frame) {
  ImpostorUpdate& update = *impostor.update;
  const int pieces = pieces_of(update), before = update.done;
  const int wanted = impostor.schedule.update_frames;
  if (wanted > 0) {
    const int slices = std::min(work.frame - update.begun + 1, wanted);
    run_pieces(update, (pieces * slices + wanted - 1) / wanted, work, impostor.shown.drawn);
  } else {
    while (update.done < pieces) {
      run_pieces(update, update.done + 1, work, impostor.shown.drawn);
      if (!has_time()) break;
    }
  }
  frame.pieces = update.done - before;
}

void do_aside(ScheduledImpostor& impostor, const ScheduledWork& work,
              const std::function<bool()>& has_time, ScheduledFrame& frame) {
  Impostor& shown = impostor.shown;
  const glm::dvec3 eye = work.camera.eye;
  bool is_new = false;
  const auto take = [&] {
    complete(impostor, work);
    if (!impostor.update->was_due) {
      impostor.update->was_due = true;
      impostor.last_update_frames = std::max(work.frame - impostor.update->begun, 1);
    }
    take_update(impostor, work, frame);
    is_new |= frame.takes;
  };
  if (impostor.update && is_due(impostor, work.frame)) take();
  if (!can_be_shown(shown, eye)) {
    frame.stalls = true;
    if (impostor.update) {
      take();
      impostor.update.reset();
    }
    if (is_stale_at(shown, work, eye)) {
      if (!recall(shown, work)) renew_in_frame(impostor, work, frame);
      is_new = true;
    }
    if (impostor.schedule.warps_aside) {
      warp_impostor(shown, work.settings, eye, work.pixel_tangent, work.pool);
      impostor.shown_warp_frame = work.frame;
    }
  }
  // The own thread starts before the frame's own work.
  if (!impostor.update) begin_update(impostor, work, frame);
  if (!impostor.schedule.warps_aside) {
    if (!is_new && is_stale_at(shown, work, eye) && recall(shown, work)) {
      frame.step = ImpostorStep::recall;
      is_new = true;
    }
    warp_in_frame(impostor, work, is_new, frame);
  } else if (!is_new) {
    frame.step = ImpostorStep::sprite;
  }
  if (impostor.update && !impostor.thread) do_slice(impostor, work, has_time, frame);
}

}  // namespace

int lead_frames(const DrawnRelief& relief, const ImpostorSettings& settings,
                const EyeMotion& motion, double pixel_tangent) {
  ImpostorSettings stricter = settings;
  stricter.tolerance_texels = 1.0 + kLeadShare * (settings.tolerance_texels - 1.0);
  // No finer, either, than it will be coarse: an eye that comes nearer needs more and more texels.
  stricter.fineness = 1.0 / settings.sharpness;
  const auto serves = [&](int frames) {
    return is_fresh(relief, stricter, moved_eye(motion, relief.eye, -frames), pixel_tangent);
  };
  if (!serves(1)) return 0;
  int low = 1, high = 2;
  while (high < kMostLead && serves(high)) {
    low = high;
    high *= 2;
  }
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (serves(middle) ? low : high) = middle;
  }
  return low;
}

ScheduledImpostor scheduled_impostor(const ImpostorSchedule& schedule, Isa isa) {
  assert(schedule.update_frames >= 0 && schedule.update_frames <= kMostUpdateFrames);
  assert(!schedule.warps_aside || schedule.kind != ScheduleKind::in_frame);
  ScheduledImpostor impostor;
  impostor.schedule = schedule;
  if (schedule.kind == ScheduleKind::own_thread) {
    impostor.own_pool = std::make_unique<ThreadPool>(1, isa);
    impostor.thread = std::make_unique<Background>();
  }
  return impostor;
}

ScheduledFrame update_scheduled(ScheduledImpostor& impostor, ReliefMaker& maker,
                                const ImpostorSettings& settings, const CameraMatrices& camera,
                                glm::dvec3 up, int height_px, ThreadPool& pool,
                                const std::function<bool()>& has_time) {
  const ScheduledWork work{maker, settings,      camera,
                           up,    height_px,     pixel_tangent_of(camera, height_px),
                           pool,  impostor.frame};
  ++impostor.frame;
  impostor.motion = eye_motion(maker.middle, kNearestEye * maker.radius_m,
                               impostor.eye.value_or(camera.eye), camera.eye);
  impostor.eye = camera.eye;
  ScheduledFrame frame;
  if (impostor.schedule.kind == ScheduleKind::in_frame) {
    do_in_frame(impostor, work, frame);
  } else {
    do_aside(impostor, work, has_time, frame);
  }
  frame.is_stale = is_stale_at(impostor.shown, work, camera.eye);
  impostor.stale_frames = frame.is_stale ? impostor.stale_frames + 1 : 0;
  frame.late_frames = impostor.schedule.warps_aside ? work.frame - impostor.shown_warp_frame
                                                    : impostor.stale_frames;
  return frame;
}

void finish_update(ScheduledImpostor& impostor) {
  if (impostor.thread) impostor.thread->wait();
}

}  // namespace softfocus
