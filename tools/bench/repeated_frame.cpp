#include "tools/bench/repeated_frame.h"

namespace softfocus {
namespace {

/// The first frame of `reproject` by its default is drawn, and then every other: the eighth is not.
constexpr int kFramesBefore = 7;

}  // namespace

RepeatedFrame make_repeated_frame(const ChosenEffect& chosen, const BenchWork& work,
                                  ThreadPool& pool) {
  const auto [width, height] = work.size;
  const int warm_up = warm_up_frames(chosen);
  int before = warm_up > 0 ? warm_up : kFramesBefore;
  RepeatedFrame made{.effect = frame_effect(chosen),
                     .history = {},
                     .frames = make_image(Format::r32f, width, height),
                     .between = make_image(Format::rgba16f, width, height)};
  if (is_drawn_whole(made.effect, {.count = before})) ++before;
  PreparedScene prepared = prepare_scene(*work.scene, work.profile, pool);
  for (int i = 0; i < before; ++i) {
    draw_next(prepared, made.effect, work.frame - before + i, width, height, made.history, pool);
  }
  draw_sources(prepared, made.effect, work.frame, width, height, made.history, pool);
  return made;
}

void run(RepeatedFrame& frame, Image& picture, const Profile& profile, ThreadPool& pool) {
  make_frame(frame.effect, sources_of(frame.effect, frame.history),
             {picture, frame.frames, frame.between}, profile, pool);
}

}  // namespace softfocus
