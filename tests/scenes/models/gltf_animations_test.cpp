// Animations of glTF models: tracks against formulas, nodes against files in which they stand
// there.

#include <doctest/doctest.h>

#include <cmath>

#include "raster/numbers/random_bits.h"
#include "raster/numbers/vector_math.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/load/load_scene.h"
#include "scenes/load/model_scene.h"
#include "tests/scenes/models/gltf_text.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

using Frames = std::vector<double>;
using Values = std::vector<glm::dvec4>;

std::shared_ptr<const NodeTrack> track(KeyForm form, Frames frames, Values values) {
  return std::make_shared<NodeTrack>(NodeTrack{form, std::move(frames), std::move(values)});
}

NodeMotion still() {
  const auto constant = [](glm::dvec4 value) { return track(KeyForm::step, {0.0}, {value}); };
  return {nullptr, glm::dmat4{1.0}, constant(glm::dvec4{0.0}), constant({0, 0, 0, 1}),
          constant(glm::dvec4{1.0})};
}

double dot4(glm::dvec4 a, glm::dvec4 b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }

// By sines.
glm::dvec4 slerp(glm::dvec4 a, glm::dvec4 b, double t) {
  double cosine = dot4(a, b);
  if (cosine < 0.0) {
    b = -b;
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0));
  if (angle < 1e-9) return a;
  return (a * std::sin((1.0 - t) * angle) + b * std::sin(t * angle)) / std::sin(angle);
}

double off(const glm::dmat4& a, const glm::dmat4& b) {
  double most = 0.0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      most = std::max(most, std::fabs(a[column][row] - b[column][row]));
    }
  }
  return most;
}

const std::string kKeys = "{\"input\":1,\"output\":2,\"interpolation\":\"LINEAR\"}";

std::string animation(const std::string& channels, const std::string& samplers = kKeys) {
  return "{\"channels\":[" + channels + "],\"samplers\":[" + samplers + "]}";
}
std::string channel(int node, const std::string& path, int sampler = 0) {
  return "{\"sampler\":" + std::to_string(sampler) +
         ",\"target\":{\"node\":" + std::to_string(node) + ",\"path\":\"" + path + "\"}}";
}

// A triangle in node 0 that is at x = 0 at first and at x = 8 after half a second.
Gltf moving_triangle() {
  Gltf gltf = triangle();
  gltf.floats({0, 0.5f}, "SCALAR", 1);
  gltf.floats({0, 0, 0, 8, 0, 0}, "VEC3", 3);
  gltf.more = ",\"animations\":[" + animation(channel(0, "translation")) + "]";
  return gltf;
}

// What is told of the animation that is left out.
std::string animation_complaint(Gltf gltf, const std::string& of) {
  gltf.more = ",\"animations\":[" + of + "]";
  const Model model = load(gltf);
  CHECK(model.parts.at(0).motion == nullptr);
  const std::string said = model.warnings.at(0), before = ": an animation is left out: ";
  return said.find(before) == said.npos ? "" : said.substr(said.find(before) + before.size());
}

}  // namespace

TEST_CASE("a rotation between two keys is on the arc") {
  RandomSequence random{7};
  for (int i = 0; i < 2000; ++i) {
    glm::dvec4 ends[2];
    for (glm::dvec4& end : ends) {
      for (int k = 0; k < 4; ++k) end[k] = next_between(random, -1.0, 1.0);
      end = unit_quaternion(end);
    }
    if (i % 10 == 0) ends[1] = unit_quaternion(ends[0] + (ends[1] - ends[0]) * 1e-7);
    NodeMotion motion = still();
    motion.rotation = track(KeyForm::linear, {3.0, 5.0}, {ends[0], ends[1]});
    const double t = i % 7 == 0 ? 0.5 : next_between(random, 0.0, 1.0);
    const glm::dmat4 right =
        placing_matrix(glm::dvec3{0.0}, slerp(ends[0], ends[1], t), glm::dvec3{1.0});
    CHECK(off(matrix_at(motion, 3.0 + 2.0 * t), right) < 1e-12);
    for (const double frame : {-1.0, 3.0}) {
      CHECK(matrix_at(motion, frame) == placing_matrix(glm::dvec3{0.0}, ends[0], glm::dvec3{1.0}));
    }
    for (const double frame : {5.0, 9.0}) {
      CHECK(matrix_at(motion, frame) == placing_matrix(glm::dvec3{0.0}, ends[1], glm::dvec3{1.0}));
    }
  }
}

