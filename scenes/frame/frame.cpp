#include "scenes/frame/frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "dof/halve.h"
#include "dof/lens.h"
#include "dof/show.h"
#include "raster/images/texel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/draw/seen_facets.h"
#include "scenes/draw/velocity.h"
#include "scenes/load/pipeline_file.h"
#include "scenes/relief/impostors/scene_impostors.h"

namespace softfocus {
namespace {

void tell(const FrameHooks& hooks, FrameStage stage) {
  if (hooks.on_stage) hooks.on_stage(stage);
}

std::size_t layers_of(const Shot& shot) {
  return shot.layers.value_or(shot.show == Show::image ? shot.method.layers() : 1);
}

bool is_filtered(const Shot& shot) {
  return shot.show == Show::image && shot.method.filter != nullptr;
}

/// The depth of the focus, if it is known: no filter looks behind what is in focus.
std::optional<double> sharp_depth(const Shot& shot) {
  if (!is_filtered(shot) || !shot.lens) return {};
  const ShotLens& lens = *shot.lens;
  if (lens.focus_at || !lens.sharp_depths.empty()) return {};
  return static_cast<double>(static_cast<float>(lens.lens.focus_m));  // as PixelCoc has it
}

void draw_after_others(const Shot& shot, const ChosenEffect& effect, PreparedScene& prepared,
                       int width, int height, DrawnFrame& drawn, ThreadPool& pool) {
  FrameSequence own{.first = shot.frame};
  FrameSequence& sequence = shot.sequence != nullptr ? *shot.sequence : own;
  draw_up_to(prepared, effect, shot.frame, width, height, sequence, pool);
  // What is transparent is in the picture, and filtered with it.
  drawn.parts.opaque = sequence.history.picture;
  drawn.parts.blended = {};
  drawn.parts.transparent.clear();
  drawn.parts.edges.samples = 1;
  drawn.shaded_share = sequence.history.shaded_share;
}

// Of the surfaces that edges alone show.
float largest_edge_circle_px(const EdgePictures& edges, const PixelCoc& coc) {
  float most = 0.0f;
  if (edges.samples == 1) return most;
  for (int y = 0; y < edges.other.height; ++y) {
    const auto coverage = row<std::uint8_t>(edges.coverage, y);
    const auto texels = row<std::uint16_t>(edges.other, y);
    for (std::size_t x = 0; x < coverage.size(); ++x) {
      if (coverage[x] == 0) continue;
      const float radius = std::fabs(coc_radius_px(coc, half_to_float(texels[4 * x + 3])));
      if (radius > most) most = radius;  // NaN is none
    }
  }
  return most;
}

// Of each picture that is blurred by itself.
float largest_circle_px(const FrameParts& parts, const PixelCoc& coc, ThreadPool& pool) {
  float most = std::max(circle_sizes(parts.opaque, coc, 0.0f, pool).largest_px,
                        largest_edge_circle_px(parts.edges, coc));
  for (const TransparentPicture& layer : parts.transparent) {
    most = std::max(most, circle_sizes(layer.colour, coc, 0.0f, pool).largest_px);
  }
  return most;
}

// Without depth of field.
Image pinhole_of(const Shot& shot, const FrameParts& parts, ThreadPool& pool) {
  if (parts.edges.samples == 1) return parts.picture();
  return with_dof_input(parts, {}, shot.profile, {}, {}, [&](const DofInput& input) {
    return apply(*find_method("pinhole"), input, pool);
  });
}

Image wireframe_of(const Shot& shot, const DrawnFrame& of, const Image& drawn, ThreadPool& pool) {
  const int width = drawn.width, height = drawn.height;
  NumberedScene numbered = number_triangles(*shot.scene, shot.profile, pool.isa());
  const std::vector<SeenFacet> seen =
      draw_seen_facets(numbered, *shot.scene, of.view, shot.frame, width, height, 1, pool, {})[0];
  Image result = drawn;
  const glm::vec4 background = clear_colour(*shot.scene);
  pool.for_each(height, [&](int y) {
    const auto facet_at = [&](int x, int row) {
      const int column = std::clamp(x, 0, width - 1);
      return seen[static_cast<std::size_t>(std::clamp(row, 0, height - 1)) *
                      static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
    };
    for (int x = 0; x < width; ++x) {
      const SeenFacet own = facet_at(x, y);
      const bool is_line = own != 0 && (facet_at(x + 1, y) != own || facet_at(x, y + 1) != own ||
                                        facet_at(x - 1, y) == 0 || facet_at(x, y - 1) == 0);
      if (is_line) continue;
      const float depth_m = load_texel<Format::rgba16f>(drawn, x, y).w;
      store_texel<Format::rgba16f>(result, x, y, {glm::vec3{background}, depth_m}, shot.profile);
    }
  });
  return result;
}

Image map_of(const Shot& shot, const Image& drawn, const std::optional<UsedLens>& lens,
             ThreadPool& pool) {
  switch (shot.show) {
    case Show::coc: return show_coc(drawn, lens->settings.coc, lens->settings.max_coc_px, pool);
    case Show::depth:
      return show_depth(drawn, static_cast<float>(shot.scene->camera.near_m),
                        static_cast<float>(shot.scene->camera.far_m), pool);
    default: return drawn;
  }
}

/// Memory for a picture like this one.
Image picture_like(const Image& drawn, FrameMemory& memory) {
  Image picture = std::exchange(memory.picture, {});
  if (picture.format == drawn.format && picture.width == drawn.width &&
      picture.height == drawn.height && !picture.bytes.empty()) {
    return picture;
  }
  return make_image(drawn.format, drawn.width, drawn.height);
}

Image filtered(const Shot& shot, const DrawnFrame& drawn, const UsedLens& lens, FrameMemory& memory,
               ThreadPool& pool, const FrameHooks& hooks) {
  const Method& method = *shot.method.filter;
  const FrameParts& parts = drawn.parts;
  if (hooks.filter) return hooks.filter(method, lens.settings, parts.opaque);
  if (shot.arithmetic != Arithmetic::floats) {
    Image result = picture_like(parts.picture(), memory);
    two_pass_in(shot.arithmetic, {parts.picture(), lens.settings, shot.profile}, result, pool);
    return result;
  }
  const std::size_t layers = layers_of(shot);
  const bool reads_more = layers > 1 || (shot.scene != nullptr && has_transparent(*shot.scene));
  if (shot.scene != nullptr && drawn.layers < layers && reads_more) {
    return filtered_frame(method, *shot.scene, drawn.view, shot.frame, parts.picture(),
                          lens.settings, shot.profile, pool, drawn.stand_ins);
  }
  std::vector<std::uint16_t> objects;
  if (drawn.objects.empty() && layers > 0 && shot.scene != nullptr) {
    objects = object_numbers_for(method, *shot.scene, drawn.view, shot.frame, parts.opaque.width,
                                 parts.opaque.height, shot.profile, pool);
  }
  Image result = picture_like(parts.opaque, memory);
  with_dof_input(parts, lens.settings, shot.profile, objects.empty() ? drawn.objects : objects,
                 lens.radii_px, [&](const DofInput& input) { apply(method, input, result, pool); });
  return result;
}

void sample_lens(const Shot& shot, const LensViewInput& views, Frame& frame, ThreadPool& pool) {
  SampledPicture sampled = shot.method.of_scene->render(views, pool);
  frame.picture = std::move(sampled.picture);
  if (shot.method.samples_lens()) frame.sampled = std::move(sampled);
}

void choose_and_draw(const Shot& shot, const DrawnFrame& drawn, const LensViewInput& views,
                     Frame& frame, ThreadPool& pool, const FrameHooks& hooks) {
  const auto on_stage = [&](AutoStage stage) {
    tell(hooks, stage == AutoStage::choosing    ? FrameStage::choosing
                : stage == AutoStage::filtering ? FrameStage::filtering
                : stage == AutoStage::sampling  ? FrameStage::sampling
                                                : FrameStage::checking);
  };
  AutoPicture found = auto_picture(
      {.views = views,
       .settings = frame.lens->settings,
       .goal = shot.goal,
       .limits = {shot.most_coc_px, drawn.triangles.value_or(triangle_count(*shot.scene))},
       .verify = shot.verify,
       .on_stage = on_stage},
      pool);
  frame.picture = std::move(found.picture);
  const AutoMethod& choice = found.choice;
  frame.method = find_method_choice(choice.method);
  if (choice.samples > 0) {
    frame.sampling.samples = choice.samples;
    frame.sampled = SampledPicture{.picture = {}, .samples = choice.samples};
  } else {
    frame.lens->settings.max_coc_px = choice.radius_px;
  }
  frame.chosen = std::move(found);
}

LensViewInput views_of(const Shot& shot, const DrawnFrame& drawn, const UsedLens& lens,
                       FrameMemory& memory, const FrameHooks& hooks) {
  LensViewInput views = lens_views_of(shot, drawn, lens);
  views.progress = hooks.on_samples;
  if (!memory.is_last) {
    views.memory = &memory.views;
  } else if (memory.prepared) {
    views.prepared = &*memory.prepared;
  }
  if (memory.begun) views.begun = &*memory.begun;
  return views;
}

}  // namespace

namespace {

// The hooks that drawing tells, while this lives: they refer to the caller's.
struct ToldHooks {
  ToldHooks(PreparedScene& of, const FrameHooks& hooks) : prepared(of) {
    prepared.on_light_points = hooks.on_light_points;
    prepared.on_shadows = hooks.on_shadows;
  }
  ~ToldHooks() {
    prepared.on_light_points = {};
    prepared.on_shadows = {};
  }
  ToldHooks(const ToldHooks&) = delete;
  ToldHooks& operator=(const ToldHooks&) = delete;

