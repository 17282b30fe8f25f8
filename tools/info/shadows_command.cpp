// softfocus shadows: what a scene's shadows cost, projected ones by each schedule, and with --check
// how right they are.

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "scenes/draw/light_points.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/load/load_scene.h"
#include "scenes/make/shapes.h"
#include "scenes/shadows/embree_shadows.h"
#include "scenes/shadows/shadow_truth.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/timing.h"
#include "tools/gl/frame_on_gl.h"
#include "tools/info/shadow_measures.h"
#include "tools/options/run_options.h"
#include "tools/options/scene_options.h"

namespace softfocus {
namespace {

// Schedules of O(n^2) are left out beyond so many triangles.
constexpr std::size_t kMostForAllPairs = 20000;

struct MeasuredShadows {
  std::string_view name;
  ShadowKind kind;
};
constexpr std::array kMeasuredShadows{MeasuredShadows{"projected", ShadowKind::projected},
                                      MeasuredShadows{"volumes", ShadowKind::volumes},
                                      MeasuredShadows{"map", ShadowKind::map}};

struct ShadowsOptions {
  std::string scene;
  std::optional<int> triangles;  ///< of a sphere field in place of the scene
  std::vector<std::filesystem::path> scene_path;
  PictureSize size{1024, 1024};
  double frame = 0.0;
  int runs = 5;
  bool check = false;
  bool check_embree = false;          ///< too
  const Driver* versus = nullptr;     ///< draws the same stencil or maps
  std::optional<ShadowKind> shadows;  ///< of all lights, in place of what the scene says
  MapOptions map;
  bool map_table = false;
  LightOptions lights;
  bool soft_table = false;
  bool terminator_table = false;
  bool json = false;
  VolumeCount volume_count = VolumeCount::z_fail;
  PoolOptions pool;
};

Scene scene_of(const ShadowsOptions& options) {
  if (options.triangles) {
    return sphere_field(*options.triangles, static_cast<double>(options.size.width) /
                                                static_cast<double>(options.size.height));
  }
  Scene scene = load_scene(options.scene, scene_search_path(options.scene_path));
  print_scene_warnings(scene.warnings, false);
  return scene;
}

std::size_t bytes_kept(const SceneShadows& shadows) {
  std::size_t bytes = 0;
  for (const ProjectedShadows& of_light : shadows.projected) {
    bytes += of_light.triangles.size() * sizeof(ProjectedTriangle);
  }
  return bytes;
}

void add_volumes(const SceneShadows& shadows, Findings& found) {
  std::size_t edges = 0, faces = 0;
  for (const ShadowVolumes& volumes : shadows.volumes) {
    edges += volumes.silhouette_edges;
    faces += volumes.faces.size();
  }
  if (faces == 0) return;
  found.add({{"silhouette_edges", edges}, {"faces", faces}, {"ray_pixels", shadows.volume_rays}},
            "volumes");
}

/// Embree's rays, in binary32, beside ours, in binary64.
void check_embree(const SceneShadows& shadows, const std::vector<ShadowLight>& lights,
                  const ShadowView& view, glm::dvec3 eye, Findings& found, ThreadPool& pool) {
  const EmbreeDifferences differences =
      embree_differences(shadows.facets, lights, shadows.seen[0], view, eye, pool);
  std::size_t all = 0;
  for (const std::size_t of : differences.differ) all += of;
  Json members{{"seen", differences.seen}, {"differ", all}};
  for (std::size_t i = 0; i < kDifferenceReaches.size(); ++i) {
    members["within_1/" + short_number(1.0 / kDifferenceReaches[i]) + "_pixel_of_an_edge"] =
        differences.differ[i];
  }
  members["farther"] = differences.differ.back();
  found.add(members, "embree");
}

// The stencil of the first layer, by both.
void time_beside(const Driver& driver, const SceneShadows& shadows, const ShadowsOptions& options,
                 const CameraMatrices& camera, Findings& found, ThreadPool& pool) {
  const int width = options.size.width, height = options.size.height;
  MaskDraws draws = cut_shadows(shadows, camera, width, height, pool);
  ShadowsRepeatedOnGl on_gl{driver, draws,  static_cast<int>(shadows.lights.size()),
                            width,  height, pool.threads()};
  const ShadowView view{multiply(camera.eye_to_clip, camera.world_to_eye), width, height,
                        shadows.pass.profile};
  std::vector<std::uint8_t> mask(shadows.seen[0].size());
  on_gl.draw();
  std::vector<Milliseconds> times{
      {"stencil"}, {"stencil, " + std::string{driver.name}}, {"cutting, before either"}};
  time_in_turn(
      times, options.runs, [&] { draw_shadow_mask(draws, view, mask, pool); },
      [&] { on_gl.draw(); }, [&] { draws = cut_shadows(shadows, camera, width, height, pool); });
  const std::vector<std::uint8_t> theirs = on_gl.mask(draws.dark);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) differ += mask[i] != theirs[i];
  found.add_times(times);
  found.add_ratio(times,
                  {{"differ", differ}, {"pixels", mask.size()}, {"renderer", on_gl.renderer()}});
}

void time_projection(const Facets& facets, const std::vector<ShadowLight>& lights, int runs,
                     Findings& found, ThreadPool& pool) {
  ThreadPool one{1, pool.isa()};
  const auto all_lights = [&](const auto& project) {
    for (const ShadowLight& light : lights) project(light);
  };
  if (facets.facets.size() <= kMostForAllPairs) {
    std::vector<Milliseconds> times{
        {"project in sequence"}, {"project in parallel, 1"}, {"project in parallel, all"}};
    const auto in_parallel = [&](ThreadPool& by) {
      all_lights([&](const ShadowLight& light) { project_in_parallel(facets, light, by); });
    };
    time_in_turn(
        times, runs,
        [&] { all_lights([&](const ShadowLight& light) { project_in_sequence(facets, light); }); },
        [&] { in_parallel(one); }, [&] { in_parallel(pool); });
    found.add_times(times);
  }
  std::vector<Milliseconds> times{{"project by grid, 1"}, {"project by grid, all"}};
  const auto by_grid = [&](ThreadPool& by) {
    all_lights([&](const ShadowLight& light) { project_by_grid(facets, light, by); });
  };
  time_in_turn(
      times, runs, [&] { by_grid(one); }, [&] { by_grid(pool); });
  found.add_times(times);
}

void measure_shadows(const ShadowsOptions& options, Findings& found) {
  if (options.terminator_table) {
    if (!options.scene.empty() || options.triangles) {
      throw UsageError("--terminator-table: has shapes of its own; give no SCENE or --triangles");
    }
    ThreadPool pool{options.pool.threads, options.pool.isa};
    find_terminator_table(options.size, found, pool);
    return;
  }
  if (options.check_embree && !embree_shadows_missing().empty()) {
    throw UsageError("--check-embree: " + std::string{embree_shadows_missing()});
  }
  if (options.scene.empty() == !options.triangles) {
    throw UsageError("give one of SCENE and --triangles");
  }
  Scene scene = scene_of(options);
  Scene unshadowed = scene;
  set_shadows(unshadowed, ShadowKind::none);
  if (options.shadows) set_shadows(scene, *options.shadows);
  if (!has_shadows(scene)) set_shadows(scene, ShadowKind::projected);
  set_lights(options.lights, scene);
  // Terminators change light apart from shadows and their truth.
  for (Light& light : scene.lights) light.terminator = Terminator::facets;
  if (scene.lights.empty() || scene.lights.size() > kMostShadowLights) {
    throw UsageError("'" + scene.name + "' has " + std::to_string(scene.lights.size()) +
                     " lights; 1 to " + std::to_string(kMostShadowLights) + " would do");
  }
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const bool has_map = std::any_of(scene.lights.begin(), scene.lights.end(),
                                   [](const Light& of) { return of.shadows == ShadowKind::map; });
  if (has_map) set_shadows(scene, ShadowKind::map);
  const bool has_volumes =
      std::any_of(scene.lights.begin(), scene.lights.end(),
                  [](const Light& of) { return of.shadows == ShadowKind::volumes; });
  if (options.volume_count == VolumeCount::z_pass && !has_volumes) {
    throw UsageError("--z-pass: counts the faces of volumes; give --shadows volumes too");
  }
  if (options.versus != nullptr && has_volumes) {
    throw UsageError("--vs: times projected shadows and maps; --shadows projected or map would do");
  }
  if (options.versus != nullptr && options.map_table) {
    throw UsageError("--vs: does not go with --map-table");
  }
  set_maps(options.map, scene);
  if (options.check_embree && (has_map || has_soft_shadows(scene))) {
    throw UsageError(
        "--check-embree: checks projected shadows and volumes, of lights without a size");
  }
  if (options.soft_table && !has_soft_shadows(scene)) {
    throw UsageError("--soft-table: no light has a size; give --light-radius or --light-angle");
  }
  if (has_soft_shadows(scene) && (options.versus != nullptr || options.map_table)) {
    throw UsageError(
        "--vs, --map-table: time the shadows of lights without a size; "
        "--light-radius 0 or --light-angle 0 would be right");
  }
  const ShadowMeasure measure{scene, options.size, options.frame, options.runs, options.versus};
  if (has_soft_shadows(scene)) {
    if (options.soft_table) {
      find_soft_table(measure, found, pool);
    } else {
      measure_soft(measure, options.check, found, pool);
    }
    return;
  }
  if (options.map_table && !has_map) throw UsageError("--map-table: give --shadows map too");
  if (has_map) {
    if (options.map_table) {
      find_map_table(measure, found, pool);
    } else {
      measure_maps(measure, options.check, found, pool);
    }
    return;
  }
  // A GPU's has to be probed first; its bits are not expected to be ours.
  const Profile profile = options.versus == nullptr
                              ? Profile{}
                              : find_profile(options.versus->profile).value_or(Profile{});
  RepeatedShadows shadowed{scene, measure, pool, profile};
  RepeatedShadows kept{scene, measure, pool, profile}, moving{scene, measure, pool, profile};
  RepeatedShadows plain{unshadowed, measure, pool, profile};
  SceneShadows& shadows = shadowed.shadows();
  shadows.volume_count = options.volume_count;
  shadowed.draw();
  plain.draw();
  moving.draw();
  // A camera that moves while no light does has the shadows on all from its second frame on.
  kept.draw();
  kept.draw();
  place_shadows(shadows, scene, scene.lights, measure.frame, pool);
  std::size_t projected = 0;
  std::vector<ShadowLight> lights;
  for (std::size_t i = 0; i < shadows.lights.size(); ++i) {
    lights.push_back(shadow_light(scene.lights[shadows.lights[i]]));
    projected += shadows.projected[i].triangles.size();
  }
  found.add({{"scene", scene.name},
             {"triangles", shadows.facets.facets.size()},
             {"receivers", shadows.facets.receivers.size()},
             {"lights", lights.size()},
             {"projected_triangles", projected},
             {"projected_megabytes", static_cast<double>(bytes_kept(shadows)) / 1e6}});
  add_volumes(shadows, found);

  if (projected > 0) time_projection(shadows.facets, lights, options.runs, found, pool);
  if (!shadows.joined.facets.empty()) {
    std::vector<Milliseconds> times{{"join facets"}, {"make volumes"}};
    time_in_turn(
        times, options.runs, [&] { join_facets(shadows.facets); },
        [&] {
          for (const ShadowLight& light : lights) {
            make_shadow_volumes(shadows.facets, shadows.joined, light);
          }
        });
    found.add_times(times);
  }
  std::vector<Milliseconds> times{{"facets and receivers"},
                                  {"frame, nothing kept"},
                                  {"frame, lights moved"},
                                  {"frame, shadows kept"},
                                  {"frame without shadows"}};
  time_in_turn(
      times, options.runs, [&] { scene_facets(scene, options.frame); },
      [&] { shadowed.draw_anew(); }, [&] { moving.draw_moved(); }, [&] { kept.draw(); },
      [&] { plain.draw(); });
  found.add_times(times);
  const glm::dvec3 eye = shadowed.camera.eye;
  if (options.versus != nullptr) {
    time_beside(*options.versus, shadows, options, shadowed.camera, found, pool);
  }
  if (options.check) {
    add_shadow_errors(shadow_errors(shadows.facets, lights, shadows.seen[0], shadows.masks[0],
                                    shadowed.view(), eye, true, pool),
                      found);
  }
  if (options.check_embree) check_embree(shadows, lights, shadowed.view(), eye, found, pool);
}

}  // namespace

