#include <algorithm>
#include <array>
#include <string_view>

#include "scenes/draw/shadowed_layers.h"
#include "scenes/draw/velocity.h"
#include "scenes/frame/frame.h"
#include "scenes/load/load_scene.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

constexpr std::array<std::string_view, 3> kScenes{"figures", "cube-room", "sphere-world"};
constexpr std::string_view kMovingScene = "cube-room";

// These draw what the first three lack: one small frame each, by a few methods.
constexpr std::array<std::string_view, 18> kMoreScenes{
    "bright-edges", "canopy",        "clutter",  "crossing", "dunes",      "foliage",
    "glass",        "grazing-floor", "interior", "lattice",  "near-fence", "night-lights",
    "portrait",     "windmill",      "random:1", "random:6", "random:20",  "random:48"};
// Of these, its pictures with an open shutter too: things that are seen through move in it.
constexpr std::array<std::string_view, 3> kShutterScenes{"crossing", "glass", "windmill"};
constexpr std::array<std::string_view, 3> kFewMethods{"pinhole", "two-pass", "disc-layers"};

// Whole tiles, and parts of tiles.
constexpr std::array kSizes{FrameSize{128, 128}, FrameSize{97, 61}};

// By this frame everything that moves has moved.
constexpr double kFrame = 7.0;

// Circles have the size that they have in 512 rows: in these few rows nearly all would lie in one
// pixel.
constexpr double kRows = 512.0;

DofSettings settings_for(const Scene& scene, int height) {
  DofSettings settings;
  settings.coc = pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, height,
                           scene.lens.coc_scale * kRows / height);
  settings.max_coc_px = static_cast<float>(scene.lens.max_coc_px_at_1024 * kRows / 1024.0);
  return settings;
}

std::string entry_name(std::string_view scene, std::string_view method, const std::string& where) {
  std::string name{scene};
  name += ' ';
  name += method;
  name += where;
  return name;
}

/// A scene's frame, drawn for its methods.
struct DrawnScene {
  Shot shot;
  DrawnFrame drawn;
  UsedLens lens;
};

DrawnScene drawn_scene(const Scene& scene, const FrameSize& size, const Profile& profile,
                       ThreadPool& pool) {
  const auto [width, height] = size;
  DrawnScene made{.shot = {.scene = &scene,
                           .frame = kFrame,
                           .width = width,
                           .height = height,
                           .layers = 0,
                           .profile = profile},
                  .drawn = {},
                  .lens = {.lens = scene.lens.lens,
                           .aperture_radius_m = aperture_radius_m(
                               scene.lens.lens, scene.lens.coc_scale * kRows / height),
                           .settings = settings_for(scene, height)}};
  FrameMemory memory;
  draw_shot(made.shot, memory, made.drawn, pool);
  made.shot.layers.reset();
  made.drawn.layers = 0;
  return made;
}

std::uint64_t hash_by(std::string_view method, const DrawnScene& made, const Sampling& sampling,
                      ThreadPool& pool) {
  Shot shot = made.shot;
  shot.method = find_method_choice(method);
  shot.sampling = sampling;
  FrameMemory memory{.is_last = true};
  return hash_image(make_picture(shot, made.drawn, made.lens, memory, pool).picture);
}

// A fourth is empty in some scenes, and so the same in all profiles.
constexpr std::size_t kGoldenLayers = 3;

// Adds a line for each layer behind the first.
void add_layer_hashes(std::string_view scene, const std::vector<Image>& layers,
                      const std::string& where, std::vector<NamedHash>& hashes) {
  for (std::size_t i = 1; i < layers.size(); ++i) {
    hashes.push_back(
        {entry_name(scene, "layer-" + std::to_string(i + 1), where), hash_image(layers[i])});
  }
}

/// A line for each effect, with the numbers that it has by itself.
void add_effect_hashes(std::string_view scene, const Image& picture, const Profile& profile,
                       const std::string& where, std::vector<NamedHash>& hashes, ThreadPool& pool) {
  for (const Effect& effect : effects()) {
    if (effect.velocity != VelocityOf::nothing) continue;  // add_motion_hashes()
    if (effect.filter == nullptr) continue;                // add_history_hashes()
    std::vector<double> parameters;
    for (const Parameter& parameter : effect.parameters) {
      parameters.push_back(parameter.preset);
    }
    hashes.push_back({entry_name(scene, effect.name, where),
                      hash_image(apply(effect, {picture, parameters, profile}, pool))});
  }
}