  PreparedScene& prepared;
};

}  // namespace

MethodChoice find_method_choice(std::string_view name) {
  if (is_pipeline_name(name)) return {pipeline_method(std::string{name})};
  return {find_method(name), find_lens_view_method(name)};
}

Shot shot_of(const Scene& scene, double frame, int width, int height, const MethodChoice& method) {
  Shot shot{.scene = &scene,
            .frame = frame,
            .width = width,
            .height = height,
            .method = method,
            .effects = scene.effects};
  shot.lens = {lens_at(scene.lens, frame), scene.lens.coc_scale};
  shot.lens->settings.max_coc_px =
      std::min(static_cast<float>(scene.lens.max_coc_px_at_1024 * height / 1024.0), kLargestMaxCoc);
  shot.lens->cuts_no_circle = method.takes_any_radius();
  if (method.samples_lens()) shot.sampling.samples = method.of_scene->usual_samples;
  if (method.has_shutter()) shot.sampling.shutter_frames = scene.camera.shutter_frames;
  return shot;
}

Frame make_frame(const Shot& shot, ThreadPool& pool, const FrameHooks& hooks) {
  FrameMemory memory{.is_last = true};
  DrawnFrame drawn;
  draw_shot(shot, memory, drawn, pool, hooks);
  tell(hooks, FrameStage::focusing);
  const std::optional<UsedLens> lens = focused_lens(shot, drawn, pool);
  if (hooks.on_drawn) hooks.on_drawn(drawn, lens);
  if (shot.show != Show::image || is_filtered(shot)) memory.prepared.reset();
  Frame frame = make_picture(shot, drawn, lens, memory, pool, hooks);
  if (shot.show != Show::image) {
    for (const Image& layer : drawn.parts.behind) {
      frame.behind.push_back(map_of(shot, layer, lens, pool));
    }
  }
  finish_picture(shot, frame, pool, hooks);
  tell(hooks, FrameStage::done);
  return frame;
}

void draw_shot(const Shot& shot, FrameMemory& memory, DrawnFrame& drawn, ThreadPool& pool,
               const FrameHooks& hooks) {
  tell(hooks, FrameStage::drawing);
  const int width = shot.width * shot.supersample, height = shot.height * shot.supersample;
  drawn.view = camera_matrices(shot.scene->camera, shot.frame, width, height);
  drawn.layers = layers_of(shot);
  if (hooks.draw) {
    drawn.parts = hooks.draw(drawn.view, width, height, drawn.layers);
    return;
  }
  if (!memory.prepared) {
    memory.prepared = prepare_scene(*shot.scene, shot.profile, pool);
    memory.prepared->stand_ins = shot.stand_ins;
    if (shot.stand_ins == nullptr && has_impostors(*shot.scene)) {
      memory.prepared->stand_ins = stand_ins_of(make_scene_impostors(*shot.scene, pool));
    }
  }
  drawn.stand_ins = memory.prepared->stand_ins;
  const ToldHooks told{*memory.prepared, hooks};
  const bool is_after_others = !shot.effects.empty() && is_of_frames(*shot.effects.front().effect);
  if (!is_after_others || drawn.layers > 1) {
    // Maps show one surface a pixel; methods that draw the scene have --jitter.
    const bool smooths = shot.show == Show::pinhole || is_filtered(shot);
    draw_parts(*memory.prepared, drawn.view, shot.frame, width, height, drawn.layers, drawn.parts,
               pool, sharp_depth(shot), smooths && !is_after_others ? shot.samples : 1);
    if (shot.blends) blend(drawn.parts, shot.profile, pool);
  }
  if (is_after_others) {
    draw_after_others(shot, shot.effects.front(), *memory.prepared, width, height, drawn, pool);
  }
  drawn.triangles = memory.prepared->triangles;
  if (is_filtered(shot) && drawn.layers > 0) {
    drawn.objects = object_numbers_for(*shot.method.filter, *shot.scene, drawn.view, shot.frame,
                                       width, height, shot.profile, pool);
  }
}

namespace {

/// The pixel that fits and is nearest to another, or this if none fits.
template <class Fits>
glm::ivec2 nearest_pixel(glm::ivec2 middle, int width, int height, const Fits& fits) {
  if (fits(middle)) return middle;
  glm::ivec2 nearest = middle;
  int least = std::numeric_limits<int>::max();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::ivec2 away = glm::ivec2{x, y} - middle;
      const int distance = away.x * away.x + away.y * away.y;
      if (distance >= least || !fits({x, y})) continue;
      least = distance;
      nearest = {x, y};
    }
  }
  return nearest;
}

}  // namespace

