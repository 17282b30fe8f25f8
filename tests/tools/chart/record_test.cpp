#include "tools/chart/record.h"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/support/chart_points.h"
#include "tests/support/run_program.h"
#include "tools/golden/hashes.h"
#include "tools/report/laboratory.h"

using namespace softfocus;

namespace {

ChartPoint bare(const ChartPoint& of) {
  ChartPoint point{.entry = of.entry};
  point.picture_hash = of.picture_hash;
  return point;
}

/// Whether what is kept of a point was taken over; else it is made, and kept.
bool is_kept(const ChartPoint& point, const LabMeasure& measure, const char* key,
             const std::string& file) {
  KeptResults record{file, key};
  Laboratory lab{true};
  lab.settle(record, "point", hash_text(point.picture_hash), measure);
  record.save();
  CHECK(lab.all == 1);
  return lab.kept == 1;
}

LabMeasure errors_measure(ChartPoint& to, const ChartPoint& of) {
  return {.name = "errors",
          .make = [&of] { return errors_json(of.errors); },
          .take = [&to](const Json& json) { to.errors = errors_of(json); }};
}

LabMeasure pictures_measure(ChartPoint& to, const ChartPoint& of) {
  return {.name = "pictures",
          .make = [&of] { return pictures_json(of); },
          .take = [&to](const Json& json) { take_pictures(json, to); }};
}

}  // namespace

TEST_CASE("chart record: a point comes back as it was, with what is no number") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.json");
  ChartPoint point = test::chart_point("two-pass", 2, {1.5}, 0.0625);
  point.errors.psnr_db = std::numeric_limits<double>::infinity();
  ChartPoint first = bare(point);
  CHECK_FALSE(is_kept(first, errors_measure(first, point), "key", file));
  CHECK_FALSE(is_kept(first, pictures_measure(first, point), "key", file));
  ChartPoint kept = bare(point);
  REQUIRE(is_kept(kept, errors_measure(kept, point), "key", file));
  CHECK(kept.pictures.empty());
  REQUIRE(is_kept(kept, pictures_measure(kept, point), "key", file));
  CHECK(std::isinf(kept.errors.psnr_db));
  CHECK(kept.errors.ssim == 0.875);
  CHECK(kept.errors.flip == 0.0625);
  CHECK(std::isnan(kept.errors.flip_by_region[1]));
  CHECK(kept.errors.flip_by_region[3] == 0.25);
  CHECK(kept.errors.hdr_flip == 0.125);
  CHECK(kept.errors.hdr_flip_by_region[0] == 0.75);
  CHECK(std::isnan(kept.errors.hdr_flip_by_region[1]));
  CHECK(kept.worst.x == 3);
  CHECK(kept.worst.side == 16);
  CHECK(kept.pictures.picture == "AAAA");
  CHECK(kept.pictures.worst_error == "EEEE");
  CHECK(kept.times.frame_ms.empty());
}

TEST_CASE("laboratory: another key, another picture or a damaged file is not taken") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.json");
  const ChartPoint point = test::chart_point("two-pass", 2, {1.5}, 0.0625);
  for (const auto& measure_of : {&errors_measure, &pictures_measure}) {
    ChartPoint kept = bare(point);
    const auto is_there = [&](const char* key) {
      return is_kept(kept, measure_of(kept, point), key, file);
    };
    const auto start = [&] {
      std::filesystem::remove(file);
      CHECK_FALSE(is_there("key"));
      CHECK(is_there("key"));
      kept = bare(point);
    };
    start();
    CHECK_FALSE(is_there("another"));
    start();
    ++kept.picture_hash;
    CHECK_FALSE(is_there("key"));
    start();
    const std::string bytes = read_file(file);
    for (const std::string& damaged :
         {bytes.substr(0, bytes.size() / 2), std::string{"[]"}, std::string{}, std::string{"{}"},
          R"({"key":"key","point":{"hash":"0x0000000000000123","errors":{},"pictures":{}}})" +
              std::string{}}) {
      write_file(file, damaged);
      CHECK_FALSE(is_there("key"));
      CHECK(is_there("key"));  // made again
    }
  }
}

TEST_CASE("laboratory: what is damaged leaves a point as it was") {
  ChartPoint point = bare(test::chart_point("two-pass", 2, {1.5}, 0.0625));
  const auto json = parse_json(R"({"place":[1,2,3],"picture":"AAAA"})");
  CHECK_THROWS_AS(take_pictures(*json, point), JsonError);
  CHECK(point.pictures.empty());
  CHECK(point.worst.side == 0);
}

TEST_CASE("laboratory: with again nothing kept is taken over") {
  const TemporaryDirectory directory;
  KeptResults record{directory.file("a.json"), "key"};
  record.keep("truth", "", "picture", "AAAA");
  for (const bool again : {false, true}) {
    Laboratory lab{true, again};
    std::string picture;
    lab.settle(record, "truth", "",
               {.name = "picture",
                .make = [] { return Json("BBBB"); },
                .take = [&](const Json& json) { picture = json.text(); },
                .is_result = false});
    CHECK(picture == (again ? "BBBB" : "AAAA"));
    CHECK(lab.all == 0);
    CHECK(lab.kept == 0);
  }
}

TEST_CASE("laboratory: a contender that is not for the case is measured by nothing") {
  const TemporaryDirectory directory;
  KeptResults record{directory.file("a.json"), "key"};
  Laboratory lab{true};
  lab.run(record, {.name = "a",
                   .stage = "a",
                   .kind = "a",
                   .run = [] { return std::optional<std::string>{}; },
                   .measures =
                       [](const std::string&) {
                         FAIL("it has no pictures");
                         return std::vector<LabMeasure>{};
                       }});
  CHECK(lab.all == 0);
}

TEST_CASE("chart record: times come back to the points whose pictures are the same") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("times.json");
  const auto points = test::chart_panel("figures").points;
  save_times(points, "key", file);
  std::vector<ChartPoint> kept;
  kept.reserve(points.size());
  for (const ChartPoint& point : points) kept.push_back(bare(point));
  load_times(kept, "another", file);
  CHECK(kept[0].times.frame_ms.empty());
  kept[1].picture_hash = 7;
  load_times(kept, "key", file);
  CHECK(kept[0].times.frame_ms == points[0].times.frame_ms);
  CHECK(kept[0].times.filter_ms == points[0].times.filter_ms);
  CHECK(kept[1].times.frame_ms.empty());
  CHECK(kept[3].times.frame_ms == std::vector<double>{700});
  CHECK(kept[3].times.filter_ms.empty());
}