// Views in lens and time: a set, one that grows, and the sequence.
void add_shutter_hashes(std::string_view scene, const DrawnScene& made, const std::string& where,
                        std::vector<NamedHash>& hashes, ThreadPool& pool) {
  const auto add = [&](std::string_view name, const Sampling& sampling) {
    hashes.push_back(
        {entry_name(scene, name, where), hash_by("accumulation", made, sampling, pool)});
  };
  add("accumulation-shutter", {.samples = 5, .jitter = true, .shutter_frames = 2.0});
  add("accumulation-shutter-by-tile",
      {.samples = 3 * kSampleGroup, .by_tile = true, .shutter_frames = 2.0});
  add("accumulation-shutter-until", {.samples = 9, .until = 0.0, .shutter_frames = 2.0});
}

/// Velocity, drawn and from depth, and a line for each effect that reads it. The camera goes
/// around.
void add_motion_hashes(std::string_view name, Scene scene, const FrameSize& size,
                       const Profile& profile, const std::string& where,
                       std::vector<NamedHash>& hashes, ThreadPool& pool) {
  scene.camera.orbit_degrees_per_frame = 4.0;
  const auto [width, height] = size;
  const CameraMatrices view = camera_matrices(scene.camera, kFrame, width, height);
  const Image picture = draw_scene(scene, view, kFrame, width, height, profile, pool);
  for (const Effect& effect : effects()) {
    if (effect.velocity == VelocityOf::nothing) continue;
    ChosenEffect chosen{&effect, {}};
    for (const Parameter& parameter : effect.parameters) {
      chosen.parameters.push_back(parameter.preset);
    }
    const Image velocity = velocity_for(chosen, scene, kFrame, picture, profile, pool);
    const Image blurred = apply(effect, {picture, chosen.parameters, profile, velocity}, pool);
    hashes.push_back({entry_name(name, effect.name, where), hash_image(blurred)});
    if (effect.name == "motion-blur") {
      hashes.push_back({entry_name(name, "velocity", where), hash_image(velocity)});
    } else if (effect.velocity == VelocityOf::camera) {
      hashes.push_back({entry_name(name, "camera-velocity", where), hash_image(velocity)});
    }
  }
}

/// The fourth of four frames by each effect of frames. The camera goes around.
void add_history_hashes(std::string_view name, Scene scene, const FrameSize& size,
                        const Profile& profile, const std::string& where,
                        std::vector<NamedHash>& hashes, ThreadPool& pool) {
  constexpr int kFrames = 4;
  scene.camera.orbit_degrees_per_frame = 4.0;
  PreparedScene prepared = prepare_scene(scene, profile, pool);
  const auto add = [&](std::string_view entry, const FrameEffect& effect) {
    FrameHistory history;
    for (int i = 0; i < kFrames; ++i) {
      draw_next(prepared, effect, kFrame + i, size.width, size.height, history, pool);
    }
    hashes.push_back({entry_name(name, entry, where), hash_image(history.picture)});
  };
  add("temporal-aa", TemporalAa{});
  add("temporal-aa-extent", TemporalAa{{0.05f, HistoryBox::extent}, 16, {}});
  add("refresh", Refresh{});
  add("reproject", Reproject{4});
  add("reproject-forward", Reproject{4, true, UnseenPixels::filled});
}

/// Two layers whose lights have shadows.
void add_shadow_hashes(std::string_view name, Scene scene, ShadowKind kind, std::string_view entry,
                       const CameraMatrices& view, const FrameSize& size, const Profile& profile,
                       const std::string& where, std::vector<NamedHash>& hashes, ThreadPool& pool) {
  set_shadows(scene, kind);
  const auto [width, height] = size;
  const std::vector<Image> layers =
      draw_layers(scene, view, kFrame, width, height, 2, profile, pool);
  hashes.push_back({entry_name(name, entry, where), hash_image(layers[0])});
  hashes.push_back(
      {entry_name(name, std::string{entry} + "-layer-2", where), hash_image(layers[1])});
}

