#include "tools/chart/record.h"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/chart_points.h"
#include "tests/support/run_program.h"

using namespace softfocus;

namespace {

ChartPoint bare(const ChartPoint& of) {
  ChartPoint point{.entry = of.entry};
  point.picture_hash = of.picture_hash;
  return point;
}

}  // namespace

TEST_CASE("chart record: a point comes back as it was, with what is no number") {
  const TemporaryDirectory directory;
  ChartPoint point = test::chart_point("two-pass", 2, {1.5}, 0.0625);
  point.errors.psnr_db = std::numeric_limits<double>::infinity();
  save_errors(point, "key", directory.file("a.json"));
  ChartPoint without = bare(point);
  CHECK_FALSE(load_pictures(without, "key", directory.file("a.json")));
  save_pictures(point, "key", directory.file("a.json"));
  ChartPoint kept = bare(point);
  REQUIRE(load_errors(kept, "key", directory.file("a.json")));
  CHECK(kept.pictures.empty());
  REQUIRE(load_pictures(kept, "key", directory.file("a.json")));
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

TEST_CASE("chart record: another key, another picture or a damaged file is not taken") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.json");
  const ChartPoint point = test::chart_point("two-pass", 2, {1.5}, 0.0625);
  for (const auto& [save, load] :
       {std::pair{&save_errors, &load_errors}, std::pair{&save_pictures, &load_pictures}}) {
    save(point, "key", file);
    ChartPoint kept = bare(point);
    CHECK_FALSE(load(kept, "another", file));
    ++kept.picture_hash;
    CHECK_FALSE(load(kept, "key", file));
    --kept.picture_hash;
    const std::string bytes = read_file(file);
    for (const std::string& damaged :
         {bytes.substr(0, bytes.size() / 2), std::string{"[]"}, std::string{}, std::string{"{}"},
          R"({"key":"key","point":{"hash":"0x0000000000000123","errors":{},"pictures":{}}})" +
              std::string{}}) {
      write_file(file, damaged);
      CHECK_FALSE(load(kept, "key", file));
      CHECK(kept.pictures.empty());
      CHECK(kept.errors.flip == 0.0);
    }
    CHECK_FALSE(load(kept, "key", directory.file("not-there.json")));
  }
}

TEST_CASE("chart record: the truth's picture comes back under its key alone") {
  const TemporaryDirectory directory;
  const std::string file = directory.file("a.json");
  CHECK(load_truth_picture("key", file).empty());
  save_truth_picture("AAAA", "key", file);
  CHECK(load_truth_picture("key", file) == "AAAA");
  CHECK(load_truth_picture("another", file).empty());
  write_file(file, "{\"key\": \"key\"}");
  CHECK(load_truth_picture("key", file).empty());
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
