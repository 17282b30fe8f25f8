#include "tools/chart/settings.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "raster/numbers/profile.h"
#include "tools/files/json.h"

using namespace softfocus;

namespace {

std::vector<std::string> texts(const std::string& method, int height_px, bool quick) {
  std::vector<std::string> list;
  for (const ChartEntry& entry : chart_entries(method, height_px, quick)) {
    list.push_back(settings_text(entry));
  }
  return list;
}

}  // namespace

TEST_CASE("chart settings: every method has some, but those that take rays") {
  const auto names = chart_methods();
  CHECK(names.size() == methods().size() + 5);
  CHECK(names[methods().size()] == "accumulation");
  CHECK(names[methods().size() + 1] == "filtered-views");
  CHECK(names[methods().size() + 2] == "warped-accumulation");
  CHECK(names.back() == "auto");
  for (const Method& method : methods()) {
    CAPTURE(method.name);
    CHECK(std::count(names.begin(), names.end(), method.name) == 1);
    for (const bool quick : {false, true}) {
      const auto entries = chart_entries(std::string{method.name}, 1024, quick);
      CHECK(!entries.empty());
      for (const ChartEntry& entry : entries) {
        CHECK(entry.method == method.name);
        CHECK(entry.filter == &method);
        CHECK(find_profile(entry.profile).has_value());
        CHECK(entry.samples == 0);
      }
    }
  }
}

TEST_CASE("chart settings: no two entries have an id in common") {
  std::set<std::string> ids;
  std::size_t entries = 0;
  for (const std::string& name : chart_methods()) {
    for (const ChartEntry& entry : chart_entries(name, 1024, false)) {
      ids.insert(entry_id(entry));
      ++entries;
    }
  }
  CHECK(ids.size() == entries);
  CHECK(ids.contains("two-pass-r16-d3d11"));
  CHECK(ids.contains("two-pass-r16-fixed-8"));
  CHECK(ids.contains("accumulation-s8"));
  CHECK(ids.contains("filtered-views-s8"));
  CHECK(ids.contains("warped-accumulation-s64-v7"));
  CHECK(ids.contains("auto-e0.02"));
  CHECK(ids.contains("pinhole"));
}

TEST_CASE("chart settings: every filter takes the same radii") {
  for (const bool quick : {false, true}) {
    const auto radii = texts("one-pass", 1024, quick);
    CHECK(radii.size() == (quick ? 2 : 4));
    for (const Method& method : methods()) {
      if (method.name == kPinhole) continue;
      CAPTURE(method.name);
      const auto own = texts(std::string{method.name}, 1024, quick);
      REQUIRE(own.size() >= radii.size());
      CHECK(std::equal(radii.begin(), radii.end(), own.begin()));
      // More of them are the same radii again, in another profile or arithmetic.
      for (const std::string& text : own) {
        CHECK(std::count(radii.begin(), radii.end(), text.substr(0, text.find(','))) == 1);
      }
    }
  }
  CHECK(texts("two-pass", 1024, false) ==
        std::vector<std::string>{"max-coc 8", "max-coc 16", "max-coc 32", "max-coc 64",
                                 "max-coc 8, d3d11", "max-coc 16, d3d11", "max-coc 32, d3d11",
                                 "max-coc 64, d3d11", "max-coc 8, fixed-8", "max-coc 16, fixed-8",
                                 "max-coc 32, fixed-8", "max-coc 64, fixed-8"});
  // Integers have circles of up to 64 pixels.
  CHECK(texts("two-pass", 2048, false).back() == "max-coc 64, fixed-8");
  CHECK(texts("two-pass", 2048, false).size() == 11);
}

TEST_CASE("chart settings: entries of one series differ in one setting alone") {
  std::vector<std::string> series, settings;
  for (const ChartEntry& entry : chart_entries("two-pass", 1024, true)) {
    series.push_back(series_name(entry));
    settings.push_back(setting_within_series(entry));
  }
  CHECK(series == std::vector<std::string>{"two-pass", "two-pass", "two-pass, d3d11",
                                           "two-pass, d3d11", "two-pass, fixed-8",
                                           "two-pass, fixed-8"});
  CHECK(settings == std::vector<std::string>{"max-coc 16", "max-coc 64", "max-coc 16", "max-coc 64",
                                             "max-coc 16", "max-coc 64"});
}

TEST_CASE("chart settings: radii follow the picture's height, and stay what a filter takes") {
  CHECK(texts("one-pass", 256, true) == std::vector<std::string>{"max-coc 4", "max-coc 16"});
  for (const ChartEntry& entry : chart_entries("two-pass", 16384, false)) {
    CHECK(entry.max_coc_px.value() <= kLargestMaxCoc);
  }
}

TEST_CASE("chart settings: accumulation takes 8 to 64 samples and draws the scene itself") {
  CHECK(texts("accumulation", 1024, false) ==
        std::vector<std::string>{"8 samples", "16 samples", "32 samples", "64 samples"});
  CHECK(chart_entries("accumulation", 1024, false).front().filter == nullptr);
}

TEST_CASE("chart settings: surface-splatting draws the scene in one go, without settings") {
  const auto entries = chart_entries("surface-splatting", 1024, false);
  REQUIRE(entries.size() == 1);
  CHECK(entries[0].filter == nullptr);
  CHECK(entries[0].of_scene == find_lens_view_method("surface-splatting"));
  CHECK(entry_id(entries[0]) == "surface-splatting");
  CHECK(settings_text(entries[0]).empty());
  CHECK(json_text(settings_json(entries[0])) == "{}");
}

TEST_CASE("chart settings: auto takes errors, and says what it chose once it has") {
  CHECK(texts("auto", 1024, false) ==
        std::vector<std::string>{"max-error 0.05", "max-error 0.02", "max-error 0.01"});
  ChartEntry entry = chart_entries("auto", 1024, true).at(1);
  CHECK(entry.filter == nullptr);
  entry.chosen = "two-pass, radius 8";
  CHECK(settings_text(entry) == "max-error 0.02: two-pass, radius 8");
  CHECK(json_text(settings_json(entry)) == R"({"max_error":0.02,"chosen":"two-pass, radius 8"})");
}

TEST_CASE("chart settings: as JSON they name what the method minds, and nothing else") {
  const auto json = [](const std::string& method) {
    return json_text(settings_json(chart_entries(method, 512, false).front()));
  };
  CHECK(json("two-pass") == R"({"max_coc_px":4.0,"profile":"ieee"})");
  CHECK(json("accumulation") == R"({"samples":8})");
  CHECK(json("pinhole") == R"({"profile":"ieee"})");
}
