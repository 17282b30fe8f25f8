#include "scenes/auto/auto_picture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "dof/auto/candidates.h"
#include "dof/measure/difference.h"
#include "dof/measure/flip.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/object_numbers.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/load/load_scene.h"
#include "tests/support/run_program.h"

using namespace softfocus;

namespace {

constexpr int kSize = 128;

// A scene as auto gets it. Stays where it is: the views refer to it.
struct Subject {
  Subject(const std::string& name, ThreadPool& pool, int size = kSize)
      : scene(load_scene(name, scene_search_path({}))),
        camera(camera_matrices(scene.camera, 0.0, size, size)),
        pinhole(draw_scene(scene, camera, 0.0, size, size, Profile{}, pool)),
        views{.scene = scene,
              .camera = camera,
              .pinhole = pinhole,
              .focus_m = scene.lens.lens.focus_m,
              .aperture_radius_m = aperture_radius_m(scene.lens.lens, scene.lens.coc_scale),
              .sampling = {},
              .profile = Profile{},
              .progress = {}} {
    settings.coc =
        pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, size, scene.lens.coc_scale);
  }

  AutoInput input(double max_error, Verify verify) const {
    return {.views = views,
            .settings = settings,
            .goal = {.max_error = max_error},
            .limits = {.max_radius_px = {}, .triangles = triangle_count(scene)},
            .verify = verify};
  }

  Image by_views(int samples, ThreadPool& pool) const {
    LensViewInput of = views;
    of.sampling.samples = samples;
    return accumulation(of, pool).picture;
  }

  Image by_name(const AutoMethod& choice, ThreadPool& pool) const {
    if (const LensViewMethod* method = find_lens_view_method(choice.method)) {
      LensViewInput of = views;
      if (choice.samples > 0) of.sampling.samples = choice.samples;
      return method->render(of, pool).picture;
    }
    DofSettings of = settings;
    of.max_coc_px = choice.radius_px;
    const std::vector<std::uint16_t> objects =
        draw_object_numbers(scene, camera, 0.0, pinhole.width, pinhole.height, Profile{}, pool);
    return apply(*find_method(choice.method), {pinhole, of, Profile{}, objects}, pool);
  }

  Scene scene;
  CameraMatrices camera;
  Image pinhole;
  LensViewInput views;
  DofSettings settings;
};

// Lamps of a pixel or two of 512 far behind the focus, on a dark wall.
void write_lamps(const std::filesystem::path& file, int count, double light, double size) {
  std::ofstream to(file);
  to << "background = [0.004, 0.006, 0.014]\n"
        "[camera]\nposition = [0, 0, 0]\ntarget = [0, 0, -1]\nfov_degrees = 40\n"
        "[lens]\nfocal_length_mm = 50\nf_number = 3.5\nfocus_m = 1\nmax_coc_px = 64\n"
        "[material.wall]\nlit = false\ndiffuse = [0.02, 0.02, 0.02]\n"
        "[material.lamp]\nlit = false\ndiffuse = ["
     << light << ", " << light << ", " << light
     << "]\n[[object]]\nshape = \"cube\"\nsize = 1\nmaterial = \"wall\"\n"
        "position = [0, 0, -11]\nscale = [30, 30, 0.1]\n";
  for (int i = 0; i < count; ++i) {
    // A lattice of rank 1, even but not regular.
    const double x = (i + 0.5) / count, y = std::fmod(0.618034 * i, 1.0);
    to << "[[object]]\nshape = \"cube\"\nsize = 1\nmaterial = \"lamp\"\nposition = ["
       << 6.8 * x - 3.4 << ", " << 6.8 * y - 3.4 << ", -10]\nscale = [" << size << ", " << size
       << ", 0.01]\n";
  }
}

double error_of(const Image& picture, const Image& truth, ThreadPool& pool) {
  return mean(flip_map(truth, picture, clamped_tone(), pool));
}

bool are_equal(const Image& a, const Image& b) { return compare_images(a, b).differing == 0; }

}  // namespace

TEST_CASE("auto picture: what is checked keeps to the error that was asked" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  for (const char* name : {"night-lights", "near-fence"}) {
    const Subject subject{name, pool};
    const Image truth = subject.by_views(512, pool);
    for (const double limit : {0.03, 0.012}) {
      const AutoPicture found = auto_picture(subject.input(limit, Verify::always), pool);
      CAPTURE(name);
      CAPTURE(limit);
      CAPTURE(setting_text(found.choice));
      REQUIRE(found.measured_error);
      CHECK(found.choice.meets_goal);
      CHECK(*found.measured_error <= limit);
      CHECK(error_of(found.picture, truth, pool) <= 1.1 * limit);
    }
  }
}

