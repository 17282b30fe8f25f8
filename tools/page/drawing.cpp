#include "tools/page/drawing.h"

#include <algorithm>
#include <cmath>

#include "dof/circle_sizes.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_parts.h"
#include "scenes/draw/keyframes.h"
#include "tools/cli/errors.h"
#include "tools/page/picture.h"
#include "tools/stress/cases/make_frame.h"

namespace softfocus {
namespace {

bool same_drawing(const FrameSettings& a, const FrameSettings& b) {
  return a.size.width == b.size.width && a.size.height == b.size.height && a.preview == b.preview &&
         a.frame == b.frame && a.camera == b.camera;
}

void draw_opened_scene(Page& page, Drawn& drawn) {
  const FrameSettings& settings = drawn.settings;
  const auto [width, height] = settings.size;
  const Scene& scene = page.opened->scene;
  drawn.scene = &scene;
  drawn.camera = chosen_camera(scene.camera, settings.camera);
  drawn.view = camera_matrices(drawn.camera, settings.frame, width, height);
  if (!page.prepared) page.prepared = prepare_scene(scene, Profile{}, *page.pool);
  drawn.picture = make_image(Format::rgba16f, width, height);
  draw_scene(*page.prepared, drawn.view, settings.frame, drawn.picture, *page.pool);
}

/// A case's picture is square, and its radii are pixels: a coarser one would be another case.
void draw_opened_case(Page& page, Drawn& drawn) {
  const FrameSettings& settings = drawn.settings;
  const Opened& opened = *page.opened;
  const int side = settings.size.height * settings.preview;
  drawn.trial = opened.stress_case->make(opened.severity, side, *page.pool);
  const auto last = static_cast<double>(drawn.trial->frames.size() - 1);
  const auto number = static_cast<std::size_t>(std::clamp(settings.frame, 0.0, last));
  const StressFrame& frame = drawn.trial->frames[number];
  drawn.trial_frame = &frame;
  drawn.camera = opened.scene.camera;
  drawn.picture = frame.sharp;
  if (!frame.scene) return;
  const Scene& scene = frame.scene->scene;
  drawn.scene = &scene;
  drawn.camera = chosen_camera(scene.camera, settings.camera);
  drawn.view = frame.scene->camera;
  if (!settings.camera) return;
  const int width = frame.sharp.width, height = frame.sharp.height;
  drawn.view = camera_matrices(drawn.camera, 0.0, width, height);
  drawn.picture = draw_scene(scene, drawn.view, 0.0, width, height, Profile{}, *page.pool);
}

float focus_depth(const Image& picture, glm::dvec2 at) {
  const auto pixel = [](double part, int count) {
    return std::min(static_cast<int>(part * count), count - 1);
  };
  const int x = pixel(at.x, picture.width), y = pixel(at.y, picture.height);
  return load_texel<Format::rgba16f>(picture, x, y).w;
}

/// A case gives its circles in pixels. Its lens in millimetres stands for them: what is changed in
/// it changes them in proportion.
void set_case_lens(FrameLens& used, const SceneLens& stands_for, const Drawn& drawn,
                   bool found_focus) {
  const StressFrame& frame = *drawn.trial_frame;
  used.settings = frame.settings;
  const auto focus_m = static_cast<double>(frame.settings.coc.focus_m);
  if (!found_focus) used.lens.focus_m = focus_m * (used.lens.focus_m / stands_for.lens.focus_m);
  const double wider = aperture_mm(used.lens) / aperture_mm(stands_for.lens) * used.coc_scale;
  used.aperture_m = frame.scene ? frame.scene->aperture_m * wider : 0.0;
  PixelCoc& coc = used.settings.coc;
  coc.radius_at_infinity_px = static_cast<float>(static_cast<double>(coc.radius_at_infinity_px) *
                                                 wider * (focus_m / used.lens.focus_m));
  coc.focus_m = static_cast<float>(used.lens.focus_m);
}

bool takes_all_circles(const FrameSettings& settings) {
  const Method* filter = settings.method.filter;
  return settings.show == Show::image && filter != nullptr && filter->any_radius_costs_the_same &&
         !settings.max_coc_px;
}

}  // namespace

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

std::shared_ptr<const Drawn> drawn_picture(Page& page, const FrameSettings& settings) {
  if (!page.opened) throw UsageError("nothing is open; the request 'open' opens a scene");
  if (page.opened->picture) throw UsageError(kNoScene);
  for (std::size_t i = 0; i < page.drawn.size(); ++i) {
    if (page.drawn[i] && same_drawing(page.drawn[i]->settings, settings)) {
      std::swap(page.drawn[0], page.drawn[i]);
      return page.drawn[0];
    }
  }
  const auto start = std::chrono::steady_clock::now();
  auto drawn = std::make_shared<Drawn>();
  drawn->settings = settings;
  page.opened->stress_case ? draw_opened_case(page, *drawn) : draw_opened_scene(page, *drawn);
  drawn->ms = milliseconds_since(start);
  std::rotate(page.drawn.begin(), page.drawn.end() - 1, page.drawn.end());
  page.drawn[0] = drawn;
  return drawn;
}

FrameLens frame_lens(const Opened& opened, const Drawn& drawn, const FrameSettings& settings,
                     ThreadPool& pool) {
  const SceneLens& of_scene = opened.scene.lens;
  FrameLens used;
  used.lens = overruled(lens_at(of_scene, settings.frame), settings.lens);
  if (settings.focus_at) {
    used.lens.focus_m = static_cast<double>(focus_depth(drawn.picture, *settings.focus_at));
  }
  used.coc_scale = settings.lens.coc_scale.value_or(of_scene.coc_scale);
  if (const char* error = lens_error(used.lens)) {
    throw UsageError("the lens is " + short_number(used.lens.focal_length_mm) + " mm, focused at " +
                     short_number(used.lens.focus_m) + " m: " + error);
  }
  if (drawn.trial_frame != nullptr) {
    set_case_lens(used, of_scene, drawn, settings.focus_at.has_value());
    used.settings.max_coc_px = settings.max_coc_px.value_or(used.settings.max_coc_px);
  } else {
    const int height = drawn.picture.height;
    used.settings.coc =
        checked_pixel_coc(used.lens, drawn.camera.fov_y_degrees, height, used.coc_scale);
    used.settings.max_coc_px = used_max_coc_px(settings.max_coc_px, of_scene, height);
    used.aperture_m = aperture_radius_m(used.lens, used.coc_scale);
  }
  if (takes_all_circles(settings)) {
    const CircleSizes sizes = circle_sizes(drawn.picture, used.settings.coc, 0.0f, pool);
    used.settings.max_coc_px = std::ceil(sizes.largest_px);
  }
  return used;
}

LensViewInput lens_view_input(const Drawn& drawn, double focus_m, double aperture_m,
                              const Sampling& sampling) {
  return {.scene = *drawn.scene,
          .camera = drawn.view,
          .frame = drawn.trial ? 0.0 : drawn.settings.frame,
          .pinhole = drawn.picture,
          .focus_m = focus_m,
          .aperture_radius_m = aperture_m,
          .sampling = sampling,
          .profile = Profile{},
          .progress = {}};
}

Image filtered_picture(const Drawn& drawn, const Method& method, const DofSettings& settings,
                       ThreadPool& pool) {
  const Image& picture = drawn.picture;
  if (drawn.scene == nullptr) return apply(method, {picture, settings, Profile{}}, pool);
  const double frame = drawn.trial ? 0.0 : drawn.settings.frame;
  return filtered_frame(method, *drawn.scene, drawn.view, frame, picture, settings, Profile{},
                        pool);
}

}  // namespace softfocus
