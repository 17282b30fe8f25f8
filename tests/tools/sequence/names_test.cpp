#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tests/support/run_program.h"
#include "tools/cli/errors.h"
#include "tools/sequence/frame_names.h"

using namespace softfocus;

namespace {

std::string complaint(const std::string& name) {
  try {
    numbered_name("-o", name);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a number in a name has at least its digits, and comes back from the name") {
  const auto name = numbered_name("-o", "out/f_%04d.exr");
  REQUIRE(name);
  for (const FrameNumber frame : {0, 7, 9999, 10000, 1000000000}) {
    CHECK(frame_named(*name, name_at(*name, frame)) == frame);
  }
  CHECK(name_at(*name, 7) == "out/f_0007.exr");
  CHECK(name_at(*name, 123456) == "out/f_123456.exr");
  CHECK(name_at(*numbered_name("-o", "%d.png"), 12) == "12.png");
  CHECK(name_at(*numbered_name("-o", "100%%_%02d.png"), 3) == "100%_03.png");
}

TEST_CASE("a name that printf would not give is no frame's") {
  const NumberedName name = *numbered_name("-o", "f_%03d.png");
  for (const char* other : {"f_7.png", "f_07.png", "f_0007.png", "f_.png", "f_-07.png", "f_1e3.png",
                            "g_007.png", "f_007.pn", "f_99999999999999999999.png"}) {
    CAPTURE(other);
    CHECK(!frame_named(name, other));
  }
}

TEST_CASE("a name without %d is a name, per cent or not") {
  for (const char* plain : {"a.png", "50% off.png", "100%%.png", "%s.png", "%", "a%4"}) {
    CAPTURE(plain);
    CHECK(!numbered_name("-o", plain));
  }
}

TEST_CASE("numbers in other forms, twice, or in a folder's name are refused") {
  CHECK(complaint("%d_%d.png").find("two numbers") != std::string::npos);
  CHECK(complaint("shot_%02d/a.png").find("folder") != std::string::npos);
  for (const char* form : {"%4d.png", "%00d.png", "%012d.png"}) {
    CAPTURE(form);
    CHECK(complaint(form).find("%d or %01d to %09d") != std::string::npos);
  }
}

TEST_CASE("--frames has both ends, and a step") {
  CHECK(frames_of(parse_frame_range("--frames", "3..5")) == std::vector<FrameNumber>{3, 4, 5});
  CHECK(frames_of(parse_frame_range("--frames", "1..10:4")) == std::vector<FrameNumber>{1, 5, 9});
  CHECK(frames_of(parse_frame_range("--frames", "7")) == std::vector<FrameNumber>{7});
  CHECK(frames_of(parse_frame_range("--frames", "0..999999")).size() == 1000000);
  for (const char* bad : {"", "..", "1..", "..3", "5..3", "1..3:0", "1..3:", "-1..3", "1...3",
                          "a..b", "1..2..3", "1:2", "1:2..3", "0..1000000", "1..3:1.5",
                          "0..1000000001", "99999999999999999999", "1 ..3"}) {
    CAPTURE(bad);
    CHECK_THROWS_AS(parse_frame_range("--frames", bad), UsageError);
  }
}

TEST_CASE("a glob fits whole names") {
  struct Case {
    const char* glob;
    const char* name;
    bool fits;
  };
  for (const Case& of :
       {Case{"*.exr", "a.exr", true}, Case{"*.exr", ".exr", false}, Case{"*.exr", "a.exr2", false},
        Case{"*", "", true}, Case{"a*b*c", "axxbyyc", true}, Case{"a*b*c", "axxbyy", false},
        Case{"a*b*c", "abcbc", true}, Case{"?.png", "a.png", true}, Case{"?.png", ".png", false},
        Case{"[a-c]?", "b1", true}, Case{"[!a-c]?", "b1", false}, Case{"[]]", "]", true},
        Case{"[a", "[a", true}, Case{"[a-]", "-", true}, Case{".*", ".hidden", true},
        Case{"**", "anything", true}, Case{"*a", "aaa", true}}) {
    CAPTURE(of.glob);
    CAPTURE(of.name);
    CHECK(fits_glob(of.glob, of.name) == of.fits);
  }
}

TEST_CASE("the last numbers in which all names differ are the frames") {
  using Numbers = std::vector<FrameNumber>;
  CHECK(numbers_of({"a1.exr", "a2.exr", "a10.exr"}) == Numbers{1, 2, 10});
  CHECK(numbers_of({"s3_0001_4k.exr", "s3_0002_4k.exr"}) == Numbers{1, 2});
  CHECK(numbers_of({"0007.v2.png"}) == Numbers{2});
  CHECK(!numbers_of({"a7.exr", "b7.exr"}));
  CHECK(!numbers_of({"a.exr1"}));
  CHECK(!numbers_of({"a.exr", "a1.exr"}));
  CHECK(!numbers_of({"9999999999999999999.exr"}));
  CHECK(!numbers_of({}));
}

TEST_CASE("a folder's files are listed in the order of their numbers") {
  const TemporaryDirectory directory;
  for (const char* name :
       {"c_2.png", "c_10.png", "c_1.png", "c_1.png.json", "d_3.png", "c_x.png"}) {
    write_file(directory.file(name), "");
  }
  const std::vector<FrameNumber> frames{1, 2, 10};
  const FrameFiles numbered{"COLOUR", directory.file("c_%d.png")};
  CHECK(numbered.many());
  CHECK(numbered.frames() == frames);
  CHECK(numbered.at(10) == directory.file("c_10.png"));
  const FrameFiles glob{"COLOUR", directory.file("c_[0-9]*.png")};
  CHECK(glob.many());
  CHECK(glob.frames() == frames);
  CHECK(glob.at(2) == directory.file("c_2.png"));
  const FrameFiles one{"DEPTH", directory.file("d_3.png")};
  CHECK(!one.many());
  CHECK(one.at(99) == directory.file("d_3.png"));
}

TEST_CASE("a file that has the very name of a pattern is that file") {
  const TemporaryDirectory directory;
  for (const char* name : {"c_%d.png", "c_[1].png"}) {
    write_file(directory.file(name), "");
    CHECK(!FrameFiles("COLOUR", directory.file(name)).many());
  }
}

TEST_CASE("missing files are listed, the first few") {
  const TemporaryDirectory directory;
  write_file(directory.file("c_2.png"), "");
  const FrameFiles files{"COLOUR", directory.file("c_%d.png")};
  std::vector<FrameNumber> wanted;
  for (FrameNumber frame = 1; frame <= 9; ++frame) wanted.push_back(frame);
  try {
    files.check_there(wanted);
    FAIL("nothing is missing");
  } catch (const UsageError& error) {
    CHECK(contains(error.what(), "of 9 frames 8 have no file: " + directory.file("c_1.png") + ", " +
                                     directory.file("c_3.png")));
    CHECK(contains(error.what(), "c_6.png and 3 more"));
  }
  CHECK_THROWS_AS(FrameFiles("COLOUR", directory.file("x*.png")), UsageError);
  CHECK_THROWS_AS(FrameFiles("COLOUR", directory.file("none/x_%d.png")), UsageError);
}