TEST_CASE("auto picture: lamps of a pixel or two are not missed, at the size of the fit" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const TemporaryDirectory directory;
  struct Lamps {
    double light, size;
  };
  for (const Lamps lamps : {Lamps{1000.0, 0.015}, Lamps{100.0, 0.03}}) {
    const std::filesystem::path file = directory.file("lamps.toml");
    write_lamps(file, 130, lamps.light, lamps.size);
    const Subject subject{file.string(), pool, 512};
    const Image truth = subject.by_views(512, pool);
    for (const double limit : {0.05, 0.02}) {
      const AutoPicture found = auto_picture(subject.input(limit, Verify::in_doubt), pool);
      CAPTURE(lamps.light);
      CAPTURE(limit);
      CAPTURE(found.choice.reason);
      CHECK(found.measured_error);
      CHECK(found.choice.meets_goal);
      CHECK(error_of(found.picture, truth, pool) <= 1.1 * limit);
    }
  }
}

TEST_CASE("auto picture: the bits are those of the method by its own name, checked or not") {
  ThreadPool pool{2};
  const Subject subject{"lattice", pool};
  for (const Verify verify : {Verify::never, Verify::always}) {
    for (const double limit : {0.3, 0.02}) {
      const AutoPicture found = auto_picture(subject.input(limit, verify), pool);
      CAPTURE(setting_text(found.choice));
      if (found.choice.method == "accumulation") {
        CHECK(are_equal(found.picture, subject.by_views(found.choice.samples, pool)));
        continue;
      }
      CHECK(are_equal(found.picture, subject.by_name(found.choice, pool)));
    }
  }
}

TEST_CASE("auto picture: methods that need more than a picture get it") {
  ThreadPool pool{2};
  const Subject subject{"lattice", pool, 64};
  for (const char* method : {"object-identification", "surface-splatting"}) {
    const AutoMethod choice{.method = method, .radius_px = 8.0f, .traits = {}};
    CAPTURE(method);
    CHECK(are_equal(picture_of(choice, subject.views, subject.settings, pool),
                    subject.by_name(choice, pool)));
    CHECK_FALSE(are_equal(picture_of(choice, subject.views, subject.settings, pool),
                          picture_of({.method = "disc-layers", .radius_px = 8.0f, .traits = {}},
                                     subject.views, subject.settings, pool)));
  }
}

TEST_CASE("auto picture: never checked, it is what is predicted; by time it never is checked") {
  ThreadPool pool{2};
  const Subject subject{"figures", pool};
  const SceneTraits traits = scene_traits(subject.pinhole, subject.settings.coc, pool);
  AutoInput input = subject.input(0.02, Verify::never);
  AutoPicture found = auto_picture(input, pool);
  CHECK(setting_text(found.choice) == setting_text(auto_method(traits, input.goal, input.limits)));
  CHECK_FALSE(found.measured_error);
  input.verify = Verify::always;
  input.goal.max_time_ms = 3.0;
  found = auto_picture(input, pool);
  CHECK(setting_text(found.choice) == setting_text(auto_method(traits, input.goal, input.limits)));
  CHECK_FALSE(found.measured_error);
}

TEST_CASE("auto picture: an error that nothing reaches is said to be missed" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const Subject subject{"cube-room", pool};  // few triangles: thousands of views are drawn
  const AutoPicture found = auto_picture(subject.input(1e-6, Verify::in_doubt), pool);
  CHECK_FALSE(found.choice.meets_goal);
  REQUIRE(found.measured_error);
  CHECK(*found.measured_error > 1e-6);
  CHECK(found.choice.samples == kSampleCounts.back());
  // The doubled number of samples is the table's last line.
  CHECK(found.choice.candidate == candidates().size() - 1);
}

TEST_CASE("auto picture: a check is due unless the prediction is far within the limit") {
  AutoMethod choice{.method = "two-pass", .predicted_error = 0.0115, .traits = {.height = 512}};
  CHECK(is_in_doubt(choice, {.max_error = 0.02}));
  CHECK_FALSE(is_in_doubt(choice, {.max_error = 0.05}));
  choice.traits.height = 511;  // smaller than any picture of the fit
  CHECK(is_in_doubt(choice, {.max_error = 0.05}));
  choice.traits.height = 512;
  choice.traits.brightest = 1.5f;  // a highlight out of focus
  CHECK(is_in_doubt(choice, {.max_error = 0.05}));
  choice.traits.brightest = 1.0f;
  CHECK_FALSE(is_in_doubt(choice, {.max_error = 0.05}));
  choice.meets_goal = false;
  CHECK(is_in_doubt(choice, {.max_error = 0.05}));
}

TEST_CASE("auto picture: the same bits and the same words on any threads and vector unit" *
          doctest::test_suite("threads long")) {
  ThreadPool one{1, Isa::scalar};
  const Subject subject{"random:48", one};
  const AutoPicture expected = auto_picture(subject.input(0.02, Verify::always), one);
  for (const Isa isa : std::set{available_isas()[1], widest_isa()}) {
    ThreadPool pool{3, isa};
    const Subject again{"random:48", pool};
    const AutoPicture found = auto_picture(again.input(0.02, Verify::always), pool);
    CHECK(are_equal(found.picture, expected.picture));
    CHECK(found.choice.reason == expected.choice.reason);
    CHECK(found.measured_error == expected.measured_error);
  }
}
