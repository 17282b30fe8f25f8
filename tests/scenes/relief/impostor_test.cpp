#include "scenes/relief/impostors/impostor.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "raster/images/texel.h"
#include "scenes/make/shapes.h"
#include "scenes/relief/impostors/impostor_schedule.h"
#include "scenes/surfaces/surface_stages.h"
#include "tests/support/relief_scenes.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

constexpr int kSize = 96;

Scene torus_scene() { return test::orbited_torus(96, 1.0); }

CameraMatrices seen_at(const Scene& scene, double frame) {
  return camera_matrices(scene.camera, frame, kSize, kSize);
}

Image cleared(const Scene& scene) {
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  clear_image(picture, {0.0f, 0.0f, 0.0f, alpha_depth(static_cast<float>(scene.camera.far_m))},
              Profile{});
  return picture;
}

}  // namespace

TEST_CASE("an object of a metre, five metres away, is as wide as equation 5-1 says") {
  // 90 degrees: the picture is 10 m high there.
  CHECK(pixels_across(1000.0, 1.0, 5.0, 1.0) == doctest::Approx(100.0));
}

TEST_CASE("an impostor drawn for a view shows what is drawn, at its depths") {
  const Scene scene = torus_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const CameraMatrices camera = seen_at(scene, 0.0);
  const Image drawn = draw_scene(scene, camera, 0.0, kSize, kSize, Profile{}, pool);
  const float far = load_texel(cleared(scene), 0, 0).w;
  for (std::size_t i = 0; i < 2 * kResamplings.size(); ++i) {
    const NamedResampling& choice = kResamplings[i / 2];
    const bool in_perspective = i % 2 == 1;
    Impostor impostor;
    ImpostorSettings settings{.warp = {.resampling = choice.resampling}, .depth_bits = 16};
    if (in_perspective) settings.projection = ReliefProjection::perspective;
    CHECK(update_impostor(impostor, maker, settings, camera, scene.camera.up, kSize, pool) ==
          ImpostorStep::renew);
    Image shown = cleared(scene);
    draw_impostor(impostor, camera, shown, pool);
    int seen = 0, lost = 0, gained = 0, wrong_depths = 0, wrong_colours = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const glm::vec4 right = load_texel(drawn, x, y), own = load_texel(shown, x, y);
        if (right.w == far) {
          gained += own.w != far ? 1 : 0;
          continue;
        }
        ++seen;
        if (own.w == far) {
          ++lost;
          continue;
        }
        wrong_depths += std::fabs(own.w - right.w) > 0.03f * right.w ? 1 : 0;
        wrong_colours += std::fabs(own.y - right.y) > 0.08f ? 1 : 0;
      }
    }
    CAPTURE(choice.name);
    CHECK(seen > 1500);
    // The outline has some 300 pixels.
    CHECK(lost < (in_perspective ? 40 : 60));
    CHECK(gained < (in_perspective ? 40 : 60));
    CHECK(wrong_depths < seen / 50);
    CHECK(wrong_colours < seen / 50);
  }
}

TEST_CASE(
    "an eye beside part of its object gets an orthographic relief, though asked for another") {
  const Scene scene = torus_scene();
  ThreadPool pool(1);
  const ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ImpostorSettings settings;
  settings.projection = ReliefProjection::perspective;
  CameraMatrices camera = seen_at(scene, 0.0);
  CHECK(impostor_view(maker, camera, settings, scene.camera.up).projection ==
        ReliefProjection::perspective);
  camera.eye = {0.9, 0.1, 0.0};
  CHECK(impostor_view(maker, camera, settings, scene.camera.up).projection ==
        ReliefProjection::orthographic);
}

