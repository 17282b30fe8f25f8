// render --shard and join: the picture of one run from parts that several made.

#include "tests/support/cli_refused.h"
#include "tests/support/cli_render.h"

using namespace softfocus;

namespace {

Words accumulated(const std::string& output, const Words& more) {
  Words words = render("figures", output, {"--method", "accumulation", "--samples", "44"});
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Makes the shards 1 to `count` of a picture and returns their names.
Words make_shards(const TemporaryDirectory& directory, int count, const Words& more = {}) {
  Words parts;
  for (int number = 1; number <= count; ++number) {
    parts.push_back(directory.file("part" + std::to_string(number) + ".sum"));
    Words options{"--shard", std::to_string(number) + "/" + std::to_string(count)};
    options.insert(options.end(), more.begin(), more.end());
    const ProgramRun run = run_program(accumulated(parts.back(), options));
    CHECK(run.status == 0);
    CHECK(run.out + run.err == "");
  }
  return parts;
}

Words join(const Words& parts, const Words& more) {
  Words words{"join"};
  words.insert(words.end(), parts.begin(), parts.end());
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void check_options_refused(Words options, const Words& named) {
  const TemporaryDirectory directory;
  Words words{"render", "figures", "-o", directory.file("a.sum"), "--shard", "1/2"};
  words.insert(words.end(), options.begin(), options.end());
  check_refused(directory, words, 2, named);
}

}  // namespace

TEST_CASE("shards: joined, they are the file of one run, in every format, lens and all") {
  const TemporaryDirectory directory;
  const Words options{"--jitter", "--aperture-blades", "6",       "--frame", "1.5", "--focus",
                      "1.3",      "--profile",         "llvmpipe"};
  const Words parts = make_shards(directory, 3, options);
  Words endings{".png", ".npy", ".pfm", ".hdr"};
  if (missing_format(FileFormat::exr).empty()) endings.emplace_back(".exr");
  for (const std::string& ending : endings) {
    CAPTURE(ending);
    const std::string whole = directory.file("whole" + ending),
                      joined = directory.file("joined" + ending);
    CHECK(run_program(accumulated(whole, options)).status == 0);
    const ProgramRun run = run_program(join({parts[2], parts[0], parts[1]}, {"-o", joined}));
    CHECK(run.status == 0);
    CHECK(run.out + run.err == "");
    CHECK(read_file(joined) == read_file(whole));
    CHECK(read_file(joined + ".json") == read_file(whole + ".json"));
  }
  const ProgramRun piped = run_program(join(parts, {"-o", "-", "--format", "npy"}));
  CHECK(piped.out == read_file(directory.file("whole.npy")));
}

TEST_CASE("shards: the bytes do not depend on threads and vector units") {
  const TemporaryDirectory directory;
  const std::string one = read_file(make_shards(directory, 1, {"--threads", "1"})[0]);
  CHECK(read_file(make_shards(directory, 1, {"--threads", "3", "--isa", "scalar"})[0]) == one);
}

TEST_CASE("shards: of many frames, they are frames, and of each all samples") {
  const TemporaryDirectory directory;
  const Words words =
      accumulated(directory.file("a%d.png"), {"--frames", "1..4", "--shard", "2/2"});
  CHECK(run_program(words).status == 0);
  CHECK(run_program(accumulated(directory.file("b.png"), {"--frame", "4"})).status == 0);
  CHECK(read_file(directory.file("a4.png")) == read_file(directory.file("b.png")));
  CHECK(directory.listing() == Words{"a%d.png.2-of-2.journal", "a2.png", "a4.png", "b.png"});
}

TEST_CASE("join: parts that are missing, there twice or of another picture are named") {
  const TemporaryDirectory directory;
  const Words parts = make_shards(directory, 4);
  const std::string output = directory.file("a.png");
  const auto refused = [&](const Words& some, const Words& named) {
    check_refused(directory, join(some, {"-o", output}), 1, named);
  };
  refused({parts[2]}, {"1 of 4", "missing are 1, 2, 4"});
  refused({parts[0], parts[3], parts[1]}, {"3 of 4", "missing is 3"});
  refused({parts[0], parts[1], parts[2], parts[1]}, {parts[1], "shard 2", "once"});
  struct Other {
    Words options;
    const char* named;
  };
  for (const auto& [options, named] :
       {Other{{"--f-number", "7"}, "lens"}, Other{{"--frame", "2"}, "frame"},
        Other{{"--size", "49x32"}, "width"}, Other{{"--jitter"}, "method"},
        Other{{"--samples", "45"}, "method"}, Other{{"--profile", "llvmpipe"}, "profile"}}) {
    Words words = options;
    words.insert(words.end(), {"--shard", "2/4"});
    // The last of two sizes would be refused.
    Words all = accumulated(directory.file("other.sum"), words);
    if (options[0] == "--size" || options[0] == "--samples") {
      const auto first = std::find(all.begin(), all.end(), options[0]);
      all.erase(first, first + 2);
    }
    CHECK(run_program(all).status == 0);
    refused({parts[0], directory.file("other.sum")}, {"other.sum", parts[0], named});
  }
  CHECK(run_program(accumulated(directory.file("other.sum"), {"--shard", "2/5"})).status == 0);
  refused({parts[0], directory.file("other.sum")}, {"shards is 5, not 4"});
}

TEST_CASE("join: a scene that was edited between two shards is noticed, seen or not") {
  const TemporaryDirectory directory;
  const auto make = [&](const std::string& scene, const char* shard) {
    write_file(directory.file("s.toml"), scene);
    std::string output = directory.file(std::string{"part"} + shard[0] + ".sum");
    CHECK(run_program(render(directory.file("s.toml"), output,
                             {"--method", "accumulation", "--samples", "16", "--shard", shard}))
              .status == 0);
    return output;
  };
  const std::string first = make(kCube, "1/2");
  check_refused(directory,
                join({first, make(kCube + "# another\n", "2/2")}, {"-o", directory.file("a.png")}),
                1, {"part2.sum", "scene_files_hash"});
}

TEST_CASE("join: damaged and cut files are named, with what makes them again" *
          doctest::test_suite("long")) {
  const TemporaryDirectory directory;
  const Words parts = make_shards(directory, 2);
  const std::string bytes = read_file(parts[1]);
  const std::string output = directory.file("a.png");
  const auto refused = [&](const std::string& text, const Words& named) {
    write_file(parts[1], text);
    Words all{"'" + parts[1] + "'"};
    all.insert(all.end(), named.begin(), named.end());
    check_refused(directory, join(parts, {"-o", output}), 1, all);
    check_refused(directory, join({parts[1]}, {"--check"}), 1, all);
  };
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, std::size_t{19}}) {
    refused(bytes.substr(0, length), {"holds no sums"});
  }
  for (const std::size_t length : {std::size_t{20}, std::size_t{21}, std::size_t{400}}) {
    refused(bytes.substr(0, length), {"cut short", "make it again"});
  }
  for (const std::size_t left : {std::size_t{1000}, bytes.size() - 8, bytes.size() - 1}) {
    refused(bytes.substr(0, left), {"cut short: " + std::to_string(left), "shard 2/2 again"});
  }
  refused(bytes + "x", {"too long", "shard 2/2 again"});
  // A bit of everything: the header's marks, the depths, the totals, the checksum itself.
  for (std::size_t at = 0; at < bytes.size(); at += at < 700 ? 13 : 3001) {
    CAPTURE(at);
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    write_file(parts[1], damaged);
    CHECK(run_program(join(parts, {"-o", output})).status == 1);
    CHECK(run_program(join({parts[1]}, {"--check"})).status == 1);
  }
  std::string damaged = bytes;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  refused(damaged, {"checksum", "shard 2/2 again"});
  refused(parts[0], {"holds no sums"});

