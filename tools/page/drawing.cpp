#include "tools/page/drawing.h"

#include <algorithm>
#include <cmath>

#include "dof/lens.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/relief/impostors/scene_impostors.h"
#include "tools/cli/errors.h"
#include "tools/options/effect_options.h"
#include "tools/page/picture.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {
namespace {

/// Effects that make frames from those before are part of the drawing, of a picture alone.
bool same_drawing(const FrameSettings& a, const FrameSettings& b, bool has_effect_of_frames) {
  return a.size.width == b.size.width && a.size.height == b.size.height && a.preview == b.preview &&
         a.frame == b.frame && a.camera == b.camera && a.look == b.look && a.effect == b.effect &&
         (!has_effect_of_frames || (a.show == Show::image) == (b.show == Show::image));
}

/// A case's picture is square, and its radii are pixels: a coarser one would be another case.
void draw_opened_case(Page& page, Drawn& drawn) {
  const FrameSettings& settings = drawn.settings;
  const Opened& opened = *page.opened;
  const int side = settings.size.height * settings.preview;
  drawn.trial = opened.stress_case->make(opened.severity, side, *page.pool);
  const auto last = static_cast<double>(drawn.trial->frames.size() - 1);
  const auto number = static_cast<std::size_t>(std::clamp(settings.frame, 0.0, last));
  StressFrame& frame = drawn.trial->frames[number];
  drawn.trial_frame = &frame;
  drawn.camera = opened.scene.camera;
  drawn.frame.parts.opaque = frame.sharp;
  if (!frame.scene) return;
  Scene& scene = frame.scene->scene;
  drawn.scene = &scene;
  drawn.camera = scene.camera = chosen_camera(scene.camera, settings.camera);
  drawn.frame.view = frame.scene->camera;
  if (!settings.camera) return;
  const int width = frame.sharp.width, height = frame.sharp.height;
  drawn.frame.view = camera_matrices(drawn.camera, 0.0, width, height);
  drawn.frame.parts.opaque =
      draw_scene(scene, drawn.frame.view, 0.0, width, height, Profile{}, *page.pool);
}

glm::ivec2 pixel_at(glm::dvec2 part, int width, int height) {
  return {std::min(static_cast<int>(part.x * width), width - 1),
          std::min(static_cast<int>(part.y * height), height - 1)};
}

/// A case gives its circles in pixels. Its lens in millimetres stands for them: what is changed in
/// it changes them in proportion.
void set_case_lens(UsedLens& used, const SceneLens& stands_for, const Drawn& drawn,
                   const FrameSettings& settings, const Shot& shot, ThreadPool& pool) {
  const StressFrame& frame = *drawn.trial_frame;
  used.settings = frame.settings;
  used.settings.aperture = used_aperture(settings);
  const auto focus_m = static_cast<double>(frame.settings.coc.focus_m);
  if (!settings.focus_at) {
    used.lens.focus_m = focus_m * (used.lens.focus_m / stands_for.lens.focus_m);
  }
  const double wider = aperture_mm(used.lens) / aperture_mm(stands_for.lens) * used.coc_scale;
  used.aperture_radius_m = frame.scene ? frame.scene->aperture_m * wider : 0.0;
  PixelCoc& coc = used.settings.coc;
  coc.radius_at_infinity_px = static_cast<float>(static_cast<double>(coc.radius_at_infinity_px) *
                                                 wider * (focus_m / used.lens.focus_m));
  coc.focus_m = static_cast<float>(used.lens.focus_m);
  used.settings.max_coc_px = settings.max_coc_px.value_or(used.settings.max_coc_px);
  if (shot.lens->cuts_no_circle) {
    used.settings.max_coc_px = std::ceil(circle_sizes(drawn.picture(), coc, 0.0f, pool).largest_px);
  }
}

ShotLens asked_lens(const Scene& scene, const FrameSettings& settings) {
  const auto [width, height] = settings.size;
  ShotLens asked{overruled(lens_at(scene.lens, settings.frame), settings.lens),
                 settings.lens.coc_scale.value_or(scene.lens.coc_scale)};
  if (settings.focus_at) asked.focus_at = pixel_at(*settings.focus_at, width, height);
  asked.settings.aperture = used_aperture(settings);
  asked.settings.max_coc_px = used_max_coc_px(settings.max_coc_px, scene.lens, height);
  asked.cuts_no_circle =
      settings.show == Show::image && settings.method.takes_any_radius() && !settings.max_coc_px;
  return asked;
}

}  // namespace

