#include "raster/temporal/frame_passes.h"

#include "raster/temporal/forward_reproject.h"
#include "raster/temporal/refresh.h"
#include "raster/threads/float_environment.h"

namespace softfocus {
namespace {

void look_back(const ReprojectSettings& settings, const FrameSources& sources,
               const ImageView& found, const Profile& profile, ThreadPool& pool) {
  reverse_reproject(settings, {sources.drawn, sources.velocity, sources.before, sources.frames},
                    found, profile, pool);
}

}  // namespace

std::int64_t make_frame(const TemporalAa& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool) {
  look_back(settings.reproject, sources, targets.between, profile, pool);
  accumulate(settings.average, sources.drawn, targets.between, targets.picture, targets.frames,
             profile, pool);
  return std::int64_t{targets.picture.width} * targets.picture.height;
}

std::int64_t make_frame(const Refresh& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool) {
  look_back(own_depth_cubic(settings.depth_tolerance), sources, targets.between, profile, pool);
  return refresh(settings.groups, sources.turn, sources.drawn, targets.between, targets.picture,
                 targets.frames, profile, pool);
}

std::int64_t make_frame(const Reproject& settings, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool) {
  const ImageView& found =
      settings.holes == UnseenPixels::black ? targets.picture : targets.between;
  if (settings.forward) {
    forward_reproject(sources.before, sources.velocity, found, profile, pool);
  } else {
    look_back(own_depth_cubic(settings.depth_tolerance), sources, found, profile, pool);
  }
  if (settings.holes == UnseenPixels::drawn) {
    constexpr int kNoTurn = -1;
    return refresh(1, kNoTurn, sources.drawn, found, targets.picture, targets.frames, profile,
                   pool);
  }
  if (!settings.forward) put_depths(sources.drawn, found, profile, pool);
  if (settings.holes == UnseenPixels::filled) fill_holes(found, targets.picture, profile, pool);
  return 0;
}

std::int64_t make_frame(const FrameEffect& effect, const FrameSources& sources,
                        const FrameTargets& targets, const Profile& profile, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  return std::visit(
      [&](const auto& settings) { return make_frame(settings, sources, targets, profile, pool); },
      effect);
}

}  // namespace softfocus