/// Shadows by maps: of one texel's kernel, and shares of cascades.
void add_map_hashes(std::string_view name, Scene scene, const CameraMatrices& view,
                    const FrameSize& size, const Profile& profile, const std::string& where,
                    std::vector<NamedHash>& hashes, ThreadPool& pool) {
  set_shadows(scene, ShadowKind::map);
  const auto add = [&](std::string_view entry, const ShadowMapSettings& settings) {
    for (Light& light : scene.lights) light.map = settings;
    hashes.push_back(
        {entry_name(name, entry, where),
         hash_image(draw_scene(scene, view, kFrame, size.width, size.height, profile, pool))});
  };
  add("shadows-map", {.size = 256, .bias = 0.5, .slope_bias = 0.75});
  add("shadows-map-pcf",
      {.size = 128, .bias = 0.5, .slope_bias = 0.75, .kernel = 3, .cascades = 2});
}

/// Soft shadows that take half of the light.
NamedHash soft_hash(std::string_view name, Scene scene, const CameraMatrices& view,
                    const FrameSize& size, const Profile& profile, const std::string& where,
                    ThreadPool& pool) {
  set_shadows(scene, ShadowKind::projected);
  for (Light& light : scene.lights) {
    light.radius_m = 0.2;
    light.angular_radius_degrees = 2.0;
    light.shadow_darkness = 0.5f;
  }
  scene.light_points = 3;
  return {entry_name(name, "shadows-soft", where),
          hash_image(draw_scene(scene, view, kFrame, size.width, size.height, profile, pool))};
}

/// Shadows whose terminators have a rule.
NamedHash terminator_hash(std::string_view name, Scene scene, Terminator rule,
                          std::string_view entry, const CameraMatrices& view, const FrameSize& size,
                          const Profile& profile, const std::string& where, ThreadPool& pool) {
  set_shadows(scene, ShadowKind::projected);
  for (Light& light : scene.lights) light.terminator = rule;
  return {entry_name(name, entry, where),
          hash_image(draw_scene(scene, view, kFrame, size.width, size.height, profile, pool))};
}

std::vector<NamedHash> few_frame_hashes(std::string_view name, ThreadPool& pool) {
  const Scene scene = load_scene(name, scene_search_path({}), &pool);
  const auto [width, height] = kSizes[1];
  const Profile profile;
  const DrawnScene made = drawn_scene(scene, kSizes[1], profile, pool);
  const CameraMatrices& view = made.drawn.view;
  const std::string where = " ieee " + std::to_string(width) + 'x' + std::to_string(height);
  std::vector<NamedHash> hashes;
  hashes.reserve(kFewMethods.size() + 5 + kGoldenLayers);
  const auto add = [&](std::string_view entry, std::string_view method, const Sampling& sampling) {
    hashes.push_back({entry_name(name, entry, where), hash_by(method, made, sampling, pool)});
  };
  for (const std::string_view method : kFewMethods) add(method, method, {});
  add("accumulation", "accumulation", {.samples = 5});
  add("filtered-views", "filtered-views", {.samples = 5});
  add("warped-accumulation", "warped-accumulation", {.samples = 12, .drawn_views = 3});
  const Sampling by_tile{.samples = 3 * kSampleGroup, .jitter = true, .by_tile = true};
  add("accumulation-by-tile", "accumulation", by_tile);
  add("filtered-views-by-tile", "filtered-views", by_tile);
  const std::vector<Image> layers =
      draw_layers(scene, view, kFrame, width, height, kGoldenLayers, profile, pool);
  add_layer_hashes(name, layers, where, hashes);
  if (std::find(kShutterScenes.begin(), kShutterScenes.end(), name) != kShutterScenes.end()) {
    add_shutter_hashes(name, made, where, hashes, pool);
  }
  return hashes;
}

}  // namespace

std::span<const std::string_view> golden_scenes() { return kScenes; }

std::span<const std::string_view> more_golden_scenes() { return kMoreScenes; }

std::span<const FrameSize> golden_sizes(GoldenSet set) {
  return std::span{kSizes}.subspan(set == GoldenSet::all ? 0 : 1);
}