namespace {

/// What was prepared of the open scene.
void forget_scene(Page& page) {
  page.memory = {};
  page.gpu_scene.reset();
}

/// Gives the open scene a look. What was prepared of it stays if a light has moved alone, unless
/// impostors have its light.
void set_look(Page& page, const SceneLook& look) {
  Opened& opened = *page.opened;
  if (look == opened.look) return;
  SceneLook moved = look;
  moved.light = opened.look.light;
  Scene& scene = opened.scene;
  scene.lights = opened.lights;
  scene.materials = opened.materials;
  scene.objects = opened.objects;
  scene.camera = opened.camera;
  try {
    set_look(look, scene);
  } catch (const UsageError&) {
    scene.lights = opened.lights;
    scene.materials = opened.materials;
    scene.objects = opened.objects;
    opened.look = {};
    opened.far_m = opened.camera.far_m;
    forget_scene(page);
    throw;
  }
  if (moved != opened.look || has_impostors(scene)) forget_scene(page);
  opened.look = look;
  opened.far_m = scene.camera.far_m;
}

std::vector<ChosenEffect> asked_effects(const Scene& scene, const FrameSettings& settings) {
  if (!settings.effect) return scene.effects;
  if (*settings.effect == "none") return {};
  return {parse_effect("effect", *settings.effect)};
}

SceneShadows* shadows_of(Page& page) {
  return page.memory.prepared ? page.memory.prepared->shadows.get() : nullptr;
}

/// Draws, and times what makes shadows ready.
void draw_scene_of(Page& page, const Shot& shot, Drawn& drawn) {
  std::chrono::steady_clock::time_point start;
  FrameHooks hooks;
  hooks.on_shadows = [&](bool are_placed) {
    if (are_placed) {
      drawn.shadows_ms += milliseconds_since(start);
    } else {
      start = std::chrono::steady_clock::now();
    }
  };
  draw_shot(shot, page.memory, drawn.frame, *page.pool, hooks);
}

ShadowCounts counts_of(const SceneShadows& shadows) {
  ShadowCounts counts;
  for (const Facet& facet : shadows.facets.facets) counts.casters += facet.casts ? 1 : 0;
  counts.receivers = shadows.facets.receivers.size();
  for (const ProjectedShadows& of_light : shadows.projected) {
    counts.projected += of_light.triangles.size();
  }
  for (const ShadowVolumes& of_light : shadows.volumes) counts.volumes += of_light.casters.size();
  return counts;
}

}  // namespace

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

Shot asked_shot(Page& page, const FrameSettings& settings) {
  if (!page.opened) throw UsageError("nothing is open; the request 'open' opens a scene");
  if (page.opened->picture) throw UsageError(kNoScene);
  Scene& scene = page.opened->scene;
  Shot shot{.scene = &scene,
            .frame = settings.frame,
            .width = settings.size.width,
            .height = settings.size.height,
            .show = settings.show,
            .method = settings.method,
            .sampling = settings.sampling};
  if (settings.show == Show::image || settings.show == Show::coc) {
    shot.lens = asked_lens(scene, settings);
  }
  if (page.opened->stress_case) return shot;
  set_look(page, settings.look);
  scene.camera = chosen_camera(page.opened->camera, settings.camera);
  scene.camera.far_m = page.opened->far_m;
  if (!can_look(scene.camera, settings.frame)) {
    throw UsageError(
        "camera: at this time it stands at its target, or looks along its upward axis");
  }
  if (settings.show != Show::image) return shot;
  shot.effects = asked_effects(scene, settings);
  if (settings.method.has_shutter()) shot.sampling.shutter_frames = scene.camera.shutter_frames;
  const auto effect = effect_of_frames(shot.effects, "the scene '" + page.opened->source + "'");
  if (effect && settings.method.filter == nullptr) {
    throw UsageError("the scene's effect " + std::string{effect->effect->name} +
                     " makes the picture that a method filters, and " +
                     std::string{settings.method.name()} + " draws the scene itself");
  }
  return shot;
}