std::optional<UsedLens> focused_lens(const Shot& shot, const DrawnFrame& drawn, ThreadPool& pool) {
  if (!shot.lens) return {};
  const ShotLens& wanted = *shot.lens;
  const Image& picture = drawn.parts.picture();
  UsedLens used{.lens = wanted.lens, .coc_scale = wanted.coc_scale, .settings = wanted.settings};
  if (wanted.focus_at) {
    const auto depth_at = [&](glm::ivec2 pixel) {
      const glm::ivec2 at = pixel * shot.supersample + shot.supersample / 2;
      return load_texel<Format::rgba16f>(picture, at.x, at.y).w;
    };
    used.focus_at = wanted.focus_at;
    if (wanted.focuses_on_a_thing) {
      const float background = alpha_depth(static_cast<float>(shot.scene->camera.far_m));
      const auto is_thing = [&](glm::ivec2 pixel) {
        return depth_at(pixel) < background * 0.999f;  // which is rounded to half
      };
      used.focus_at = nearest_pixel(*wanted.focus_at, shot.width, shot.height, is_thing);
    }
    used.lens.focus_m = static_cast<double>(depth_at(*used.focus_at));
  }
  if (wanted.sharp_depths.empty()) {
    if (const char* error = lens_error(used.lens)) throw LensError(error, used);
  }
  used.aperture_radius_m = aperture_radius_m(used.lens, used.coc_scale);
  used.settings.frame = {.near_m = shot.scene->camera.near_m,
                         .far_m = shot.scene->camera.far_m,
                         .aperture_radius_m = used.aperture_radius_m,
                         .number = shot.frame};
  PixelCoc& coc = used.settings.coc;
  coc = pixel_coc(used.lens, shot.scene->camera.fov_y_degrees, picture.height, used.coc_scale);
  if (!std::isfinite(coc.radius_at_infinity_px) || !std::isfinite(coc.focus_m)) {
    throw LensError("the lens's circles are too large to compute with", used);
  }
  if (!wanted.sharp_depths.empty()) {
    used.radii_px = sharp_depths_radii(picture, wanted.sharp_depths, pool);
  }
  if (wanted.cuts_no_circle) {
    used.settings.max_coc_px = std::ceil(
        used.radii_px.empty() ? largest_circle_px(drawn.parts, coc, pool)
                              : *std::max_element(used.radii_px.begin(), used.radii_px.end()));
  }
  if (shot.show == Show::image && shot.arithmetic != Arithmetic::floats) {
    if (const char* error = fixed_settings_error(used.settings)) throw LensError(error, used);
  }
  return used;
}

