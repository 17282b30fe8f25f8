// render --layers.

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "dof/dof.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

constexpr double kLargeCircles = 20.0;  // --coc-scale

std::vector<Image> fence_layers(std::size_t layers) {
  const Scene scene = load_scene("near-fence", scene_search_path({}));
  ThreadPool pool(2);
  return draw_layers(scene, camera_matrices(scene.camera, 0, kWidth, kHeight), 0, kWidth, kHeight,
                     layers, {}, pool);
}

}  // namespace

TEST_CASE("render --layers: with --show pinhole each layer is a file") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.npy");
  REQUIRE(run_program(render("near-fence", file, {"--show", "pinhole", "--layers", "3"})).status ==
          0);
  const std::vector<Image> layers = fence_layers(3);
  CHECK(equal(read_image_file(file).image, layers[0]));
  CHECK(equal(read_image_file(directory.file("a.layer2.npy")).image, layers[1]));
  CHECK(equal(read_image_file(directory.file("a.layer3.npy")).image, layers[2]));
}

TEST_CASE("render --layers: layered works from the scene's layers, two by default") {
  const Scene scene = load_scene("near-fence", scene_search_path({}));
  const DofSettings settings{
      .coc = pixel_coc(scene.lens.lens, scene.camera.fov_y_degrees, kHeight, kLargeCircles),
      .max_coc_px = 16.0f};
  ThreadPool pool(2);
  const std::vector<Image> layers = fence_layers(3);
  const auto layered_from = [&](std::vector<ConstImageView> behind) {
    return apply(*find_method("layered"),
                 {.scene = layers[0], .settings = settings, .profile = {}, .behind = behind}, pool);
  };
  const auto rendered_with = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--method", "layered", "--max-coc", "16", "--coc-scale", "20"});
    return rendered_picture("near-fence", words).image;
  };
  CHECK(equal(rendered_with({}), layered_from({layers[1]})));
  CHECK(equal(rendered_with({"--layers", "2"}), layered_from({layers[1]})));
  CHECK(equal(rendered_with({"--layers", "3"}), layered_from({layers[1], layers[2]})));
  CHECK(equal(rendered_with({"--layers", "1"}), layered_from({})));
  CHECK_FALSE(equal(layered_from({}), layered_from({layers[1]})));
}

TEST_CASE("render --layers: what cannot be is refused") {
  const TemporaryDirectory directory;
  const auto refused = [&](const std::vector<std::string>& words,
                           const std::vector<std::string>& says) {
    const ProgramRun run = run_program(render("figures", directory.file("a.npy"), words));
    CHECK(run.status == 2);
    for (const std::string& text : says) {
      INFO(run.err);
      CHECK(contains(run.err, text));
    }
  };
  refused({"--layers", "0", "--method", "layered"}, {"--layers", "1 to 4"});
  refused({"--layers", "5", "--method", "layered"}, {"--layers", "1 to 4"});
  refused({"--layers", "2", "--method", "two-pass"}, {"two-pass", "layered", "--show pinhole"});
  refused({"--layers", "2", "--show", "pinhole", "--report", directory.file("a.layer2.npy")},
          {"--report", "layer"});
  const ProgramRun run = run_program(
      {"render", "figures", "--size", "8x8", "--layers", "2", "--show", "pinhole", "-o", "-"});
  CHECK(run.status == 2);
  CHECK(contains(run.err, "--layers and -o -"));
}
