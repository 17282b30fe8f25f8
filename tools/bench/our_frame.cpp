#include "tools/bench/our_frame.h"

#include <algorithm>

#include "scenes/auto/auto_picture.h"
#include "scenes/draw/object_numbers.h"

namespace softfocus {
namespace {

void apply_filter(OurFrame& frame, const Method& method, const DofSettings& settings) {
  const BenchWork& work = frame.work;
  const Image& scene = work.scene ? frame.drawn : work.picture;
  Image& filtered = frame.filtered;  // one memory for all frames
  if (filtered.bytes.empty()) filtered = make_image(scene.format, scene.width, scene.height);
  const std::vector<ConstImageView> behind{frame.behind.begin(), frame.behind.end()};
  const std::vector<TransparentLayer> transparent = views_of(frame.transparent);
  apply(method, {scene, settings, work.profile, frame.objects, behind, transparent}, filtered,
        frame.pool);
}

LensViewInput views_input(OurFrame& frame, const Sampling& sampling) {
  const BenchWork& work = frame.work;
  return {*work.scene, work.view,    work.frame, frame.drawn, work.focus_m, work.aperture_radius_m,
          sampling,    work.profile, {},         nullptr};
}

// As `render` has it, checks included.
void choose_and_filter(OurFrame& frame) {
  const BenchWork& work = frame.work;
  const LensViewInput views = views_input(frame, work.sampling);
  AutoPicture found = auto_picture({.views = views,
                                    .settings = work.settings,
                                    .goal = work.goal,
                                    .limits = {work.largest_radius_px, triangle_count(*work.scene)},
                                    .verify = work.verify},
                                   frame.pool);
  frame.filtered = std::move(found.picture);
  frame.choice = std::move(found.choice);
}

void sample_lens(OurFrame& frame, const LensViewMethod& method, const Sampling& sampling) {
  const LensViewInput input = views_input(frame, sampling);
  SampledPicture sampled;
  if (method.name == "accumulation") {
    // Textures are decoded once for all frames.
    if (!frame.views) frame.views = make_accumulation_buffer(input, frame.pool);
    sampled = accumulation(*frame.views, input, frame.pool);
  } else if (method.name == "filtered-views") {
    if (!frame.filtered_views) {
      frame.filtered_views = make_filtered_views_buffer(input, frame.pool);
    }
    sampled = filtered_views(*frame.filtered_views, input, frame.pool);
  } else if (method.warps_views) {
    if (!frame.warped_views) frame.warped_views = make_warped_views_buffer(input, frame.pool);
    sampled = warped_accumulation(*frame.warped_views, input, frame.pool);
  } else {
    sampled = method.render(input, frame.pool);
  }
  frame.samples = sampled.samples;
  frame.filtered = std::move(sampled.picture);
}

}  // namespace

void draw(OurFrame& frame) {
  const BenchWork& work = frame.work;
  if (!frame.scene) frame.scene = prepare_scene(*work.scene, work.profile, frame.pool);
  if (frame.drawn.bytes.empty()) {
    frame.drawn = make_image(Format::rgba16f, work.size.width, work.size.height);
  }
  if (work.method.filter == nullptr || frame.one_picture) {
    draw_scene(*frame.scene, work.view, work.frame, frame.drawn, frame.pool);
    return;
  }
  const std::size_t layers = work.method.filter->layers;
  while (frame.behind.size() + 1 < layers) {
    frame.behind.push_back(make_image(Format::rgba16f, work.size.width, work.size.height));
  }
  draw_layers(*frame.scene, work.view, work.frame, frame.drawn, frame.behind, frame.pool,
              static_cast<double>(work.settings.coc.focus_m));
  frame.transparent =
      draw_transparent(*frame.scene, work.view, work.frame, frame.drawn, frame.pool);
  frame.objects = object_numbers_for(*work.method.filter, *work.scene, work.view, work.frame,
                                     work.size.width, work.size.height, work.profile, frame.pool);
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

void filter(OurFrame& frame) {
  const BenchWork& work = frame.work;
  const MethodChoice& method = work.method;
  if (method.is_auto()) return choose_and_filter(frame);
  if (method.of_scene != nullptr) {
    sample_lens(frame, *method.of_scene, work.sampling);
  } else {
    apply_filter(frame, *method.filter, work.settings);
  }
}

}  // namespace softfocus