  write_file(parts[1], bytes);
  CHECK(run_program(join(parts, {"--check"})).status == 0);
  CHECK(run_program(join({parts[1]}, {"--check"})).status == 0);
}

TEST_CASE("join: a header that promises much takes no memory") {
  const TemporaryDirectory directory;
  const std::string part = directory.file("a.sum"), output = directory.file("a.png");
  const std::string good = read_file(make_shards(directory, 1)[0]);
  std::filesystem::remove(directory.file("part1.sum"));
  const auto refused = [&](const std::string& header, const Words& named) {
    std::string bytes = good.substr(0, 16);
    for (const unsigned shift : {0u, 8u, 16u, 24u}) {
      bytes += static_cast<char>(header.size() >> shift & 0xFFu);
    }
    write_file(part, bytes + header);
    check_refused(directory, join({part}, {"-o", output}), 1, named);
  };
  const std::string header = good.substr(20, good.find("}}") - 18);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = header;
    changed.replace(changed.find(from), from.size(), to);
    return changed;
  };
  refused(header, {"cut short"});
  refused(with("\"width\":48,\"height\":32", "\"width\":16384,\"height\":16384"), {"cut short"});
  refused(with("\"width\":48", "\"width\":4294967344"), {"header is damaged"});
  refused(with("\"shard\":1", "\"shard\":2"), {"header is damaged"});
  refused(with("\"shard\":1", "\"shard\":-1"), {"header is damaged"});
  refused(with("\"shards\":1", "\"shards\":7"), {"header is damaged"});
  refused(with("\"half_store\":0", "\"half_store\":3"), {"header is damaged"});
  refused(with("\"samples\":44", "\"samples\":1e99"), {"header is damaged"});
  refused(with("\"softfocus\":\"", "\"softfocus\":\"9"), {"softfocus 9", "version"});
  refused("", {"header is damaged"});
  refused("[]", {"header is damaged"});
  refused(std::string(30000, '['), {"header is damaged"});
  refused(std::string(30000, '[') + std::string(30000, ']'), {"header is damaged"});
  write_file(part, good.substr(0, 16) + "\xFF\xFF\xFF\x7F");
  check_refused(directory, join({part}, {"-o", output}), 1, {"header is damaged"});
}

