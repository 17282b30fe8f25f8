// The gate of "the same bits everywhere": one table of hashes, tools/golden/table.inc,
// which must hold for every machine, compiler, optimisation level and thread count. When
// one changes, find the operation that changed before touching the table; print the new
// one with
//     softfocus selftest --print

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <set>

#include "scenes/load/load_scene.h"
#include "tools/golden/hashes.h"

using namespace softfocus;

namespace {

std::vector<NamedHash> three_hashes() { return {{"a", 1}, {"b", 2}, {"c", 3}}; }

}  // namespace

TEST_CASE("the golden hashes, part by part, are the table's in its order" *
          doctest::test_suite("long")) {
  ThreadPool pool(2);
  std::size_t at = 0;
  const std::vector<NamedHash> expected = expected_hashes();
  for (const GoldenPart& part : golden_parts()) {
    for (const NamedHash& entry : part(pool)) {
      REQUIRE(at < expected.size());
      CAPTURE(expected[at].name);
      CHECK(entry.name == expected[at].name);
      CHECK(entry.hash == expected[at].hash);
      ++at;
    }
  }
  CHECK(at == expected.size());
}

TEST_CASE("the parts of fewer golden hashes are these, in the table's order") {
  ThreadPool pool(2);
  std::vector<NamedHash> computed;
  for (const GoldenPart& part : golden_parts(GoldenSet::few)) {
    for (const NamedHash& entry : part(pool)) computed.push_back(entry);
  }
  const std::vector<NamedHash> expected = expected_hashes(GoldenSet::few);
  REQUIRE(computed.size() == expected.size());
  for (std::size_t i = 0; i < computed.size(); ++i) {
    CAPTURE(expected[i].name);
    CHECK(computed[i].name == expected[i].name);
    CHECK(computed[i].hash == expected[i].hash);
  }
}

TEST_CASE("the quick golden hashes have every method under every profile, at the smaller size") {
  std::set<std::string> quick;
  for (const NamedHash& entry : expected_hashes(GoldenSet::quick)) quick.insert(entry.name);
  for (const NamedHash& entry : expected_hashes()) {
    CAPTURE(entry.name);
    const bool is_large = entry.name.ends_with("128x128");
    const bool is_other =
        entry.name.starts_with("cube-room") || entry.name.starts_with("sphere-world");
    const bool is_ieee = entry.name.find(" ieee ") != std::string::npos;
    CHECK(quick.contains(entry.name) == (!is_large && (!is_other || is_ieee)));
  }
}

TEST_CASE("a frame's golden hash does not depend on the number of threads" *
          doctest::test_suite("threads")) {
  std::map<std::string, std::uint64_t> expected;
  for (const NamedHash& entry : expected_hashes()) expected[entry.name] = entry.hash;
  const auto check = [&](std::string_view scene, int threads) {
    ThreadPool pool(threads);
    const GoldenScene loaded{std::string{scene}, load_scene(scene, scene_search_path({}))};
    const FrameSize& size = golden_sizes(GoldenSet::quick).front();
    for (const NamedHash& entry : frame_hashes(loaded, size, profiles().front(), pool)) {
      CAPTURE(entry.name);
      CHECK(entry.hash == expected[entry.name]);
    }
  };
  check("figures", 8);
  check("cube-room", 3);  // what moves, and textures
}

TEST_CASE("a golden hash tells one profile's frame from another's") {
  std::map<std::string, std::uint64_t> expected;
  for (const NamedHash& entry : expected_hashes()) expected[entry.name] = entry.hash;
  int frames = 0;
  for (const auto& entry : expected) {
    const std::string& name = entry.first;
    const std::size_t at = name.find(" llvmpipe ");
    if (at == name.npos) continue;
    CAPTURE(name);
    REQUIRE(expected.contains(std::string{name}.replace(at, 10, " ieee ")));
    CHECK(expected[std::string{name}.replace(at, 10, " ieee ")] != entry.second);
    ++frames;
  }
  CHECK(frames > 100);
}

TEST_CASE("no two golden hashes have one name") {
  std::vector<std::string> names;
  for (const NamedHash& entry : expected_hashes()) names.push_back(entry.name);
  std::sort(names.begin(), names.end());
  CHECK(std::adjacent_find(names.begin(), names.end()) == names.end());
}

TEST_CASE("golden hashes that are as expected have nothing to be described") {
  CHECK(describe_failures(check_hashes(three_hashes(), three_hashes())) == "");
}

TEST_CASE("the first wrong golden hash is named, with what was expected and computed") {
  std::vector<NamedHash> computed = three_hashes();
  computed[1].hash ^= 1;
  computed[2].hash ^= 1;
  CHECK(describe_failures(check_hashes(three_hashes(), computed)) ==
        "2 of 3 hashes differ; the first is 'b': expected 0x0000000000000002, computed "
        "0x0000000000000003");
}

TEST_CASE("a golden hash that the table lacks, and one that was not computed, do not pass") {
  const std::vector<NamedHash> all = three_hashes();
  const std::span<const NamedHash> two{all.data(), 2};
  CHECK(describe_failures(check_hashes(two, all)) ==
        "1 of 3 hashes differ; the first is 'c': expected nothing, computed 0x0000000000000003");
  CHECK(describe_failures(check_hashes(all, two)) ==
        "1 of 3 hashes differ; the first is 'c': expected 0x0000000000000003, computed nothing");
}
