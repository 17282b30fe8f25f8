// The atlas's record of a trial, and when it is still right.

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/support/run_program.h"
#include "tools/report/kept_results.h"
#include "tools/stress/trial_record.h"

using namespace softfocus;

TEST_CASE("stress record: kept under a key and a hash, it is found under no other") {
  const TemporaryDirectory directory;
  const std::filesystem::path file = directory.file("trial.json");
  KeptResults record{file, "key"};
  record.keep("two-pass", "0x1", "value", 0.25);
  record.keep("two-pass", "0x1", "picture", "PNG");
  record.keep("layers", "0x2", "value", number_or_null(std::nan("")));
  record.save();

  const KeptResults again{file, "key"};
  CHECK(again.number("two-pass", "0x1", "value") == 0.25);
  CHECK(again.text("two-pass", "0x1", "picture") == "PNG");
  CHECK(again.number("layers", "0x2", "value") == std::numeric_limits<double>::infinity());
  CHECK_FALSE(again.number("two-pass", "0x3", "value"));  // another picture
  CHECK_FALSE(again.number("two-pass", "0x1", "other"));
  CHECK_FALSE(again.number("scatter", "0x1", "value"));
  CHECK_FALSE(again.number("two-pass", "0x1", "picture"));  // damaged: no number
  CHECK_FALSE(KeptResults{file, "another key"}.number("two-pass", "0x1", "value"));
}

TEST_CASE("stress record: another picture of a method takes the place of all that was kept") {
  const TemporaryDirectory directory;
  KeptResults record{directory.file("trial.json"), "key"};
  record.keep("two-pass", "0x1", "value", 0.25);
  record.keep("two-pass", "0x2", "other value", 0.5);
  CHECK_FALSE(record.number("two-pass", "0x1", "value"));
  CHECK_FALSE(record.number("two-pass", "0x2", "value"));
  CHECK(record.number("two-pass", "0x2", "other value") == 0.5);
}

TEST_CASE("stress record: a damaged file counts as none") {
  const TemporaryDirectory directory;
  for (const char* text : {"", "{", "[1]", "{\"key\": 3}", "{\"key\": \"key\", \"two-pass\": 3}"}) {
    write_file(directory.file("trial.json"), text);
    KeptResults record{directory.file("trial.json"), "key"};
    CHECK_FALSE(record.number("two-pass", "0x1", "value"));
    record.keep("two-pass", "0x1", "value", 1.0);
    CHECK(record.number("two-pass", "0x1", "value") == 1.0);
  }
}

TEST_CASE("stress record: the key tells severity, size, views and every pixel of the input") {
  ThreadPool pool{2};
  const StressCase& of = edge_cases()[0];
  const StressTrial trial = of.make(4, 64, pool);
  const std::string key = trial_key(of, 4, trial, 0, pool);
  CHECK(trial_key(of, 4, of.make(4, 64, pool), 0, pool) == key);
  CHECK(trial_key(of, std::nextafter(4.0, 5.0), trial, 0, pool) != key);
  CHECK(trial_key(of, 4, trial, 16, pool) != key);
  CHECK(trial_key(edge_cases()[1], 4, trial, 0, pool) != key);
  CHECK(trial_key(of, 4, of.make(4, 80, pool), 0, pool) != key);
  StressTrial changed = of.make(4, 64, pool);
  changed.frames[0].sharp.bytes[5] ^= std::byte{1};
  CHECK(trial_key(of, 4, changed, 0, pool) != key);
  changed = of.make(4, 64, pool);
  changed.frames[0].truth.bytes[5] ^= std::byte{1};
  CHECK(trial_key(of, 4, changed, 0, pool) != key);
  changed = of.make(4, 64, pool);
  changed.frames[0].settings.max_coc_px += 1.0f;
  CHECK(trial_key(of, 4, changed, 0, pool) != key);
}

TEST_CASE("stress record: the key tells what the measure gives for a wrong answer") {
  ThreadPool pool{2};
  const StressCase& of = edge_cases()[0];
  const StressTrial trial = of.make(4, 64, pool);
  StressCase changed = of;
  changed.measure = [](const StressAnswer& answer) {
    // The right answer would not tell one measure from another.
    return answer.result[0].bytes == answer.truth[0].bytes ? 0.0 : 0.5;
  };
  CHECK(trial_key(changed, 4, trial, 0, pool) != trial_key(of, 4, trial, 0, pool));
}