TEST_CASE("a picture with an impostor has the same bits on every vector unit") {
  const Scene scene = torus_scene();
  ThreadPool plain(1, Isa::scalar);
  const auto picture_by = [&](ThreadPool& pool) {
    ReliefMaker maker = prepare_relief(scene, 0.0, pool);
    Impostor impostor;
    update_impostor(impostor, maker, {}, seen_at(scene, 0.0), scene.camera.up, kSize, pool);
    update_impostor(impostor, maker, {}, seen_at(scene, 5.0), scene.camera.up, kSize, pool);
    Image picture = cleared(scene);
    draw_impostor(impostor, seen_at(scene, 5.0), picture, pool);
    return picture;
  };
  const Image right = picture_by(plain);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(3, isa);
    CHECK_MESSAGE(equal(picture_by(pool), right), isa_name(isa));
  }
}

TEST_CASE("pixels that are lit after the warp look as texels that are lit before it") {
  Scene scene = torus_scene();
  scene.materials[0].specular = glm::vec3{0.5f};
  scene.lights.push_back({LightKind::point, {1.0f, 1.5f, 1.0f}, {0.1f, 0.3f, 0.6f}});
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  std::vector<Light> lights = scene.lights;
  const ReliefLights laid = relief_lights(scene.ambient_light, lights);
  PixelLights by_pixel{&laid};
  Impostor of_texels, of_pixels;
  ImpostorSettings by_texels;
  by_texels.depth_bits = 16;
  by_texels.tolerance_texels = 1e4;
  by_texels.lights = &laid;
  ImpostorSettings by_pixels = by_texels;
  by_pixels.lights_pixels = true;
  // Drawn from the front, lit and seen from elsewhere; at the last view nothing but light moves.
  for (const double frame : {0.0, 15.0, 15.0}) {
    const CameraMatrices camera = seen_at(scene, frame);
    update_impostor(of_texels, maker, by_texels, camera, scene.camera.up, kSize, pool);
    const ImpostorStep step =
        update_impostor(of_pixels, maker, by_pixels, camera, scene.camera.up, kSize, pool);
    if (lights[0].position_or_direction.x < 0.0f) CHECK(step == ImpostorStep::sprite);
    if (step == ImpostorStep::sprite) {
      warp_impostor(of_texels, by_texels, camera.eye, pixel_tangent_of(camera, kSize), pool);
    }
    Image texels = cleared(scene), pixels = texels;
    draw_impostor(of_texels, camera, texels, pool);
    draw_impostor(of_pixels, camera, pixels, pool, &by_pixel);
    int seen = 0, apart = 0, bright = 0;
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const glm::vec4 right = load_texel(texels, x, y), own = load_texel(pixels, x, y);
        CHECK(right.w == own.w);
        if (right.w == load_texel(cleared(scene), 0, 0).w) continue;
        ++seen;
        bright += right.x > 0.3f ? 1 : 0;
        for (int i = 0; i < 3; ++i) {
          apart += std::fabs(std::fmin(own[i], 1.0f) - right[i]) > 0.08f ? 1 : 0;
        }
      }
    }
    CHECK(seen > 1500);
    CHECK(bright > 300);
    CHECK(apart < seen / 20);
    if (frame > 0.0) lights[0].position_or_direction = {-1.0f, 0.3f, 0.2f};
  }
  Image covered = make_image(Format::rgba16f, kSize, kSize);
  clear_image(covered, {1.0f, 0.0f, 0.0f, 0.5f}, Profile{});
  const Image before = covered;
  draw_impostor(of_pixels, seen_at(scene, 15.0), covered, pool, &by_pixel);
  CHECK(equal(covered, before));
}