std::vector<GoldenScene> load_golden_scenes(ThreadPool& pool) {
  std::vector<GoldenScene> scenes;
  scenes.reserve(kScenes.size());
  for (const std::string_view name : kScenes) {
    scenes.push_back({std::string{name}, load_scene(name, scene_search_path({}), &pool)});
  }
  return scenes;
}

std::vector<NamedHash> frame_hashes(const GoldenScene& golden, const FrameSize& size,
                                    const NamedProfile& known, ThreadPool& pool) {
  // A whole group of sums and a part of one.
  const Sampling sampling{.samples = kSampleGroup + 3, .jitter = true, .aperture = {7}};
  const std::string& name = golden.name;
  const Scene& scene = golden.scene;
  const auto [width, height] = size;
  const Profile& profile = known.profile;
  DrawnScene made = drawn_scene(scene, size, profile, pool);
  const CameraMatrices& view = made.drawn.view;
  const Image& picture = made.drawn.parts.opaque;
  const std::string where =
      ' ' + std::string{known.name} + ' ' + std::to_string(width) + 'x' + std::to_string(height);
  const std::vector<Image> layers =
      draw_layers(scene, view, kFrame, width, height, kGoldenLayers, profile, pool);
  std::vector<NamedHash> hashes;
  const auto add = [&](std::string_view entry, std::string_view method) {
    hashes.push_back({entry_name(name, entry, where), hash_by(method, made, sampling, pool)});
  };
  made.shot.scene = nullptr;  // methods have the layers, and no objects
  for (const Method& method : methods()) {
    made.drawn.parts.behind.assign(layers.begin() + 1,
                                   layers.begin() + static_cast<std::ptrdiff_t>(method.layers));
    add(method.name, method.name);
  }
  made.drawn.parts.behind.clear();
  add_layer_hashes(name, layers, where, hashes);
  if (width == kSizes[1].width) {
    add_effect_hashes(name, picture, profile, where, hashes, pool);
    if (name == kMovingScene) {
      add_motion_hashes(name, scene, size, profile, where, hashes, pool);
      add_history_hashes(name, scene, size, profile, where, hashes, pool);
    }
    // A second's work for each of the others.
    if (name == "cube-room" || known.name == "ieee") {
      add_shadow_hashes(name, scene, ShadowKind::projected, "shadows", view, size, profile, where,
                        hashes, pool);
      add_map_hashes(name, scene, view, size, profile, where, hashes, pool);
    }
    if (known.name == "ieee") {
      add_shadow_hashes(name, scene, ShadowKind::volumes, "shadows-volumes", view, size, profile,
                        where, hashes, pool);
      if (name != "sphere-world") {
        hashes.push_back(soft_hash(name, scene, view, size, profile, where, pool));
      }
      const std::vector<NamedHash> of_relief = relief_hashes(golden, pool);
      hashes.insert(hashes.end(), of_relief.begin(), of_relief.end());
      if (name == "figures") {
        hashes.push_back(terminator_hash(name, scene, Terminator::normals, "shadows-normals", view,
                                         size, profile, where, pool));
        hashes.push_back(terminator_hash(name, scene, Terminator::fade, "shadows-fade", view, size,
                                         profile, where, pool));
      }
    }
  }
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::fixed_8}) {
    made.shot.arithmetic = arithmetic;
    add("two-pass-" + std::string{arithmetic_name(arithmetic)}, "two-pass");
  }
  made.shot.scene = &scene;
  for (const char* const method : {"accumulation", "filtered-views", "surface-splatting"}) {
    add(method, method);
  }
  return hashes;
}

std::vector<NamedHash> more_frame_hashes(std::span<const std::string_view> scenes,
                                         ThreadPool& pool) {
  std::vector<std::vector<NamedHash>> by_scene(scenes.size());
  pool.for_each(static_cast<int>(by_scene.size()), [&](int i) {
    ThreadPool one(1, pool.isa());
    const auto index = static_cast<std::size_t>(i);
    by_scene[index] = few_frame_hashes(scenes[index], one);
  });
  std::vector<NamedHash> hashes;
  for (const auto& of_scene : by_scene) {
    hashes.insert(hashes.end(), of_scene.begin(), of_scene.end());
  }
  return hashes;
}

}  // namespace softfocus