TEST_CASE("shards: what cannot be shared out is refused") {
  const Words accumulation{"--method", "accumulation"};
  for (const char* method :
       {"two-pass", "filtered-views", "warped-accumulation", "surface-splatting", "auto"}) {
    check_options_refused({"--method", method}, {"--shard", "accumulation"});
  }
  check_options_refused({}, {"--shard", "accumulation"});
  const auto with = [&](Words options, const Words& named) {
    options.insert(options.begin(), accumulation.begin(), accumulation.end());
    check_options_refused(options, named);
  };
  with({"--show", "pinhole"}, {"--shard", "--show"});
  with({"--until", "0.1"}, {"--shard", "--until"});
  with({"--samples", "auto"}, {"--shard", "--samples auto"});
  with({"--samples", "8"}, {"--shard 1/2", "N is at most 1"});
  with({"--json"}, {"--shard", "--json"});
  with({"--format", "png"}, {"--shard", "--format"});
  with({"--depth-output", "d.npy"}, {"--shard", "--depth-output"});
  with({"--report", "r.txt"}, {"--shard", "--report"});

  const TemporaryDirectory directory;
  for (const char* output : {"a.png", "-", ""}) {
    Words words{"render", "figures", "-o", output, "--shard", "1/2"};
    words.insert(words.end(), accumulation.begin(), accumulation.end());
    check_refused(directory, words, 2, {"-o", ".sum"});
  }
  for (const char* shard : {"0/2", "3/2", "1", "1/", "/2", "1/2/3", "1.5/2", "-1/2", "a/b", ""}) {
    Words words{"render", "figures", "-o", directory.file("a.sum"), "--shard", shard};
    words.insert(words.end(), accumulation.begin(), accumulation.end());
    check_refused(directory, words, 2, {std::string{"--shard '"} + shard + "'", "I/N"});
  }
}

TEST_CASE("join: wrong usage begins nothing") {
  const TemporaryDirectory directory;
  const Words parts = make_shards(directory, 1);
  check_refused(directory, {"join", "-o", directory.file("a.png")}, 2, {"PARTS"});
  check_refused(directory, join(parts, {}), 2, {"-o is missing"});
  check_refused(directory, join(parts, {"-o", directory.file("a.xyz")}), 2, {"-o", ".png"});
  check_refused(directory, join(parts, {"-o", directory.file("a.png"), "--check"}), 2,
                {"--check", "-o"});
  check_refused(directory, join(parts, {"-o", parts[0], "--format", "png"}), 2,
                {"-o", "one of the parts"});
  check_refused(directory, join({directory.path()}, {"--check"}), 1, {directory.path()});
  check_refused(directory, join({"/dev/zero"}, {"--check"}), 1, {"/dev/zero", "no regular file"});
  check_refused(directory, join({directory.file("none.sum")}, {"--check"}), 1,
                {"none.sum", "No such file"});
  check_refused(directory, join(parts, {"-o", directory.file("none/a.png")}), 1, {"none/a.png"});
  RunSetting full;
  full.file_size_limit = 100;
  check_refused(directory, join(parts, {"-o", directory.file("a.npy")}), 1, {"a.npy"}, full);
  check_refused(directory, accumulated(directory.file("b.sum"), {"--shard", "1/2"}), 1, {"b.sum"},
                full);
}
