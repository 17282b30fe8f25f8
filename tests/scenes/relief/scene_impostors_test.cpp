#include "scenes/relief/impostors/scene_impostors.h"

#include <doctest/doctest.h>

#include <cmath>
#include <tuple>

#include "dof/measure/measures.h"
#include "raster/images/texel.h"
#include "scenes/draw/shadowed_layers.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_view_method.h"
#include "scenes/make/shapes.h"
#include "tests/support/relief_scenes.h"

using namespace softfocus;

namespace {

constexpr int kSize = 128;

/// Three fine tori among a floor, a wall and a post, past which the camera goes.
Scene hall(ImpostorUse use) {
  Scene scene = test::lit_mesh(make_torus(0.5, 0.25, 160, 80));
  scene.background = {0.2f, 0.3f, 0.4f};
  scene.camera.position = {0.0, 1.0, 7.0};
  scene.camera.target = {0.0, 0.6, 0.0};
  scene.camera.position_keys = {
      {{{0.0, 0.0}, {100.0, 2.0}}, {{0.0, 1.0}, {100.0, 1.0}}, {{0.0, 7.0}, {100.0, 4.0}}}};
  scene.meshes.push_back(make_plane(12.0, 12.0, 4, 4));
  scene.meshes.push_back(make_cube(0.4, 2));
  for (const glm::vec3 colour : {glm::vec3{0.7f, 0.3f, 0.2f}, glm::vec3{0.3f, 0.5f, 0.3f}}) {
    scene.materials.emplace_back();
    scene.materials.back().diffuse = colour;
  }
  scene.objects.clear();
  for (const double x : {-1.4, 0.1, 1.3}) {
    Object torus;
    torus.position = {x, 0.75, -x};
    torus.rotation_degrees = {60.0, 40.0 * x, 0.0};
    torus.material = 1;
    torus.impostor = use;
    scene.objects.push_back(torus);
  }
  Object floor;
  floor.mesh = 1;
  scene.objects.push_back(floor);
  Object post;
  post.mesh = 2;
  post.material = 2;
  post.position = {0.4, 0.8, 1.6};
  post.scale = {0.5, 4.0, 0.5};
  scene.objects.push_back(post);
  return scene;
}

struct Hall {
  explicit Hall(ImpostorUse use, Isa isa = widest_isa(), int threads = 2)
      : scene(hall(use)), pool(threads, isa) {}

  CameraMatrices camera_at(double frame) const {
    return camera_matrices(scene.camera, frame, kSize, kSize);
  }
  void prepare() {
    impostors = make_scene_impostors(scene, pool);
    prepared = prepare_scene(scene, Profile{}, pool);
    prepared->stand_ins = stand_ins_of(impostors);
  }
  Image drawn(double frame) {
    if (!prepared) prepare();
    Image picture = make_image(Format::rgba16f, kSize, kSize);
    draw_scene(*prepared, camera_at(frame), frame, picture, pool);
    return picture;
  }
  /// The same by its triangles alone.
  Image redrawn(double frame) {
    return draw_scene(scene, camera_at(frame), frame, kSize, kSize, Profile{}, pool);
  }
  double flip_at(double frame) {
    return measure_pictures(redrawn(frame), drawn(frame), nullptr, {}, pool).whole.flip;
  }

  Scene scene;
  ThreadPool pool;
  std::shared_ptr<SceneImpostors> impostors;
  std::optional<PreparedScene> prepared;
};

}  // namespace

TEST_CASE("impostors among geometry look like geometry, and lie at its depths") {
  Hall with{ImpostorUse::wherever_possible};
  const Image drawn = with.drawn(10.0), redrawn = with.redrawn(10.0);
  CHECK(with.impostors->counts.shown == 3);
  CHECK(with.impostors->counts.renewed == 3);
  // What auto reckons with: the floor and the post.
  CHECK(with.prepared->triangles == 4 * 4 * 2 + 6 * 2 * 2 * 2);
  CHECK(with.flip_at(10.0) < 0.02);
  int far_off = 0, differ = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float own = load_texel(drawn, x, y).w, right = load_texel(redrawn, x, y).w;
      differ += own != right ? 1 : 0;
      far_off += std::fabs(own - right) > 0.05f * right ? 1 : 0;
    }
  }
  CHECK(differ > 100);  // they are impostors
  CHECK(far_off < kSize * kSize / 100);
}