TEST_CASE("steps hold, lines are straight, cubics have the keys' values and speeds") {
  NodeMotion motion = still();
  const auto x_at = [&](double frame) { return matrix_at(motion, frame)[3].x; };
  const auto x = [](double value) { return glm::dvec4{value, 0.0, 0.0, 0.0}; };
  const Frames frames{1.0, 2.0, 4.0};
  const Values values{x(5.0), x(7.0), x(1.0)};
  motion.translation = track(KeyForm::step, frames, values);
  CHECK(x_at(0.0) == 5.0);
  CHECK(x_at(1.999) == 5.0);
  CHECK(x_at(2.0) == 7.0);
  CHECK(x_at(9.0) == 1.0);
  motion.translation = track(KeyForm::linear, frames, values);
  CHECK(x_at(1.5) == 6.0);
  CHECK(x_at(3.5) == 2.5);
  CHECK(last_frame(motion) == 4.0);
  motion.translation =
      track(KeyForm::cubic, {1.0, 3.0}, {x(9.0), x(5.0), x(2.0), x(-1.0), x(6.0), x(9.0)});
  CHECK(x_at(1.0) == 5.0);
  CHECK(x_at(3.0) == 6.0);
  const double step = 1e-6;
  CHECK(std::fabs((x_at(1.0 + step) - 5.0) / step - 2.0) < 1e-4);
  CHECK(std::fabs((6.0 - x_at(3.0 - step)) / step + 1.0) < 1e-4);
  // h00 5 + h10 2 * 2 + h01 6 - h11 2 * 1 at a half: 1/2, 1/8, 1/2, -1/8.
  CHECK(std::fabs(x_at(2.0) - (2.5 + 0.5 + 3.0 + 0.25)) < 1e-14);
  CHECK(reach(motion, 0.0) >= x_at(2.0));
}

TEST_CASE("the frames that tell a way have its last key, however many there are") {
  for (const int count : {2, 64, 65, 66, 500}) {
    Frames frames;
    for (int i = 0; i < count; ++i) frames.push_back(i + 5.0);
    NodeMotion motion = still();
    motion.translation = track(KeyForm::linear, frames, Values(frames.size(), glm::dvec4{0.0}));
    const Frames telling = telling_frames(motion);
    CHECK(telling.front() == 0.0);
    CHECK(telling.back() == last_frame(motion));
    CHECK(telling.size() <= 130);
  }
}

TEST_CASE("what a node moves is where its chain of nodes has it") {
  auto above = std::make_shared<NodeMotion>(still());
  above->rotation =
      track(KeyForm::linear, {0.0, 10.0}, {{0, 0, 0, 1}, unit_quaternion({0.0, 0.0, 1.0, 1.0})});
  NodeMotion below = still();
  below.above = above;
  below.between = placing_matrix({2, 0, 0}, {0, 0, 0, 1}, glm::dvec3{1.0});
  below.translation = track(KeyForm::linear, {0.0, 10.0}, {{0, 0, 0, 0}, {0, 1, 0, 0}});
  // A quarter turn about z of (2, 1, 0).
  const glm::dvec4 place = matrix_at(below, 10.0)[3];
  CHECK(off(glm::dmat4{matrix_at(below, 0.0)},
            placing_matrix({2, 0, 0}, {0, 0, 0, 1}, glm::dvec3{1.0})) == 0.0);
  CHECK(std::fabs(place.x + 1.0) < 1e-15);
  CHECK(std::fabs(place.y - 2.0) < 1e-15);
}