Frame make_picture(const Shot& shot, const DrawnFrame& drawn, const std::optional<UsedLens>& lens,
                   FrameMemory& memory, ThreadPool& pool, const FrameHooks& hooks) {
  Frame frame{.view = drawn.view,
              .lens = lens,
              .method = shot.method,
              .sampling = shot.sampling,
              .shaded_share = drawn.shaded_share,
              .samples = drawn.parts.edges.samples};
  const UsedLens used = lens.value_or(UsedLens{});
  if (shot.show != Show::image) {
    tell(hooks, FrameStage::filtering);
    frame.picture = shot.show == Show::pinhole ? pinhole_of(shot, drawn.parts, pool)
                    : shot.show == Show::wireframe
                        ? wireframe_of(shot, drawn, drawn.parts.picture(), pool)
                        : map_of(shot, drawn.parts.picture(), lens, pool);
  } else if (shot.shard) {
    tell(hooks, FrameStage::sampling);
    frame.sums = accumulation_sums(views_of(shot, drawn, used, memory, hooks),
                                   samples_of(*shot.shard, shot.sampling.samples), pool);
    frame.sampled = SampledPicture{.picture = {}, .samples = shot.sampling.samples};
    frame.picture = drawn.parts.picture();
  } else if (shot.method.filter != nullptr) {
    tell(hooks, FrameStage::filtering);
    frame.picture = filtered(shot, drawn, used, memory, pool, hooks);
  } else if (shot.method.of_scene != nullptr) {
    tell(hooks, FrameStage::sampling);
    sample_lens(shot, views_of(shot, drawn, used, memory, hooks), frame, pool);
  } else {
    choose_and_draw(shot, drawn, views_of(shot, drawn, used, memory, hooks), frame, pool, hooks);
  }
  return frame;
}