TEST_CASE("what traces reliefs makes all of them, by whatever schedule") {
  const Scene scene = torus_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  ReliefMaker drawing = prepare_relief(scene, 0.0, pool);
  int traced = 0;
  // By another maker, whose reliefs are painted blue to be known.
  maker.trace = [&](const ReliefMaker&, const ReliefView& view, const ReliefForm& form,
                    ThreadPool& by) {
    ++traced;
    ReliefTexture relief = make_relief(drawing, view, form, by);
    for (std::uint32_t& colour : relief.colours) {
      if (colour != 0) colour = 0xFFFF0000u;
    }
    return relief;
  };
  for (const ScheduleKind kind : {ScheduleKind::in_frame, ScheduleKind::slices}) {
    traced = 0;
    ScheduledImpostor impostor = scheduled_impostor(
        {.kind = kind, .update_frames = kind == ScheduleKind::slices ? 3 : 0}, pool.isa());
    ImpostorSettings settings;
    settings.tolerance_texels = 2.0;
    int renewals = 0;
    for (int frame = 0; frame < 60; frame += 2) {
      const CameraMatrices camera = seen_at(scene, frame);
      renewals +=
          update_scheduled(impostor, maker, settings, camera, scene.camera.up, kSize, pool, [] {
            return true;
          }).renewals;
      Image picture = cleared(scene);
      draw_impostor(impostor.shown, camera, picture, pool);
      const glm::vec4 middle = load_texel(picture, kSize / 2, kSize / 2 + 18);
      CHECK(middle == glm::vec4{0.0f, 0.0f, 1.0f, middle.w});
    }
    finish_update(impostor);
    CHECK(renewals > 2);
    CHECK(traced >= renewals - 1);
    CHECK(traced <= renewals);
  }
}

TEST_CASE("a nearer surface in the picture stays before the impostor") {
  const Scene scene = torus_scene();
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const CameraMatrices camera = seen_at(scene, 0.0);
  Impostor impostor;
  update_impostor(impostor, maker, {}, camera, scene.camera.up, kSize, pool);
  Image picture = make_image(Format::rgba16f, kSize, kSize);
  clear_image(picture, {1.0f, 0.0f, 0.0f, 0.5f}, Profile{});
  const Image before = picture;
  draw_impostor(impostor, camera, picture, pool);
  CHECK(equal(picture, before));
}

TEST_CASE(
    "an impostor stays a sprite while the parallax is below a pixel, then is warped, then "
    "renewed") {
  const Scene scene = torus_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  Impostor impostor;
  const auto step_at = [&](double frame, double tolerance) {
    ImpostorSettings settings;
    settings.tolerance_texels = tolerance;
    return update_impostor(impostor, maker, settings, seen_at(scene, frame), scene.camera.up, kSize,
                           pool);
  };
  CHECK(step_at(0.0, 8.0) == ImpostorStep::renew);
  CHECK(step_at(0.0, 8.0) == ImpostorStep::sprite);
  CHECK(step_at(0.05, 8.0) == ImpostorStep::sprite);
  CHECK(step_at(10.0, 8.0) == ImpostorStep::warp);
  CHECK(step_at(11.0, 1.0) == ImpostorStep::renew);
  CHECK(step_at(170.0, 1e9) == ImpostorStep::renew);  // from behind
}

TEST_CASE("from where a relief was warped nothing is displaced") {
  const Scene scene = torus_scene();
  ThreadPool pool(1);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const glm::dvec3 eye = seen_at(scene, 0.0).eye;
  const ReliefTexture relief = make_relief(maker, {eye, scene.camera.up}, {32, 32, 8, false}, pool);
  CHECK(parallax_tangent(relief, eye, eye) < 1e-7);
  CHECK(parallax_tangent(relief, eye, seen_at(scene, 1.0).eye) >
        parallax_tangent(relief, eye, seen_at(scene, 0.5).eye));
}

TEST_CASE("a stale relief is kept within the budget, and serves again where it did") {
  const Scene scene = torus_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  const auto steps_with = [&](std::size_t bytes) {
    Impostor impostor;
    ImpostorSettings settings;
    settings.cache_bytes = bytes;
    std::vector<ImpostorStep> steps;
    for (const double frame : {0.0, 120.0, 240.0, 0.0}) {
      steps.push_back(update_impostor(impostor, maker, settings, seen_at(scene, frame),
                                      scene.camera.up, kSize, pool));
      std::size_t kept = 0;
      for (const DrawnRelief& relief : impostor.cache) kept += bytes_of(relief);
      CHECK(kept <= bytes);
    }
    return steps;
  };
  using enum ImpostorStep;
  CHECK(steps_with(1 << 20) == std::vector{renew, renew, renew, recall});
  CHECK(steps_with(0) == std::vector{renew, renew, renew, renew});
}

