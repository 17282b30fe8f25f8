#include "tools/bench/work.h"

#include "scenes/draw/frame_matrices.h"
#include "scenes/load/load_scene.h"
#include "scenes/make/shapes.h"
#include "tools/bench/picture.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"

namespace softfocus {
namespace {

struct FilmedFrom {
  SceneLens lens;
  double fov_y_degrees;
};

// For --image: circles grow with the filter's size, so that every size blurs the same share of
// the picture.
FilmedFrom picture_lens(std::optional<float> max_coc_px, int height_px) {
  FilmedFrom made{{.lens = {.focus_m = kBenchPictureFocusM}}, Camera{}.fov_y_degrees};
  const PixelCoc plain = pixel_coc(made.lens.lens, made.fov_y_degrees, height_px, 1.0);
  made.lens.coc_scale = kBenchPictureHorizon *
                        static_cast<double>(used_max_coc_px(max_coc_px, made.lens, height_px)) /
                        static_cast<double>(plain.radius_at_infinity_px);
  return made;
}

void set_lens(BenchWork& work, const BenchOptions& options, const FilmedFrom& from) {
  DofSettings& settings = work.settings;
  settings.max_coc_px = used_max_coc_px(options.max_coc_px, from.lens, options.size.height);
  if (work.method.name() == "pinhole") return;  // minds no lens
  const ThinLens lens = overruled(from.lens.lens, options.lens);
  check_lens(lens, options.lens, work.name);
  const double coc_scale = options.lens.coc_scale.value_or(from.lens.coc_scale);
  settings.coc = checked_pixel_coc(lens, from.fov_y_degrees, options.size.height, coc_scale);
  work.focus_m = lens.focus_m;
  work.aperture_radius_m = aperture_radius_m(lens, coc_scale);
  check_arithmetic(options.arithmetic, settings);
}

Scene chosen_scene(const BenchOptions& options) {
  if (options.triangles) {
    return sphere_field(*options.triangles,
                        static_cast<double>(options.size.width) / options.size.height);
  }
  return load_scene(options.scene, scene_search_path(options.scene_path));
}

}  // namespace

BenchWork make_work(const BenchOptions& options) {
  const auto [width, height] = options.size;
  BenchWork work;
  work.frame = options.frame;
  work.size = options.size;
  work.method = options.method;
  work.largest_radius_px = options.max_coc_px;
  work.sampling = options.sampling;
  work.goal = options.goal;
  work.verify = options.verify;
  work.copies = options.copies;
  work.profile = options.profile;
  work.profile_name = options.profile_name;
  if (options.image) {
    work.name = "picture";
    set_lens(work, options, picture_lens(options.max_coc_px, height));
    work.picture = bench_picture(width, height);
    return work;
  }
  const Scene& scene = work.scene.emplace(chosen_scene(options));
  print_scene_warnings(scene.warnings, false);
  work.name = scene.name;
  work.sampling = with_shutter_of(scene, options.sampling);
  SceneLens lens = scene.lens;
  lens.lens = lens_at(scene.lens, work.frame);
  set_lens(work, options, {lens, scene.camera.fov_y_degrees});
  work.view = camera_matrices(scene.camera, work.frame, width, height);
  return work;
}

}  // namespace softfocus
