#include "tools/bench/our_frame.h"

#include <algorithm>

namespace softfocus {
namespace {

Shot shot_of(const OurFrame& frame) {
  const BenchWork& work = frame.work;
  Shot shot{.scene = &*work.scene,
            .frame = work.frame,
            .width = work.size.width,
            .height = work.size.height,
            .method = work.method,
            .blends = false,
            .lens = ShotLens{.lens = {.focus_m = work.focus_m}},
            .sampling = work.sampling,
            .goal = work.goal,
            .verify = work.verify,
            .most_coc_px = work.largest_radius_px,
            .profile = work.profile};
  if (work.method.filter == nullptr || frame.one_picture) shot.layers = 0;
  return shot;
}

}  // namespace

void draw(OurFrame& frame) { draw_shot(shot_of(frame), frame.memory, frame.drawn, frame.pool); }

void filter(OurFrame& frame) {
  const BenchWork& work = frame.work;
  Image& picture = frame.filtered.picture;  // one memory for all frames
  if (!work.scene) {
    if (picture.bytes.empty())
      picture = make_image(work.picture.format, work.size.width, work.size.height);
    apply(*work.method.filter, {work.picture, work.settings, work.profile}, picture, frame.pool);
    return;
  }
  frame.memory.picture = std::move(picture);
  const UsedLens lens{.lens = {.focus_m = work.focus_m},
                      .aperture_radius_m = work.aperture_radius_m,
                      .settings = work.settings};
  frame.filtered = make_picture(shot_of(frame), frame.drawn, lens, frame.memory, frame.pool);
}

void copy(OurFrame& frame, const Image& picture) {
  if (frame.copy.bytes.empty()) {
    frame.copy = make_image(picture.format, picture.width, picture.height);
  }
  constexpr int kRows = 16;
  frame.pool.for_each((picture.height + kRows - 1) / kRows, [&](int band) {
    for (int y = band * kRows; y < std::min((band + 1) * kRows, picture.height); ++y) {
      const auto from = row<std::uint16_t>(picture, y);
      std::copy(from.begin(), from.end(), row<std::uint16_t>(frame.copy, y).begin());
    }
  });
}

}  // namespace softfocus