TEST_CASE("a frame's impostors do not depend on the frames before, nor on threads or lanes") {
  Hall with{ImpostorUse::wherever_possible};
  std::vector<std::uint64_t> in_order;
  for (int frame = 0; frame <= 60; frame += 5) in_order.push_back(hash_image(with.drawn(frame)));
  for (const int frame : {60, 5, 35}) {
    Hall alone{ImpostorUse::wherever_possible, widest_isa(), 1};
    CHECK(hash_image(alone.drawn(frame)) == in_order[static_cast<std::size_t>(frame / 5)]);
  }
  Hall scalar{ImpostorUse::wherever_possible, Isa::scalar};
  CHECK(hash_image(scalar.drawn(35)) == in_order[7]);
}

TEST_CASE("one scene's impostors serve pictures of any size and view, each with its own bits") {
  Hall with{ImpostorUse::wherever_possible};
  with.prepare();
  const auto drawn = [](Hall& hall, int width, int height, double fov_degrees) {
    if (!hall.prepared) hall.prepare();
    Camera camera = hall.scene.camera;
    camera.fov_y_degrees = fov_degrees;
    Image picture = make_image(Format::rgba16f, width, height);
    draw_scene(*hall.prepared, camera_matrices(camera, 0.0, width, height), 0.0, picture,
               hall.pool);
    return hash_image(picture);
  };
  // With few cells as many in each.
  for (const double tolerance_px : {1.0, 100.0}) {
    with.scene.impostors.tolerance_px = tolerance_px;
    drawn(with, 128, 128, 40.0);
    for (const auto& [width, height, fov] :
         {std::tuple{64, 96, 40.0}, std::tuple{200, 100, 40.0}, std::tuple{128, 128, 25.0}}) {
      Hall alone{ImpostorUse::wherever_possible};
      alone.scene.impostors.tolerance_px = tolerance_px;
      CHECK(drawn(with, width, height, fov) == drawn(alone, width, height, fov));
    }
  }
}

TEST_CASE("an impostor is renewed when the eye leaves its cell, and recalled when it comes back") {
  Hall with{ImpostorUse::wherever_possible};
  with.drawn(0.0);
  with.drawn(0.0);
  CHECK(with.impostors->counts.renewed == 0);
  with.drawn(50.0);
  CHECK(with.impostors->counts.renewed == 3);
  with.drawn(0.0);
  CHECK(with.impostors->counts.renewed == 0);
}

TEST_CASE("what the eye is near to, what has no memory, and what is cheap is drawn as geometry") {
  Hall inside{ImpostorUse::wherever_possible};
  inside.scene.camera.position_keys = {};
  inside.scene.camera.position = {0.1, 0.75, 0.3};
  inside.scene.camera.target = {1.3, 0.75, -1.3};
  inside.drawn(0.0);
  CHECK(inside.impostors->counts.as_geometry >= 1);

  Hall without{ImpostorUse::wherever_possible};
  without.scene.impostors.memory_mb = 0.0;
  CHECK(hash_image(without.drawn(0.0)) == hash_image(without.redrawn(0.0)));
  CHECK(without.impostors->counts.as_geometry == 3);

  // Of 25,600 triangles each, in a small picture, an impostor costs less; of 64 it does not.
  Hall cheaper{ImpostorUse::where_cheaper};
  cheaper.scene.camera.position_keys = {};
  cheaper.drawn(0.0);
  CHECK(cheaper.impostors->counts.shown == 3);
  Hall dearer{ImpostorUse::where_cheaper};
  dearer.scene.meshes[0] = make_torus(0.5, 0.25, 8, 4);
  CHECK(hash_image(dearer.drawn(0.0)) == hash_image(dearer.redrawn(0.0)));
  CHECK(dearer.impostors->counts.as_geometry == 3);
}

