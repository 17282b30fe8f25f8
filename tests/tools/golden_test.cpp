// The gate of "the same bits everywhere": one table of groups of hashes, tools/golden/table.inc,
// which must hold for every machine, compiler, optimisation level and thread count. When
// one changes, find the operation that changed before touching the table; print the new
// one with
//     softfocus selftest --print

#include <doctest/doctest.h>

#include <map>
#include <set>
#include <utility>

#include "tools/golden/hashes.h"

using namespace softfocus;

namespace {

// Two groups.
std::vector<NamedHash> five_hashes() {
  return {{"room a ieee 8x8", 0x11},
          {"room b ieee 8x8", 0x12},
          {"hall a ieee 8x8", 0x13},
          {"room c ieee 8x8", 0x14},
          {"hall b ieee 8x8", 0x15}};
}

std::string failures(const std::vector<NamedHash>& expected,
                     const std::vector<NamedHash>& computed) {
  return describe_failures(check_hashes(groups_of(expected), computed));
}

}  // namespace

TEST_CASE("the golden hashes, part by part, are the table's in its order, each with its own name" *
          doctest::test_suite("long")) {
  ThreadPool pool(2);
  std::vector<NamedHash> computed;
  std::set<std::string> names;
  for (const GoldenPart& part : golden_parts()) {
    for (const NamedHash& entry : part.hashes(pool)) {
      computed.push_back(entry);
      CHECK(names.insert(entry.name).second);
    }
  }
  const std::vector<HashGroup> expected = expected_groups();
  const std::vector<HashGroup> groups = groups_of(computed);
  REQUIRE(groups.size() == expected.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    CAPTURE(expected[i].name);
    CHECK(groups[i].name == expected[i].name);
    CHECK(groups[i].hash == expected[i].hash);
    CHECK(groups[i].ends == expected[i].ends);
  }
}

TEST_CASE("the parts of fewer golden hashes are these, in the table's order") {
  ThreadPool pool(2);
  std::vector<NamedHash> computed;
  for (const GoldenPart& part : golden_parts(GoldenSet::few)) {
    for (const NamedHash& entry : part.hashes(pool)) {
      computed.push_back(entry);
      CHECK(is_below(part.branch, group_of(entry.name)));
    }
  }
  const std::vector<HashGroup> expected = expected_groups(GoldenSet::few);
  const std::vector<HashGroup> groups = groups_of(computed);
  REQUIRE(groups.size() == expected.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    CAPTURE(expected[i].name);
    CHECK(groups[i].name == expected[i].name);
    CHECK(groups[i].hash == expected[i].hash);
  }
}

TEST_CASE("the quick golden hashes have every method under every profile, at the smaller size") {
  std::set<std::string> quick;
  for (const HashGroup& group : expected_groups(GoldenSet::quick)) quick.insert(group.name);
  for (const HashGroup& group : expected_groups()) {
    CAPTURE(group.name);
    const bool is_large = group.name.ends_with("128x128");
    const bool is_other =
        group.name.starts_with("cube-room") || group.name.starts_with("sphere-world");
    const bool is_ieee = group.name.find(" ieee ") != std::string::npos;
    CHECK(quick.contains(group.name) == (!is_large && (!is_other || is_ieee)));
  }
}

TEST_CASE("the golden hashes of a branch are those of its groups") {
  ThreadPool pool(1);
  for (const auto& [name, count] : {std::pair{"number", 1},
                                    {"samplers", 6},
                                    {"samplers ieee", 1},
                                    {"portrait ieee 97x61", 1},
                                    {"portrait", 1},
                                    {"port", 0},
                                    {"number half", 0}}) {
    const std::string branch = name;
    CAPTURE(branch);
    const std::vector<HashGroup> expected = expected_groups(GoldenSet::all, branch);
    CHECK(expected.size() == static_cast<std::size_t>(count));
    const std::vector<NamedHash> computed = golden_hashes(pool, GoldenSet::all, branch);
    CHECK(computed.size() == member_count(expected));
    CHECK(describe_failures(check_hashes(expected, computed)) == "");
  }
}

TEST_CASE("a frame's golden hash does not depend on the number of threads" *
          doctest::test_suite("threads long")) {
  const auto check = [&](std::string_view scene, int threads) {
    CAPTURE(scene);
    ThreadPool pool(threads);
    const std::string branch = std::string{scene} + " ieee";
    CHECK(describe_failures(check_hashes(expected_groups(GoldenSet::quick, branch),
                                         golden_hashes(pool, GoldenSet::quick, branch))) == "");
  };
  check("figures", 8);
  check("cube-room", 3);  // what moves, and textures
}