std::shared_ptr<const Drawn> drawn_picture(Page& page, const FrameSettings& settings) {
  const Shot shot = asked_shot(page, settings);
  const std::vector<ChosenEffect> effects = asked_effects(page.opened->scene, settings);
  const bool has_effect_of_frames = !effects.empty() && is_of_frames(*effects.front().effect);
  for (std::size_t i = 0; i < page.drawn.size(); ++i) {
    if (page.drawn[i] && same_drawing(page.drawn[i]->settings, settings, has_effect_of_frames)) {
      std::swap(page.drawn[0], page.drawn[i]);
      return page.drawn[0];
    }
  }
  const auto start = std::chrono::steady_clock::now();
  auto drawn = std::make_shared<Drawn>();
  drawn->settings = settings;
  if (page.opened->stress_case) {
    draw_opened_case(page, *drawn);
  } else {
    drawn->scene = shot.scene;
    drawn->camera = shot.scene->camera;
    Shot for_any_lens = shot;
    for_any_lens.lens.reset();
    draw_scene_of(page, for_any_lens, *drawn);
  }
  drawn->ms = milliseconds_since(start);
  if (const SceneShadows* shadows = shadows_of(page)) drawn->shadows = counts_of(*shadows);
  std::rotate(page.drawn.begin(), page.drawn.end() - 1, page.drawn.end());
  page.drawn[0] = drawn;
  return drawn;
}

Shot shot_of_drawn(Page& page, const Drawn& drawn, const FrameSettings& settings) {
  Shot shot = asked_shot(page, settings);
  if (!drawn.trial) return shot;
  const Image& picture = drawn.picture();
  shot.frame = 0.0;
  shot.width = picture.width;
  shot.height = picture.height;
  if (settings.focus_at && shot.lens) {
    shot.lens->focus_at = pixel_at(*settings.focus_at, picture.width, picture.height);
  }
  if (drawn.scene != nullptr) {
    shot.scene = drawn.scene;
  } else {
    shot.layers = 0;  // there is the picture alone
  }
  return shot;
}

UsedLens used_lens(const Page& page, const Drawn& drawn, const FrameSettings& settings,
                   const Shot& shot) {
  try {
    UsedLens used = *focused_lens(shot, drawn.frame, *page.pool);
    if (drawn.trial_frame != nullptr) {
      set_case_lens(used, page.opened->scene.lens, drawn, settings, shot, *page.pool);
    }
    return used;
  } catch (const LensError& error) {
    const ThinLens& lens = error.lens.lens;
    if (lens_error(lens) == nullptr) check_pixel_coc(error.lens.settings.coc);
    throw UsageError("the lens is " + short_number(lens.focal_length_mm) + " mm, focused at " +
                     short_number(lens.focus_m) + " m: " + error.what());
  }
}

Image made_picture(const Page& page, const Drawn& drawn, const Shot& shot,
                   const std::optional<UsedLens>& lens, FrameMemory& memory,
                   std::optional<double> slice_ms) {
  if (drawn.scene == nullptr && shot.show == Show::image && shot.method.filter == nullptr) {
    throw UsageError("this case is made as a picture: methods that draw the scene have none");
  }
  const auto start = std::chrono::steady_clock::now();
  if (slice_ms && !memory.begun) memory.begun.emplace();
  FrameHooks hooks;
  hooks.on_samples = [&](int samples) {
    stop_if_cancelled(page);
    const bool is_late = slice_ms && milliseconds_since(start) > *slice_ms;
    if (is_late && samples < shot.sampling.samples) throw Interrupted{samples};
  };
  Frame frame = make_picture(shot, drawn.frame, lens, memory, *page.pool, hooks);
  finish_picture(shot, frame, *page.pool);
  return std::move(frame.picture);
}

}  // namespace softfocus