TEST_CASE("if the cache is full, the relief whose eye is farthest away goes") {
  const Scene scene = torus_scene();
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  Impostor impostor;
  ImpostorSettings settings;
  const auto step_at = [&](double frame) {
    return update_impostor(impostor, maker, settings, seen_at(scene, frame), scene.camera.up, kSize,
                           pool);
  };
  CHECK(step_at(0.0) == ImpostorStep::renew);
  settings.cache_bytes = bytes_of(*impostor.drawn) * 3 / 2;  // one
  CHECK(step_at(170.0) == ImpostorStep::renew);
  CHECK(step_at(60.0) == ImpostorStep::renew);  // 60 degrees from the first, 110 from the second
  CHECK(step_at(0.0) == ImpostorStep::recall);
}

TEST_CASE("an eye that comes nearer sees finer levels of one relief, and no renewal") {
  Scene scene = torus_scene();
  scene.camera.orbit_degrees_per_frame = 0.0;
  const glm::dvec3 near = scene.camera.position;
  ThreadPool pool(2);
  ReliefMaker maker = prepare_relief(scene, 0.0, pool);
  Impostor with, without;
  ImpostorSettings settings;
  settings.tolerance_texels = 1e3;
  ImpostorSettings levels = settings;
  levels.levels = 3;
  levels.texels_per_pixel = 4.0;
  int renewals = 0;
  std::size_t before = 2;
  for (const double farther : {4.0, 3.0, 2.2, 1.6, 1.3, 1.0}) {
    scene.camera.position = near * farther;
    const CameraMatrices camera = seen_at(scene, 0.0);
    const auto step_of = [&](Impostor& impostor, const ImpostorSettings& by) {
      return update_impostor(impostor, maker, by, camera, scene.camera.up, kSize, pool);
    };
    renewals += step_of(without, settings) == ImpostorStep::renew ? 1 : 0;
    CHECK((step_of(with, levels) == ImpostorStep::renew) == (farther == 4.0));
    CHECK(with.warped_level <= before);
    before = with.warped_level;
    // Not a texel too many: half as many would be too few.
    CHECK(with.warped.place.width < 2.2 * without.warped.place.width);
    CHECK(with.warped.place.width > 0.6 * without.warped.place.width);
  }
  CHECK(before == 0);
  CHECK(renewals == 3);
}

TEST_CASE("impostor: no relief is recalled whose critical point alone stays where it was") {
  constexpr int kWidth = 64, kHeight = 4;
  ReliefTexture relief;
  relief.width = kWidth;
  relief.height = kHeight;
  relief.camera = {{0, 0, 0}, {0.1, 0, 0}, {0, -0.1, 0}, {0, 0, -1}, 3.0};
  relief.depths.assign(std::size_t{kWidth} * kHeight, 0);
  relief.colours.assign(relief.depths.size(), 0xFFFFFFFFu);
  // Two columns lie deep; the first is the critical point.
  for (std::size_t v = 0; v < kHeight; ++v) {
    for (const std::size_t u : {std::size_t{1}, std::size_t{62}}) {
      relief.depths[v * kWidth + u] = static_cast<std::uint16_t>(last_depth(8));
    }
  }
  ThreadPool pool{1};
  ImpostorSettings settings;
  settings.tolerance_texels = 2.0;
  Impostor impostor;
  const std::optional<DrawnRelief> drawn = known_relief(relief, settings, {3.1, -0.1, 100}, pool);
  REQUIRE(drawn);
  impostor.cache.push_back(*drawn);
  const glm::dvec3 before{3.1, -0.1, 100}, beside{0.1, 0, 1};
  CHECK(can_be_recalled(*drawn, settings, before, 1e-3));
  REQUIRE(is_fresh(*drawn, settings, beside, 0.03));
  CHECK(largest_error(relief, beside) > 40.0);
  CHECK(!can_be_recalled(*drawn, settings, beside, 0.03));
  CHECK(!recalled(impostor, settings, beside, 0.03));
  CHECK(recalled(impostor, settings, before, 1e-3));
}