void add_shadow_errors(const ShadowErrors& errors, Findings& found) {
  found.add({{"seen", errors.seen},
             {"in_shadow", errors.in_shadow},
             {"near_edge", errors.near_edge},
             {"wrong", errors.wrong}},
            "check");
}

Command add_shadows_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "shadows", "Measure shadows: time, and with --check errors");
  const auto options = std::make_shared<ShadowsOptions>();
  add_optional_argument(*parser, "SCENE", "A scene, as render takes it", options->scene);
  begin_group(*parser, "Picture");
  add_value(*parser, "--triangles", "N", "In place of a scene, 250 spheres of N triangles in all",
            [options](const std::string& text) {
              options->triangles =
                  parse_whole("--triangles", text, kLeastFieldTriangles, kMostFieldTriangles,
                              "a number from 1500 to 8000000");
            });
  add_scene_path(*parser, options->scene_path);
  add_size(*parser, options->size);
  add_frame(*parser, options->frame);
  add_map_option(*parser, options->map);
  add_value(*parser, "--shadows", "projected|volumes|map",
            "Of all lights, in place of what the scene says of each",
            [options](const std::string& text) {
              for (const MeasuredShadows& choice : kMeasuredShadows) {
                if (choice.name == text) {
                  options->shadows = choice.kind;
                  return;
                }
              }
              refuse_name("--shadows", text, names_in(kMeasuredShadows));
            });
  add_light_options(*parser, options->lights);
  add_flag(*parser, "--z-pass", "Count volumes' faces before what is seen, not behind",
           [options] { options->volume_count = VolumeCount::z_pass; });
  begin_group(*parser, "Run");
  add_value(*parser, "--runs", "N", "Time each N times, 1 to 100 (default: 5)",
            [options](const std::string& text) {
              options->runs = parse_whole("--runs", text, 1, 100, "a number from 1 to 100");
            });
  add_flag(*parser, "--check", "Ask a ray for every pixel, too", options->check);
  add_value(
      *parser, "--vs", "DRIVER",
      "Time this GL driver too, in turn, drawing the same stencil or maps: " + names_of(drivers()),
      [options](const std::string& text) { options->versus = &parse_driver("--vs", text); });
  add_flag(*parser, "--check-embree", "Ask Embree's ray for every pixel, too",
           options->check_embree);
  offer(*parser, "--vs", [] { return names_in(drivers()); });
  add_flag(*parser, "--map-table", "Of maps, time and wrong pixels by each of their settings",
           options->map_table);
  add_flag(*parser, "--soft-table", "Of lights with a size, error and time by points",
           options->soft_table);
  add_flag(*parser, "--terminator-table",
           "In place of a scene: curves of few facets, by each rule of --soften-terminators",
           options->terminator_table);
  add_json_option(*parser, options->json);
  add_pool_options(*parser, options->pool, "the shadows are the same");
  return {parser, [options] {
            Findings found{options->json};
            measure_shadows(*options, found);
            found.finish();
            return kDone;
          }};
}

}  // namespace softfocus