TEST_CASE("an animated node is at every frame what a file has that puts it there") {
  if (lacks_gltf()) return;
  ThreadPool pool(1);
  const TemporaryDirectory directory;
  const auto draw = [&](Gltf gltf, double frame) {
    // Another that stands still, and a camera.
    gltf.node("\"mesh\":0,\"translation\":[2,-1,-1]");
    gltf.node("\"camera\":0,\"translation\":[4,1,9]");
    gltf.more +=
        ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}]";
    write_file(directory.file("model.gltf"), gltf.text());
    Scene scene = load_scene(directory.file("model.gltf"), {});
    scene.camera.near_m = 1.0;
    scene.camera.far_m = 100.0;
    return draw_scene(scene, camera_matrices(scene.camera, frame, 48, 48), frame, 48, 48, Profile{},
                      pool);
  };
  for (const double frame : {0.0, 15.0, 30.0, 100.0}) {
    Gltf moved = moving_triangle();
    moved.node("\"mesh\":0,\"scale\":[1,1,-1],\"rotation\":[0,1,0,0]");
    const double x = std::min(frame, 30.0) * 8.0 / 30.0;
    Gltf standing = triangle();
    standing.node("\"mesh\":0,\"scale\":[1,1,-1],\"rotation\":[0,1,0,0],\"translation\":[" +
                  std::to_string(x) + ",0,0]");
    CHECK(hash_image(draw(moved, frame)) == hash_image(draw(standing, frame)));
  }
}

TEST_CASE(
    "parts move with the nearest node above that does; keys that are all the same move none") {
  if (lacks_gltf()) return;
  Gltf gltf = moving_triangle();
  gltf.node("\"children\":[1]");
  gltf.node("\"mesh\":0,\"translation\":[0,5,0]");
  gltf.node("\"mesh\":0");
  const Model model = load(gltf);
  REQUIRE(model.parts.size() == 2);
  CHECK(corners(model, 0) == Corners{{0, 5, 0}, {1, 5, 0}, {0, 7, 0}});
  REQUIRE(model.parts[0].motion != nullptr);
  CHECK(matrix_at(*model.parts[0].motion, 15.0)[3].x == 4.0);
  CHECK(model.parts[1].motion == nullptr);
  CHECK(model.warnings.empty());

  // Below one that stands aside.
  Gltf below = moving_triangle();
  below.node("\"mesh\":0");
  below.node("\"children\":[0],\"translation\":[0,0,3]");
  const glm::dmat4 aside = matrix_at(*load(below).parts.at(0).motion, 15.0);
  CHECK(glm::dvec3{aside[3]} == glm::dvec3{4, 0, 3});

  Gltf same = triangle();
  same.floats({0, 0.5f}, "SCALAR", 1);
  same.floats({3, 0, 0, 3, 0, 0}, "VEC3", 3);
  same.more = ",\"animations\":[" + animation(channel(0, "translation")) + "]";
  const Model stands = load(same);
  CHECK(stands.parts[0].motion == nullptr);
  CHECK(corners(stands) == Corners{{3, 0, 0}, {4, 0, 0}, {3, 2, 0}});
}

TEST_CASE("of several animations all move their nodes, and the first of one node's counts") {
  if (lacks_gltf()) return;
  Gltf gltf = moving_triangle();
  gltf.node("\"mesh\":0");
  gltf.node("\"mesh\":0");
  gltf.floats({0, 0, 0, 0, 6, 0}, "VEC3", 3);
  const std::string other = "{\"input\":1,\"output\":3}";
  gltf.more = ",\"animations\":[" + animation(channel(0, "translation")) + "," +
              animation(channel(1, "translation") + "," + channel(0, "translation"), other) + "]";
  const Model model = load(gltf);
  REQUIRE(model.parts.size() == 2);
  CHECK(glm::dvec3{matrix_at(*model.parts[0].motion, 30.0)[3]} == glm::dvec3{8, 0, 0});
  CHECK(glm::dvec3{matrix_at(*model.parts[1].motion, 30.0)[3]} == glm::dvec3{0, 6, 0});
  CHECK(warns(model, "of several animations of a node the first is there"));
}