TEST_CASE("a golden hash tells one profile's frame from another's" * doctest::test_suite("long")) {
  std::map<std::string, std::vector<std::uint16_t>> ends;
  for (const HashGroup& group : expected_groups()) ends[group.name] = group.ends;
  int frames = 0;
  for (const std::string_view scene : golden_scenes()) {
    CAPTURE(scene);
    const std::string name{scene};
    const std::vector<std::uint16_t>& ieee = ends.at(name + " ieee 128x128");
    const std::vector<std::uint16_t>& llvmpipe = ends.at(name + " llvmpipe 128x128");
    REQUIRE(ieee.size() == llvmpipe.size());
    for (std::size_t i = 0; i < ieee.size(); ++i, ++frames) CHECK(ieee[i] != llvmpipe[i]);
  }
  ThreadPool pool(2);
  std::map<std::string, std::uint64_t> hashes;
  for (const char* profile : {"ieee", "llvmpipe"}) {
    const std::string branch = std::string{"figures "} + profile;
    for (const NamedHash& one : golden_hashes(pool, GoldenSet::quick, branch)) {
      hashes[one.name] = one.hash;
    }
  }
  for (const auto& entry : hashes) {
    std::string name = entry.first;
    const std::size_t at = name.find(" llvmpipe ");
    if (at == name.npos) continue;
    CAPTURE(name);
    CHECK(hashes.at(name.replace(at, 10, " ieee ")) != entry.second);
    ++frames;
  }
  CHECK(frames > 100);
}

TEST_CASE("golden hashes that are as expected have nothing to be described") {
  CHECK(failures(five_hashes(), five_hashes()) == "");
}

TEST_CASE("a wrong bit of any golden hash is a failure of this hash alone, and is named") {
  for (std::size_t i = 0; i < 5; ++i) {
    for (int bit = 0; bit < 16; ++bit) {
      CAPTURE(i);
      CAPTURE(bit);
      std::vector<NamedHash> computed = five_hashes();
      computed[i].hash ^= 1u << bit;
      const std::string text = failures(five_hashes(), computed);
      CHECK(text.starts_with("1 of 5 hashes differ; the first is '" + computed[i].name + "'"));
    }
  }
}

TEST_CASE("a wrong bit that no end tells fails every hash of its group") {
  for (int bit = 16; bit < 64; ++bit) {
    CAPTURE(bit);
    std::vector<NamedHash> computed = five_hashes();
    computed[3].hash ^= std::uint64_t{1} << bit;
    CHECK(failures(five_hashes(), computed) ==
          "3 of 5 hashes differ; the first is 'room a ieee 8x8': no end differs from the table's, "
          "but the hash of its group does");
  }
}

TEST_CASE("golden hashes that change places or names are failures") {
  std::vector<NamedHash> computed = five_hashes();
  std::swap(computed[0].hash, computed[1].hash);
  CHECK(failures(five_hashes(), computed).starts_with("2 of 5 hashes differ"));
  computed = five_hashes();
  std::swap(computed[0].name, computed[1].name);
  CHECK(failures(five_hashes(), computed).starts_with("3 of 5 hashes differ"));
}

TEST_CASE("the first wrong golden hash is named, with what was expected and computed") {
  std::vector<NamedHash> computed = five_hashes();
  computed[1].hash ^= 1;
  computed[2].hash ^= 1;
  CHECK(failures(five_hashes(), computed) ==
        "2 of 5 hashes differ; the first is 'room b ieee 8x8': expected one that ends in 0012, "
        "computed 0x0000000000000013");
}

TEST_CASE("a golden hash that the table lacks, and one that was not computed, do not pass") {
  const std::vector<NamedHash> all = five_hashes();
  const std::vector<NamedHash> four{all.begin(), all.end() - 1};
  CHECK(failures(four, all) ==
        "1 of 5 hashes differ; the first is 'hall b ieee 8x8': expected nothing, computed "
        "0x0000000000000015");
  CHECK(failures(all, four) ==
        "1 of 5 hashes differ; the first is 'hall ieee 8x8': expected one that ends in 0015, "
        "computed nothing");
}

TEST_CASE("a group that the table lacks, and one that was not computed, do not pass") {
  const std::vector<NamedHash> all = five_hashes();
  const std::vector<NamedHash> room{all[0], all[1], all[3]};
  CHECK(failures(room, all).starts_with("2 of 5 hashes differ"));
  CHECK(failures(all, room).starts_with("2 of 5 hashes differ"));
}
