#include "tools/bench/work.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "raster/numbers/exact_math.h"
#include "raster/numbers/random_bits.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/load/load_scene.h"
#include "scenes/make/shapes.h"
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
  settings.frame = {.aperture_radius_m = work.aperture_radius_m, .number = work.frame};
  if (work.scene) {
    settings.frame.near_m = work.scene->camera.near_m;
    settings.frame.far_m = work.scene->camera.far_m;
  }
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
  BenchWork work;
  work.size = options.size;
  work.samples = options.samples;
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
    work.frame = options.frame;
    set_lens(work, options, picture_lens(options.max_coc_px, options.size.height));
    work.picture = bench_picture(options.size.width, options.size.height);
    return work;
  }
  const Scene& scene = work.scene.emplace(chosen_scene(options));
  print_scene_warnings(scene.warnings, false);
  work.name = scene.name;
  work.sampling = with_shutter_of(scene, options.sampling);
  set_frame(work, options, options.frame);
  return work;
}

void set_frame(BenchWork& work, const BenchOptions& options, double frame) {
  const Scene& scene = *work.scene;
  work.frame = frame;
  SceneLens lens = scene.lens;
  lens.lens = lens_at(scene.lens, frame);
  set_lens(work, options, {lens, scene.camera.fov_y_degrees});
  work.view = camera_matrices(scene.camera, frame, work.size.width, work.size.height);
}

namespace {

constexpr int kDiscs = 48;
constexpr double kMostBlur = 1.2;  // as a part of the filter's largest radius

// The depth whose signed circle is `blur` times the filter's largest:
// blur = horizon (z - focus) / z, solved for z.
float depth_of_blur(double blur) {
  return static_cast<float>(kBenchPictureFocusM / (1.0 - blur / kBenchPictureHorizon));
}

void store(Image& image, int x, int y, float depth_m, const std::vector<double>& wave_x,
           const std::vector<double>& wave_y) {
  const auto place = static_cast<std::uint64_t>(y) << 32 | static_cast<std::uint64_t>(x);
  const std::uint64_t noise = mix_bits(place);
  glm::vec4 texel{0.0f, 0.0f, 0.0f, depth_m};
  for (int i = 0; i < 3; ++i) {
    const double smooth = 0.4 + 0.2 * wave_x[static_cast<std::size_t>(x + i * image.width)] +
                          0.2 * wave_y[static_cast<std::size_t>(y + i * image.height)];
    const double rough = 0.4 * unit_interval(mix_bits(noise + static_cast<std::uint64_t>(i)));
    texel[i] = static_cast<float>(smooth + rough);
  }
  store_texel<Format::rgba16f>(image, x, y, texel, {});
}

// Three sines along a side, one after the other, of 2, 3 and 5 periods.
std::vector<double> waves(int length) {
  std::vector<double> values;
  for (const int periods : {2, 3, 5}) {
    for (int i = 0; i < length; ++i) {
      values.push_back(exact_math::sin_degrees(360.0 * periods * (i + 0.5) / length));
    }
  }
  return values;
}

struct Disc {
  double x;
  double y;
  double radius;
  float depth_m;
};

// Sizes and places in pixels, by the shorter side.
Disc random_disc(const Image& image, RandomSequence& random) {
  Disc disc{};
  disc.x = next_between(random, 0.0, image.width);
  disc.y = next_between(random, 0.0, image.height);
  disc.radius = next_between(random, 0.01, 0.12) * std::min(image.width, image.height);
  disc.depth_m = depth_of_blur(next_between(random, -kMostBlur, kMostBlur));
  return disc;
}

int first_pixel(double edge) { return std::max(static_cast<int>(std::floor(edge)), 0); }

}  // namespace

Image bench_picture(int width, int height) {
  Image image = make_image(Format::rgba16f, width, height);
  const std::vector<double> wave_x = waves(width), wave_y = waves(height);
  for (int y = 0; y < height; ++y) {
    const double down = (y + 0.5) / height;
    const float depth_m = depth_of_blur(kMostBlur - 1.5 * kMostBlur * down);
    for (int x = 0; x < width; ++x) store(image, x, y, depth_m, wave_x, wave_y);
  }
  RandomSequence random{48};
  for (int i = 0; i < kDiscs; ++i) {
    const Disc disc = random_disc(image, random);
    for (int y = first_pixel(disc.y - disc.radius);
         y < std::min(height, static_cast<int>(disc.y + disc.radius) + 1); ++y) {
      for (int x = first_pixel(disc.x - disc.radius);
           x < std::min(width, static_cast<int>(disc.x + disc.radius) + 1); ++x) {
        const double dx = x + 0.5 - disc.x, dy = y + 0.5 - disc.y;
        if (dx * dx + dy * dy < disc.radius * disc.radius) {
          store(image, x, y, disc.depth_m, wave_x, wave_y);
        }
      }
    }
  }
  return image;
}

}  // namespace softfocus
