#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>

#include "tests/support/run_program.h"
#include "tools/cli/errors.h"
#include "tools/sequence/journal.h"
#include "tools/sequence/run_frames.h"

using namespace softfocus;

TEST_CASE("a line of the journal comes back, and no part of it does") {
  const JournalLine line{12, 0x0123456789ABCDEFu, ~std::uint64_t{0}};
  const std::string text = journal_line(line);
  CHECK(text.ends_with('\n'));
  const std::string whole = text.substr(0, text.size() - 1);
  CHECK(parse_journal_line(whole) == line);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CHECK(!parse_journal_line(whole.substr(0, length)));
  }
  CHECK(!parse_journal_line(whole + "0"));
  CHECK(!parse_journal_line(whole.substr(0, 40) + whole));
  std::string other = whole;
  other[6] = '9';
  CHECK(!parse_journal_line(other));
}

TEST_CASE("a journal keeps what was added, beside what is torn") {
  const TemporaryDirectory directory;
  const std::string output = directory.file("f_%d.png");
  const JournalLine first{1, 2, 3}, second{2, 2, 3}, third{3, 2, 3};
  { CHECK(Journal(output, "").add(first)); }
  const std::string file = output + ".journal";
  const std::string torn = journal_line(second);
  write_file(file, read_file(file) + torn.substr(0, torn.size() / 2));
  {
    Journal journal{output, ""};
    CHECK(journal.has(first));
    CHECK(!journal.has(second));
    CHECK(journal.add(third));
  }
  const Journal journal{output, ""};
  CHECK(journal.has(first));
  CHECK(!journal.has(second));
  CHECK(journal.has(third));
}

TEST_CASE("a journal on a full disk says so, and goes on") {
  const TemporaryDirectory directory;
  std::filesystem::create_symlink("/dev/full", directory.file("f_%d.png.journal"));
  Journal journal{directory.file("f_%d.png"), ""};
  CHECK(!journal.add({1, 2, 3}));
  CHECK(!journal.add({2, 2, 3}));
  CHECK(journal.has({1, 2, 3}));
}

TEST_CASE("a shard has a journal of its own, and all are read") {
  const TemporaryDirectory directory;
  const std::string output = directory.file("f_%d.png");
  const JournalLine first{1, 2, 3}, second{2, 2, 3};
  CHECK(Journal(output, "1-of-2").add(first));
  CHECK(Journal(output, "2-of-2").add(second));
  CHECK(directory.listing() ==
        std::vector<std::string>{"f_%d.png.1-of-2.journal", "f_%d.png.2-of-2.journal"});
  const Journal journal{output, ""};
  CHECK(journal.has(first));
  CHECK(journal.has(second));
}

TEST_CASE("a journal where nothing can be written is an error before the work") {
  CHECK_THROWS_AS(Journal("/nowhere/f_%d.png", ""), FileError);
}

TEST_CASE("the stamp of files changes with their names, sizes and times") {
  const TemporaryDirectory directory;
  const std::vector<std::filesystem::path> files{directory.file("a"), directory.file("b")};
  const std::uint64_t none = stamp_of(files);
  write_file(files[0].string(), "1");
  const std::uint64_t one = stamp_of(files);
  CHECK(one != none);
  CHECK(stamp_of(files) == one);
  const auto time = std::filesystem::last_write_time(files[0]);
  write_file(files[0].string(), "12");
  std::filesystem::last_write_time(files[0], time);
  const std::uint64_t longer = stamp_of(files);
  CHECK(longer != one);
  std::filesystem::last_write_time(files[0], time + std::chrono::seconds{1});
  CHECK(stamp_of(files) != longer);
  std::filesystem::rename(files[0], files[1]);
  CHECK(stamp_of(files) != longer);
}

TEST_CASE("small frames get a thread each, large ones share the threads out") {
  constexpr std::uint64_t kGigabyte = 1'000'000'000;
  CHECK(frames_at_once(100, 16, 1'000'000, 64 * kGigabyte) == 16);
  CHECK(frames_at_once(3, 16, 1'000'000, 64 * kGigabyte) == 3);
  CHECK(frames_at_once(100, 16, 4 * kGigabyte, 64 * kGigabyte) == 4);
  CHECK(frames_at_once(100, 16, 100 * kGigabyte, 64 * kGigabyte) == 1);
  CHECK(frames_at_once(0, 16, 1, 64 * kGigabyte) == 1);
  CHECK(frames_at_once(100, 16, kGigabyte, 0) == 16);  // nobody knows the memory
}