void finish_picture(const Shot& shot, Frame& frame, ThreadPool& pool, const FrameHooks& hooks) {
  if (shot.supersample == 2) {
    tell(hooks, FrameStage::halving);
    frame.picture = halve(frame.picture, shot.profile, pool);
    if (frame.lens) {
      DofSettings& settings = frame.lens->settings;
      settings.max_coc_px *= 0.5f;
      settings.coc = pixel_coc(frame.lens->lens, shot.scene->camera.fov_y_degrees, shot.height,
                               frame.lens->coc_scale);
    }
  }
  if (shot.effects.empty()) return;
  tell(hooks, FrameStage::effects);
  const auto make_velocity = [&](const ChosenEffect& chosen, const Image& of) {
    return velocity_for(chosen, *shot.scene, shot.frame, of, shot.profile, pool);
  };
  frame.picture =
      with_effects(std::move(frame.picture), shot.effects, make_velocity, shot.profile, pool);
}

LensViewInput lens_views_of(const Shot& shot, const DrawnFrame& drawn, const UsedLens& lens) {
  return {.scene = *shot.scene,
          .camera = drawn.view,
          .frame = shot.frame,
          .pinhole = drawn.parts.picture(),
          .focus_m = lens.lens.focus_m,
          .aperture_radius_m = lens.aperture_radius_m,
          .sampling = shot.sampling,
          .profile = shot.profile,
          .progress = {},
          .stand_ins = drawn.stand_ins};
}

Image with_effects(Image picture, const std::vector<ChosenEffect>& effects,
                   const MakeVelocity& make_velocity, const Profile& profile, ThreadPool& pool) {
  for (const ChosenEffect& chosen : effects) {
    if (is_of_frames(*chosen.effect)) continue;  // it has been drawn so
    Image velocity;
    EffectInput input{picture, chosen.parameters, profile};
    if (chosen.effect->velocity != VelocityOf::nothing) {
      velocity = make_velocity(chosen, picture);
      input.velocity = velocity;
    }
    picture = apply(*chosen.effect, input, pool);
  }
  return picture;
}

}  // namespace softfocus
