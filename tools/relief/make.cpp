// softfocus relief make: by the pipeline, by rays, or of heights.

#include <cstdio>
#include <string>
#include <utility>

#include "raster/numbers/vector_math.h"
#include "scenes/relief/light_relief.h"
#include "scenes/traced_relief/traced_relief.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/relief/relief_file.h"
#include "tools/relief/relief_options.h"

namespace softfocus {
namespace {

void print_differences(const ReliefDifferences& found) {
  const auto number = [](std::int64_t count) { return static_cast<long long>(count); };
  std::fprintf(stderr,
               "traced beside drawn, of %lld texels: %lld in one alone, %lld of them off outlines; "
               "depths 1 code apart %lld, more %lld, %lld of them off steps; colours apart %lld, "
               "%lld of them off steps\n",
               number(found.shown), number(found.by_one), number(found.by_one_inside),
               number(found.code), number(found.codes), number(found.codes_off_step),
               number(found.colour), number(found.colour_off_step));
}

void check_materials(const Scene& scene) {
  if (scene.materials.size() <= kMostReliefMaterials) return;
  throw UsageError("'" + scene.name + "' has " + std::to_string(scene.materials.size()) +
                   " materials; a relief that is unlit has at most " +
                   std::to_string(kMostReliefMaterials));
}

}  // namespace

void check_can_trace() {
  if (traced_relief_missing().empty()) return;
  throw UsageError("--traced: " + std::string{traced_relief_missing()});
}

int make_relief_file(const ReliefOptions& options) {
  if (options.traced) check_can_trace();
  if (options.height_field) {
    const ReliefTexture relief = relief_of_height_file(options);
    check_relief_size(relief, options.input);
    write_relief_output(options.output, encode_relief(relief));
    return kDone;
  }
  const Scene scene = relief_scene(options);
  ThreadPool pool{options.pool.threads, options.pool.isa};
  ReliefMaker maker = prepare_relief(scene, options.frame, pool);
  const ReliefView view{maker.middle + turned_arm(maker, scene, options),
                        normalize(scene.camera.up), options.projection};
  if (view.projection == ReliefProjection::perspective && !can_project(maker, view)) {
    throw UsageError(
        "--projection perspective: '" + scene.name +
        "' reaches beside the eye, behind it or too near to it; orthographic would be right");
  }
  if (options.unlit) check_materials(scene);
  const ReliefForm form{options.texels.width, options.texels.height, options.depth_bits,
                        options.normals || options.unlit, options.unlit};
  ReliefTexture relief = make_relief(maker, view, form, pool);
  if (options.traced) {
    ReliefTexture traced = trace_relief(maker, view, form, pool);
    print_differences(relief_differences(relief, traced));
    relief = std::move(traced);
  }
  if (!relief_extent(relief)) {
    throw UsageError("'" + scene.name + "': nothing opaque is seen from there");
  }
  check_relief_size(relief, scene.name);
  if (options.unlit) {
    light_relief(relief, relief_lights(scene.ambient_light, scene.lights), view.eye, pool);
  }
  write_relief_output(options.output, encode_relief(relief));
  return kDone;
}

}  // namespace softfocus
