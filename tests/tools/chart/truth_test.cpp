// The truth that contenders are held against: what it is, and when it is still right.

#include "tools/chart/record.h"

#include <doctest/doctest.h>

#include "tests/support/cli_render.h"
#include "tools/chart/measure.h"

using namespace softfocus;

namespace {

struct Case {
  std::string name = "figures";
  std::string file_bytes = "a scene";
  PictureSize size{40, 32};
  double frame = 0.0;
  int samples = 128;
  std::uint64_t measures = 1;
};

ChartScene scene_of(const Case& from, ThreadPool& pool) {
  ChartOptions options;
  options.size = from.size;
  options.frame = from.frame;
  return load_chart_scene(from.name, options, pool);
}

std::string key_of_case(const Case& from) {
  ThreadPool pool{2};
  return truth_key(scene_of(from, pool), from.file_bytes, from.samples, from.measures, pool);
}

ChartTruth truth_of(const ChartScene& scene, ThreadPool& pool) {
  return make_truth(
      scene, 128, [](int) {}, pool);
}

}  // namespace

TEST_CASE("chart truth: it is what accumulation gives of the sequence, to the bit") {
  ThreadPool pool{2};
  const ChartScene scene = scene_of({}, pool);
  for (const int samples : {128, 144}) {  // 72, half of the latter, is no group of pictures
    int last = 0;
    const ChartTruth truth = make_truth(
        scene, samples, [&](int done) { last = done; }, pool);
    CHECK(last == samples);
    LensViewInput input = accumulation_input(scene, samples);
    input.sampling.until = 0.0;
    CHECK(equal(truth.picture, accumulation(input, pool).picture));
  }
}

TEST_CASE("chart truth: its noise falls as samples grow, and is far below a sharp picture's error" *
          doctest::test_suite("long")) {
  ThreadPool pool{2};
  const ChartScene scene = scene_of({.size = {96, 96}}, pool);
  const auto made = [&](int samples) {
    return make_truth(
        scene, samples, [](int) {}, pool);
  };
  const ChartTruth few = made(128), many = made(1024);
  CHECK(many.noise_floor.psnr_db > few.noise_floor.psnr_db + 6.0);
  CHECK(many.noise_floor.flip < few.noise_floor.flip);
  const auto sharp = measure_pictures(many.picture, scene.pinhole, nullptr, {}, pool);
  CHECK(many.noise_floor.flip > 0.0);
  CHECK(many.noise_floor.flip < 0.1 * sharp.whole.flip);
}

TEST_CASE("chart key: the same for the same, another for anything that the truth depends on") {
  const std::string plain = key_of_case({});
  CHECK(key_of_case({}) == plain);
  CHECK(key_of_case({.name = "cube-room"}) != plain);
  CHECK(key_of_case({.file_bytes = "another"}) != plain);
  CHECK(key_of_case({.size = {40, 33}}) != plain);
  CHECK(key_of_case({.frame = 3.0}) != plain);
  CHECK(key_of_case({.samples = 144}) != plain);
  CHECK(key_of_case({.measures = 2}) != plain);
}

TEST_CASE(
    "chart key: a scene's file that changed gives another, even if the sharp picture is equal") {
  const TemporaryDirectory directory;
  const auto key_with = [&](const std::string& text) {
    write_file(directory.file("mine.toml"), kCube + text);
    ThreadPool pool{1};
    ChartOptions options;
    options.size = {32, 32};
    const std::string name = directory.file("mine.toml");
    return truth_key(load_chart_scene(name, options, pool), scene_file_bytes(name, {}), 128, 1,
                     pool);
  };
  const std::string plain = key_with("");
  CHECK(key_with("") == plain);
  CHECK(key_with("# a remark\n") != plain);
  CHECK(key_with("[lens]\nf_number = 1.5\n") != plain);
}

TEST_CASE("chart truth: kept under its key, whole, and not under another") {
  const TemporaryDirectory directory;
  ThreadPool pool{2};
  const ChartScene scene = scene_of({}, pool);
  const ChartTruth truth = truth_of(scene, pool);
  const std::string file = directory.file("figures.truth");
  CHECK_FALSE(load_truth("key", file).has_value());
  save_truth(truth, "key", file);
  const auto kept = load_truth("key", file);
  REQUIRE(kept.has_value());
  CHECK(equal(kept->picture, truth.picture));
  CHECK(kept->noise_floor.flip == truth.noise_floor.flip);
  CHECK(kept->noise_floor.psnr_db == truth.noise_floor.psnr_db);
  CHECK_FALSE(load_truth("another", file).has_value());
}

TEST_CASE("chart truth: a damaged file is not taken") {
  const TemporaryDirectory directory;
  ThreadPool pool{2};
  const ChartTruth truth = truth_of(scene_of({}, pool), pool);
  const std::string file = directory.file("figures.truth");
  const auto damaged = [&](const char* ending, auto damage) {
    save_truth(truth, "key", file);
    std::string bytes = read_file(file + ending);
    damage(bytes);
    write_file(file + ending, bytes);
    return !load_truth("key", file).has_value();
  };
  CHECK(damaged(".npy", [](std::string& bytes) { bytes[bytes.size() / 2] ^= 1; }));
  CHECK(damaged(".npy", [](std::string& bytes) { bytes.pop_back(); }));
  CHECK(damaged(".json", [](std::string& bytes) { bytes.resize(bytes.size() / 2); }));
  CHECK(damaged(".json", [](std::string& bytes) { bytes = "{\"key\": \"key\"}"; }));
  save_truth(truth, "key", file);
  std::filesystem::remove(file + ".npy");
  CHECK_FALSE(load_truth("key", file).has_value());
}

TEST_CASE("chart key: the measures' hash is the same each time, on any number of threads") {
  ThreadPool one{1}, four{4};
  CHECK(measures_hash(one) == measures_hash(one));
  CHECK(measures_hash(one) == measures_hash(four));
}

TEST_CASE("chart key: a random scene has no file; its name stands for it") {
  CHECK(scene_file_bytes("random:5", {}) == "random:5");
}