TEST_CASE("an animated camera flies, and sees as far as it ever has to") {
  if (lacks_gltf()) return;
  Gltf gltf = moving_triangle();
  gltf.node("\"camera\":0,\"rotation\":[0,0.6,0,0.8]");
  gltf.node("\"mesh\":0");
  gltf.more +=
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}]";
  const Model model = load(gltf);
  REQUIRE(model.camera);
  CHECK(model.camera->position_keys[0].size() == 31);
  CHECK(model.camera->position_keys[0][15] == Keyframe{15.0, 4.0});
  CHECK(model.camera->up_keys[1][30].value == 1.0);
  // Back is the third column: 2 (x z + y w), -, 1 - 2 y y.
  CHECK(std::fabs(model.camera->target_keys[0][30].value - (8.0 - 0.96)) < 1e-6);
  const Scene scene = make_model_scene(model, "flight");
  CHECK(scene.camera.far_m > 8.0);
  CHECK(scene.notes.back() == "flight: moves up to frame 30, 60 a second (--frames)");
}

TEST_CASE("a moving model far from the origin, and one that a scene puts somewhere") {
  if (lacks_gltf()) return;
  Gltf gltf = moving_triangle();
  gltf.node("\"children\":[1]");
  gltf.node("\"mesh\":0,\"translation\":[0,4096,0]");
  gltf.node("\"mesh\":0,\"translation\":[2,4096,0]");
  const TemporaryDirectory directory;
  write_file(directory.file("far.gltf"), gltf.text());
  const Model model = load(gltf);
  CHECK(model.origin.y == 4097.0);
  const Scene alone = load_scene(directory.file("far.gltf"), {});
  const auto place = [](const Scene& scene, std::size_t object, double frame) {
    const Object& of = scene.objects.at(object);
    const glm::dmat4 m = object_matrix(of, frame);
    const glm::dvec3 p{scene.meshes.at(of.mesh).positions.at(0)};
    return glm::dvec3{((m[0] * p.x + m[1] * p.y) + m[2] * p.z) + m[3]};
  };
  CHECK(place(alone, 0, 0.0) == glm::dvec3{0, 4096, 0} - model.origin);
  CHECK(place(alone, 0, 15.0) == glm::dvec3{4, 4096, 0} - model.origin);
  CHECK(place(alone, 1, 15.0) == glm::dvec3{2, 4096, 0} - model.origin);
  write_file(directory.file("scene.toml"),
             "[material.any]\n[[object]]\nshape = \"model\"\nfile = \"far.gltf\"\n"
             "position = [0, -4096, 1]\nscale = 2\n[[object]]\nshape = \"model\"\n"
             "file = \"far.gltf\"\nposition = [1, 0, 0]\n");
  const Scene within = load_scene(directory.file("scene.toml"), {});
  CHECK(place(within, 0, 15.0) == glm::dvec3{8, 4096, 1});
  CHECK(place(within, 1, 15.0) == glm::dvec3{4, 4096, 1});
  CHECK(place(within, 2, 30.0) == glm::dvec3{9, 4096, 0});
  CHECK(place(within, 3, 30.0) == glm::dvec3{3, 4096, 0});
}