TEST_CASE("impostors as far as the background, with too strict a tolerance, or of no view") {
  // A half holds no depth beyond 65,504 m: there the background is no farther than anything.
  Hall far{ImpostorUse::wherever_possible};
  far.scene.camera.position_keys = {};
  far.scene.camera.position = {0.0, 0.0, 100'000.0};
  far.scene.camera.near_m = 100.0;
  far.scene.camera.far_m = 400'000.0;
  for (Object& object : far.scene.objects) object.scale = glm::dvec3{10'000.0};
  CHECK(hash_image(far.drawn(0.0)) == hash_image(far.redrawn(0.0)));
  Hall strict{ImpostorUse::wherever_possible};
  strict.scene.impostors.tolerance_px = 1e-3;
  CHECK(hash_image(strict.drawn(0.0)) == hash_image(strict.redrawn(0.0)));
  // The parts of a model are one impostor.
  Hall joined{ImpostorUse::wherever_possible};
  for (Object& object : joined.scene.objects) object.model = 7;
  joined.drawn(0.0);
  CHECK(joined.impostors->objects.all.size() == 1);
  // A still camera's time does not hang on the tolerance.
  Hall still{ImpostorUse::wherever_possible};
  still.scene.camera.position_keys = {};
  still.scene.impostors.milliseconds = 1e-3;
  still.drawn(0.0);
  CHECK(still.impostors->counts.tolerance_px == still.scene.impostors.tolerance_px);
}

TEST_CASE("transparent objects, moving ones and those with shaders are no impostors") {
  Hall with{ImpostorUse::wherever_possible};
  with.scene.materials[1].opacity = 0.5f;
  with.scene.objects[2].material = 2;
  with.drawn(0.0);
  CHECK(with.impostors->objects.all.size() == 1);
  Hall moving{ImpostorUse::wherever_possible};
  moving.scene.objects[1].sway = {0.0, 0.1, 0.0};
  CHECK(hash_image(moving.drawn(3.0)) != hash_image(moving.redrawn(3.0)));
  CHECK(moving.impostors->objects.all.size() == 2);
}

TEST_CASE("objects out of view are not drawn, and none that is in view is left out") {
  Hall with{ImpostorUse::wherever_possible};
  with.scene.camera.position_keys = {};
  for (const double x : {-6.0, -2.0, -0.5, 0.5, 2.0, 6.0}) {
    with.scene.camera.target = {x, 0.6, 0.0};
    with.prepared.reset();
    with.drawn(0.0);
    const ImpostorCounts& counts = with.impostors->counts;
    CHECK(counts.shown + counts.as_geometry + counts.out_of_view == 3);
    CHECK(with.flip_at(0.0) < 0.02);
  }
  with.scene.camera.target = {0.0, 0.6, 14.0};
  with.prepared.reset();
  CHECK(hash_image(with.drawn(0.0)) == hash_image(with.redrawn(0.0)));
  CHECK(with.impostors->counts.out_of_view == 3);
}

TEST_CASE("the memory of reliefs is kept to, and a budget of time raises the tolerance") {
  Hall with{ImpostorUse::wherever_possible};
  with.scene.impostors.memory_mb = 0.6;
  for (int frame = 0; frame < 100; frame += 4) {
    with.drawn(frame);
    CHECK(with.impostors->counts.bytes <= 600'000);
  }
  Hall timed{ImpostorUse::wherever_possible};
  timed.scene.impostors.milliseconds = 1e-3;
  timed.drawn(20.0);
  CHECK(timed.impostors->counts.tolerance_px == 16.0 * timed.scene.impostors.tolerance_px);
  timed.scene.impostors.milliseconds = 1e3;
  timed.drawn(20.0);
  CHECK(timed.impostors->counts.tolerance_px == timed.scene.impostors.tolerance_px);
}

TEST_CASE("impostors take their places among the layers, before and behind geometry") {
  Hall with{ImpostorUse::wherever_possible};
  with.prepare();
  constexpr std::size_t kLayers = 3;
  std::vector<Image> own(kLayers, make_image(Format::rgba16f, kSize, kSize));
  draw_layers(*with.prepared, with.camera_at(0.0), 0.0, own[0], std::span{own}.subspan(1),
              with.pool);
  CHECK(hash_image(own[0]) == hash_image(with.drawn(0.0)));
  const std::vector<Image> right = draw_layers(with.scene, with.camera_at(0.0), 0.0, kSize, kSize,
                                               kLayers, Profile{}, with.pool);
  int unordered = 0, wrong_floor = 0, behind_post = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const float first = load_texel(own[0], x, y).w, second = load_texel(own[1], x, y).w;
      unordered += first > second || second > load_texel(own[2], x, y).w ? 1 : 0;
      // What no torus is before or behind is as it was.
      const float right_first = load_texel(right[0], x, y).w;
      const bool is_post = std::fabs(right_first - 5.3f) < 0.3f;
      behind_post += is_post && second < 7.5f && second > 6.0f ? 1 : 0;
      wrong_floor += first > right_first + 0.5f ? 1 : 0;
    }
  }
  CHECK(unordered == 0);
  CHECK(behind_post > 20);
  CHECK(wrong_floor < kSize * kSize / 100);
}

TEST_CASE("impostors have smooth edges where geometry has, and end geometry's behind them") {
  Hall with{ImpostorUse::wherever_possible};
  with.prepare();
  const auto smoothed = [&](PreparedScene& prepared, FrameParts& parts) {
    draw_parts(prepared, with.camera_at(0.0), 0.0, kSize, kSize, 1, parts, with.pool, {}, 4);
    REQUIRE(parts.edges.samples == 4);
    return with_dof_input(parts, {}, Profile{}, {}, {}, [&](const DofInput& input) {
      return apply(*find_method("pinhole"), input, with.pool);
    });
  };
  FrameParts parts, right_parts;
  PreparedScene as_geometry = prepare_scene(with.scene, Profile{}, with.pool);
  const Image own = smoothed(*with.prepared, parts), right = smoothed(as_geometry, right_parts);
  CHECK(hash_image(parts.opaque) == hash_image(with.drawn(0.0)));
  const auto flip_of = [&](const Image& picture) {
    return measure_pictures(right, picture, nullptr, {}, with.pool).whole.flip;
  };
  CHECK(flip_of(own) < 0.9 * flip_of(parts.opaque));
  // Inside of an impostor there is an edge nowhere.
  int inside = 0, wrong = 0, outlines = 0;
  for (int y = 1; y + 1 < kSize; ++y) {
    for (int x = 1; x + 1 < kSize; ++x) {
      const auto shows_torus = [](const Image& picture, int at_x, int at_y) {
        const glm::vec4 texel = load_texel(picture, at_x, at_y);
        return texel.x > texel.z + 0.1f;
      };
      const auto is_torus = [&](int at_x, int at_y) {
        return shows_torus(parts.opaque, at_x, at_y);
      };
      const std::uint8_t coverage =
          row<std::uint8_t>(parts.edges.coverage, y)[static_cast<std::size_t>(x)];
      const bool is_outline = is_torus(x, y) != shows_torus(parts.edges.other, x, y);
      outlines += is_outline && coverage > 16 && coverage < 128 ? 1 : 0;
      if (!is_torus(x, y) || !is_torus(x - 1, y) || !is_torus(x + 1, y) || !is_torus(x, y - 1) ||
          !is_torus(x, y + 1)) {
        continue;
      }
      ++inside;
      wrong += coverage > 128 ? 1 : 0;
    }
  }
  CHECK(inside > 200);
  CHECK(outlines > 100);
  CHECK(wrong == 0);
}

TEST_CASE("a pane before an impostor and one behind it are seen so") {
  Hall with{ImpostorUse::wherever_possible};
  with.scene.materials.emplace_back();
  with.scene.materials.back().opacity = 0.5f;
  with.scene.materials.back().two_sided = true;
  for (const double z : {3.0, -3.0}) {
    Object pane;
    pane.mesh = 1;
    pane.material = 3;
    pane.position = {0.0, 1.0, z};
    pane.rotation_degrees = {90.0, 0.0, 0.0};
    pane.scale = glm::dvec3{0.3};
    with.scene.objects.push_back(pane);
  }
  CHECK(with.flip_at(0.0) < 0.02);
  CHECK(with.impostors->counts.shown == 3);
}

TEST_CASE("impostors cast shadows and receive them") {
  for (const ShadowKind kind : {ShadowKind::projected, ShadowKind::volumes, ShadowKind::map}) {
    CAPTURE(static_cast<int>(kind));
    Hall with{ImpostorUse::wherever_possible};
    with.scene.meshes[0] = make_torus(0.5, 0.25, 24, 12);
    const double without = [&] {
      const Image plain = with.redrawn(0.0);
      set_shadows(with.scene, kind);
      return measure_pictures(with.redrawn(0.0), plain, nullptr, {}, with.pool).whole.flip;
    }();
    CHECK(without > 0.03);
    CHECK(with.flip_at(0.0) < 0.02);
    CHECK(with.impostors->counts.shown == 3);
    // What is out of view casts its shadow, and so does what an impostor stands for.
    const auto floor_seen_alone = [&](bool hides) {
      Hall hall{hides ? ImpostorUse::wherever_possible : ImpostorUse::never};
      hall.scene.meshes[0] = with.scene.meshes[0];
      set_shadows(hall.scene, kind);
      hall.scene.camera.position_keys = {};
      hall.scene.camera.position = {-1.0, 3.0, 1.5};
      hall.scene.camera.target = {-1.2, 0.0, 0.6};
      hall.scene.camera.fov_y_degrees = 14.0;
      return hides ? hall.drawn(0.0) : hall.redrawn(0.0);
    };
    CHECK(measure_pictures(floor_seen_alone(false), floor_seen_alone(true), nullptr, {}, with.pool)
              .whole.flip < 0.02);
    // A relief has the shadows of its frame.
    with.scene.objects.back().sway = {0.5, 0.0, 0.0};
    with.scene.camera.position_keys = {};
    with.prepared.reset();
    CHECK(with.flip_at(0.0) < 0.02);
    const std::uint64_t after_another = hash_image(with.drawn(25.0));
    CHECK(with.impostors->counts.renewed == 3);
    with.prepared.reset();
    CHECK(hash_image(with.drawn(25.0)) == after_another);
    CHECK(with.flip_at(25.0) < 0.02);
  }
}

TEST_CASE("views of the lens are drawn with impostors") {
  Hall with{ImpostorUse::wherever_possible};
  with.prepare();
  const CameraMatrices camera = with.camera_at(0.0);
  for (const char* name : {"accumulation", "filtered-views", "warped-accumulation"}) {
    CAPTURE(name);
    const LensViewMethod& method = *find_lens_view_method(name);
    const auto seen = [&](std::shared_ptr<const StandIns> stand_ins) {
      const Image pinhole = stand_ins != nullptr ? with.drawn(0.0) : with.redrawn(0.0);
      const LensViewInput input{.scene = with.scene,
                                .camera = camera,
                                .pinhole = pinhole,
                                .focus_m = 5.0,
                                .aperture_radius_m = 0.05,
                                .sampling = {.samples = 16},
                                .profile = {},
                                .progress = {},
                                .stand_ins = std::move(stand_ins)};
      return method.render(input, with.pool).picture;
    };
    const Image own = seen(with.prepared->stand_ins), right = seen({});
    // Alpha is the pinhole's, which differs in any case; colours do where views have impostors.
    const double flip = measure_pictures(right, own, nullptr, {}, with.pool).whole.flip;
    CHECK(flip > 0.0);
    CHECK(flip < 0.02);
  }
  // From beside, through a picture whose middle is aside: in focus nothing moves.
  const CameraMatrices beside = lens_camera(camera, {0.3, -0.2}, 7.0, {0.3, 0.2}, kSize, kSize);
  Image own = make_image(Format::rgba16f, kSize, kSize);
  draw_scene(*with.prepared, beside, 0.0, own, with.pool);
  const Image right = draw_scene(with.scene, beside, 0.0, kSize, kSize, Profile{}, with.pool);
  CHECK(hash_image(own) != hash_image(right));
  CHECK(measure_pictures(right, own, nullptr, {}, with.pool).whole.flip < 0.02);
  // All 16 eyes are in a cell or two of each.
  CHECK(with.impostors->kept.size() < 3 * 8);
}
