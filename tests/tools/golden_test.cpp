// The gate of "the same bits everywhere": one table of hashes, tools/golden/table.inc,
// which must hold for every machine, compiler, optimisation level and thread count. When
// one changes, find the operation that changed before touching the table; print the new
// one with
//     softfocus selftest --print

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "tools/golden/hashes.h"

using namespace softfocus;

namespace {

// Making a scene's textures takes longer than drawing it small: each is made once.
const std::vector<GoldenScene>& scenes() {
  static const std::vector<GoldenScene> loaded = [] {
    ThreadPool pool(1);
    return load_golden_scenes(pool);
  }();
  return loaded;
}

std::vector<NamedHash> frames(std::string_view profile, int threads) {
  ThreadPool pool(threads);
  const NamedProfile named{profile, {}, find_profile(profile).value()};
  return frame_hashes(scenes(), golden_sizes(GoldenSet::quick), {&named, 1}, pool);
}

std::vector<NamedHash> three_hashes() { return {{"a", 1}, {"b", 2}, {"c", 3}}; }

}  // namespace

TEST_CASE("the golden hashes, part by part, are the table's in its order" *
          doctest::test_suite("long")) {
  ThreadPool pool(2);
  std::size_t at = 0;
  const std::vector<NamedHash> expected = expected_hashes();
  for (std::size_t part = 0; part < golden_part_count(); ++part) {
    for (const NamedHash& entry : golden_part(part, pool)) {
      REQUIRE(at < expected.size());
      CAPTURE(expected[at].name);
      CHECK(entry.name == expected[at].name);
      CHECK(entry.hash == expected[at].hash);
      ++at;
    }
  }
  CHECK(at == expected.size());
}

TEST_CASE("the quick golden hashes are the table's" * doctest::test_suite("long")) {
  ThreadPool pool(1);
  const auto computed = golden_hashes(pool, GoldenSet::quick);
  CHECK(describe_failures(check_hashes(expected_hashes(GoldenSet::quick), computed)) == "");
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
  const std::vector<NamedHash> expected = frames("ieee", 1);
  for (const int threads : {3, 8}) {
    CHECK(describe_failures(check_hashes(expected, frames("ieee", threads))) == "");
  }
}

TEST_CASE("a golden hash tells one profile's frame from another's") {
  const std::vector<NamedHash> ieee = frames("ieee", 2);
  const std::vector<NamedHash> llvmpipe = frames("llvmpipe", 2);
  // Shadows have an entry under ieee alone.
  REQUIRE(ieee.size() >= llvmpipe.size());
  for (const NamedHash& theirs : llvmpipe) {
    CAPTURE(theirs.name);
    std::string name = theirs.name;
    name.replace(name.find(" llvmpipe "), 10, " ieee ");
    const auto ours =
        std::find_if(ieee.begin(), ieee.end(), [&](const auto& one) { return one.name == name; });
    REQUIRE(ours != ieee.end());
    CHECK(ours->hash != theirs.hash);
  }
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