TEST_CASE("what does not move: skins, morph targets, lights") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle(",\"JOINTS_0\":3,\"WEIGHTS_0\":4");
  gltf.floats({0, 0.5f}, "SCALAR", 1);
  gltf.floats({2, 0, 0, 8, 0, 0}, "VEC3", 3);
  gltf.add<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4, kByte);
  gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  gltf.node("\"mesh\":0,\"skin\":0");
  gltf.node("\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}");
  gltf.more =
      ",\"skins\":[{\"joints\":[1]}],\"extensions\":{\"KHR_lights_punctual\":"
      "{\"lights\":[{\"type\":\"point\"}]}},\"animations\":[" +
      animation(channel(1, "translation") + "," + channel(0, "translation") + "," +
                channel(0, "weights")) +
      "]";
  const Model model = load(gltf);
  CHECK(corners(model) == Corners{{2, 0, 0}, {3, 0, 0}, {2, 2, 0}});
  CHECK(model.parts[0].motion == nullptr);
  CHECK(warns(model, "skins stand as they do at frame 0"));
  CHECK(warns(model, "lights stand as they do at frame 0"));
  CHECK(warns(model, "an animation of weights is left out"));
}

TEST_CASE("rotation, scale and cubics of a file, in seconds that are sixtieths in binary32") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.floats({7 / 60.0f, 13 / 60.0f}, "SCALAR", 1);
  gltf.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4);
  gltf.floats({9, 9, 9, 1, 1, 1, 60, 0, 0, 30, 0, 0, 2, 1, 4, 9, 9, 9}, "VEC3", 3);
  gltf.floats({9, 9, 9, 9, 0, 0, 0, 1, 0, 0, 60, 0, 0, 0, 0, 0, 0, 0, 1, 0, 9, 9, 9, 9}, "VEC4", 4);
  gltf.node("\"mesh\":0");
  gltf.node("\"mesh\":0");
  gltf.more = ",\"animations\":[" +
              animation(channel(0, "rotation", 0) + "," + channel(0, "scale", 1) + "," +
                            channel(1, "rotation", 2),
                        "{\"input\":1,\"output\":2,\"interpolation\":\"STEP\"},"
                        "{\"input\":1,\"output\":3,\"interpolation\":\"CUBICSPLINE\"},"
                        "{\"input\":1,\"output\":4,\"interpolation\":\"CUBICSPLINE\"}") +
              "]";
  const Model model = load(gltf);
  REQUIRE(model.parts.size() == 2);
  const NodeMotion& first = *model.parts[0].motion;
  // A half turn about z at frame 13, and not before; twice as wide and four times as deep.
  CHECK(matrix_at(first, 12.999)[0].x > 0.0);
  CHECK(matrix_at(first, 13.0)[0].x == -2.0);
  CHECK(matrix_at(first, 13.0)[2].z == 4.0);
  // 1 + 60 a second behind the first key, 30 before the second: 1/2 + 6/8 + 2/2 - 3/8.
  CHECK(std::fabs(matrix_at(first, 10.0)[0].x - 1.875) < 1e-12);
  // (0, 0, 6/8 + 1/2, 1/2), made a unit.
  const double z = 1.25, w = 0.5;
  CHECK(std::fabs(matrix_at(*model.parts[1].motion, 10.0)[0].x -
                  (w * w - z * z) / (w * w + z * z)) < 1e-12);
}

TEST_CASE("a chain of many nodes that move is no matter, and one beyond 1e9 is refused") {
  if (lacks_gltf()) return;
  const auto chain = [](int count, const std::string& scale) {
    Gltf gltf = triangle();
    gltf.floats({0, 0.5f}, "SCALAR", 1);
    gltf.floats({0, 0, 0.1f, 1, 0, 0, 0.3f, 1}, "VEC4", 4);
    std::string channels;
    for (int i = 0; i < count; ++i) {
      gltf.node("\"translation\":[0,0.3,0]," + scale +
                (i + 1 < count ? "\"children\":[" + std::to_string(i + 1) + "]" : "\"mesh\":0"));
      channels += (i > 0 ? "," : "") + channel(i, "rotation");
    }
    gltf.more = ",\"animations\":[" + animation(channels) + "]";
    return gltf.text();
  };
  CHECK(load(chain(60, "")).parts[0].motion != nullptr);
  CHECK(complaint(chain(60, "\"scale\":[2,2,2],")) == "an animation leads beyond 1e9");
  CHECK(complaint(chain(120, "")) == "node 101 lies below more than 100 that move");
}

TEST_CASE("a model is framed with all of its way, also one that is nothing at frame 0") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.floats({1, 2}, "SCALAR", 1);
  gltf.floats({0, 0, 0, 1, 1, 1}, "VEC3", 3);
  gltf.floats({0, 0, 0, 900, 0, 0}, "VEC3", 3);
  gltf.node("\"mesh\":0");
  gltf.node("\"children\":[0]");
  gltf.more = ",\"animations\":[" + animation(channel(0, "scale")) + "]";
  const Scene pops = make_model_scene(load(gltf), "pops");
  CHECK(length_of(pops.camera.position - pops.camera.target) < 20.0);
  gltf.more = ",\"animations\":[" +
              animation(channel(1, "translation"), "{\"input\":1,\"output\":3}") + "]";
  const Scene leaves = make_model_scene(load(gltf), "leaves");
  CHECK(length_of(leaves.camera.position - leaves.camera.target) > 900.0);
  CHECK(std::fabs(leaves.camera.target.x - 450.0) < 2.0);
}

TEST_CASE("a camera may look straight down and on, and roll") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle();
  gltf.floats({0, 1, 2}, "SCALAR", 1);
  const float half = 0.70710678f;
  gltf.floats({0, 0, 0, 1, -half, 0, 0, half, -1, 0, 0, 0}, "VEC4", 4);
  gltf.node("\"camera\":0,\"translation\":[0,0,5]");
  gltf.node("\"mesh\":0");
  gltf.more =
      ",\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":1,\"znear\":0.1}}],"
      "\"animations\":[" +
      animation(channel(0, "rotation")) + "]";
  const Scene scene = make_model_scene(load(gltf), "down");
  for (double frame = 0.0; frame <= 120.0; frame += 7.5) CHECK(can_look(scene.camera, frame));
  const CameraMatrices upside_down = camera_matrices(scene.camera, 120.0, 8, 8);
  CHECK(std::fabs(eye_axis(upside_down, 1).y + 1.0) < 1e-6);
}

TEST_CASE("animations that cannot be are left out, and told") {
  if (lacks_gltf()) return;
  Gltf gltf = moving_triangle();
  gltf.floats({0.5f, 0.5f}, "SCALAR", 1);
  gltf.floats({0, 0, 0, 2e9f, 0, 0}, "VEC3", 3);
  gltf.floats({0, 0, 0, 9e8f, 0, 0}, "VEC3", 3);
  gltf.node("\"mesh\":0,\"scale\":[1e9,1,1]");
  CHECK(animation_complaint(gltf, animation(channel(0, "scale", 3))) ==
        "there is no sampler of an animation 3 of 1");
  CHECK(animation_complaint(gltf, animation(channel(0, "rotation"))) ==
        "sampler 0 of an animation has 2 values of 3 numbers where 2 of 4 would be right");
  CHECK(animation_complaint(gltf, animation(channel(0, "scale"), "{\"input\":3,\"output\":2}")) ==
        "sampler 0 of an animation has times that do not increase");
  CHECK(animation_complaint(gltf, animation(channel(0, "scale"), "{\"input\":2,\"output\":2}")) ==
        "sampler 0 of an animation has times of more than one number");
  CHECK(animation_complaint(gltf,
                            animation(channel(0, "translation"), "{\"input\":1,\"output\":4}")) ==
        "sampler 0 of an animation has a value that is no number, or beyond 1e9");
  CHECK(animation_complaint(gltf,
                            animation(channel(0, "translation"),
                                      "{\"input\":1,\"output\":2,\"interpolation\":\"ROUND\"}")) ==
        "sampler 0 of an animation goes from key to key by ROUND; LINEAR, STEP or CUBICSPLINE "
        "would be right");
}
