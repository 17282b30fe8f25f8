// The operation for GEGL against the program, run by `gegl` as GIMP's users install it.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/run_program.h"
#include "tests/support/skip.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;

#ifdef SOFTFOCUS_GEGL_OPERATION
namespace {

constexpr int kSide = 40;

/// Bytes of numbers as this little-endian machine has them, for those of TIFF and PFM.
template <class Number>
void append(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// An uncompressed TIFF of floats, 1 or 3 a pixel, which GEGL reads.
void write_tiff(const std::string& name, int width, int height, const std::vector<float>& values) {
  const auto channels =
      static_cast<std::uint32_t>(values.size()) / static_cast<std::uint32_t>(width * height);
  constexpr std::uint32_t kTags = 8, kFirst = 8 + 2 + 12 * kTags + 4;
  std::string bytes{"II*\0", 4};
  append<std::uint32_t>(bytes, 8);
  append<std::uint16_t>(bytes, kTags);
  const auto tag = [&](std::uint16_t id, std::uint16_t type, std::uint32_t value,
                       std::uint32_t count = 1) {
    append(bytes, id);
    append(bytes, type);
    append(bytes, count);
    append(bytes, value);
  };
  constexpr std::uint16_t kShort = 3, kLong = 4;
  const std::uint32_t size = static_cast<std::uint32_t>(values.size() * sizeof(float));
  tag(256, kLong, static_cast<std::uint32_t>(width));
  tag(257, kLong, static_cast<std::uint32_t>(height));
  tag(258, kShort, channels == 1 ? 32 : kFirst + size, channels);  // bits
  tag(262, kShort, channels == 1 ? 1 : 2);                         // grey, RGB
  tag(273, kLong, kFirst);
  tag(277, kShort, channels);
  tag(279, kLong, size);
  tag(339, kShort, channels == 1 ? 3 : kFirst + size + 6, channels);  // floats
  append<std::uint32_t>(bytes, 0);
  for (const float value : values) append(bytes, value);
  for (const int number : {32, 32, 32, 3, 3, 3}) append(bytes, static_cast<std::uint16_t>(number));
  write_file(name, bytes);
}

/// The same as PFM, which the program reads in every build.
void write_pfm(const std::string& name, int width, int height, const std::vector<float>& values) {
  const std::size_t row = values.size() / static_cast<std::size_t>(height);
  std::string bytes = (row == static_cast<std::size_t>(width) ? "Pf\n" : "PF\n") +
                      std::to_string(width) + ' ' + std::to_string(height) + "\n-1.0\n";
  for (std::size_t y = static_cast<std::size_t>(height); y-- > 0;) {
    for (std::size_t i = 0; i < row; ++i) append(bytes, values[y * row + i]);
  }
  write_file(name, bytes);
}

/// A picture and its depth in a folder, and GEGL with the operation.
class Gegl {
 public:
  Gegl() {
    const std::string plug_ins = file("gegl-0.4/plug-ins");
    std::filesystem::create_directories(plug_ins);
    std::filesystem::copy(SOFTFOCUS_GEGL_OPERATION, plug_ins);
    std::uint32_t state = 1;
    const auto random = [&] {
      return static_cast<float>((state = state * 1664525 + 1013904223) >> 8) / 16777216.0f;
    };
    std::vector<float> colour(3 * kSide * kSide), depth;
    for (float& value : colour) value = random();
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        depth.push_back(x < y ? 1.5f : 2.0f + 0.1f * static_cast<float>(y));
    }
    write_tiff(file("c.tif"), kSide, kSide, colour);
    write_pfm(file("c.pfm"), kSide, kSide, colour);
    write_depth(kSide, kSide, depth);
  }

  void write_depth(int width, int height, const std::vector<float>& depth) const {
    write_tiff(file("d.tif"), width, height, depth);
    write_pfm(file("d.pfm"), width, height, depth);
  }

  std::string file(const std::string& name) const { return folder_.file(name); }

  /// The floats of what a chain of operations gives of the picture; what it says is in said().
  std::vector<PlaneValues> result(const std::string& operations) const {
    const std::string out = file("gegl.npy");
    std::filesystem::remove(out);
    // Its reader takes the floats of a TIFF for sRGB's codes.
    const std::string command =
        "XDG_DATA_HOME=" + folder_.path() + " XDG_CACHE_HOME=" + folder_.path() +
        " timeout 100 gegl -- gegl:tiff-load path=" + file("c.tif") +
        " gegl:cast-format input-format=\"R'G'B' float\" output-format='RGB float' " + operations +
        " gegl:npy-save path=" + out + " >" + file("said") + " 2>&1";
    CHECK(std::system(command.c_str()) == 0);
    return planes(out);
  }
  std::string said() const { return read_file(file("said")); }

  std::string refocus(const std::string& options) const {
    return "softfocus:refocus " + options + " aux=[ gegl:tiff-load path=" + file("d.tif") + " ]";
  }

  std::vector<PlaneValues> by_program(const std::vector<std::string>& options) const {
    const std::string out = file("ours.npy");
    std::vector<std::string> words{"refocus", "-q", file("c.pfm"), file("d.pfm"), "-o", out};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramRun run = run_program(words);
    CHECK(run.err == "");
    CHECK(run.status == 0);
    return planes(out);
  }

 private:
  static std::vector<PlaneValues> planes(const std::string& name) {
    const PictureFile read = open_picture_file(name);
    constexpr std::array<std::size_t, 3> kColours{0, 1, 2};
    return read_planes(read, kColours, 0.0f);
  }

  TemporaryDirectory folder_;
};

bool has_gegl() { return std::system("command -v gegl >/dev/null") == 0; }

/// A part of planes, as gegl:crop takes it.
std::vector<PlaneValues> cropped(const std::vector<PlaneValues>& planes, int x, int y, int width,
                                 int height) {
  std::vector<PlaneValues> parts;
  for (const PlaneValues& plane : planes) {
    PlaneValues& part = parts.emplace_back();
    for (int row = y; row < y + height; ++row) {
      const auto from = plane.begin() + row * kSide + x;
      part.insert(part.end(), from, from + width);
    }
  }
  return parts;
}

}  // namespace
#endif

TEST_CASE("softfocus:refocus in GEGL gives what the program writes, to the bit") {
#ifdef SOFTFOCUS_GEGL_OPERATION
  if (!has_gegl()) return skip("gegl", "no program gegl");
  const Gegl gegl;
  struct Pair {
    const char* properties;
    std::vector<std::string> options;
  };
  for (const Pair& pair :
       {Pair{"depth-encoding=metres", {"--depth-encoding", "metres"}},
        Pair{"depth-encoding=metres method=two-pass focus=2.5 f-number=1.4 fov=30 coc-scale=9",
             {"--depth-encoding", "metres", "--method", "two-pass", "--focus", "2.5", "--f-number",
              "1.4", "--fov", "30", "--coc-scale", "9"}},
        Pair{"depth-encoding=inverse scale=0.3 method=scatter-aperture focus-x=0.1 focus-y=0.9 "
             "blur-at-infinity=7 aperture-blades=5 aperture-turn=20 anamorphic=1.5",
             {"--depth-encoding", "inverse", "--scale", "0.3", "--method", "scatter-aperture",
              "--focus-at", "4,36", "--blur-at-infinity", "7", "--aperture-blades", "5",
              "--aperture-turn", "20", "--anamorphic", "1.5"}},
        Pair{"near=0.5 far=9 method=auto max-error=0.01 focal-length=85 sensor-width=23.5 "
             "sensor-height=15.7 mend-edges=true max-coc=3",
             {"--depth-encoding", "midas", "--near", "0.5", "--far", "9", "--method", "auto",
              "--max-error", "0.01", "--focal-length", "85", "--sensor", "23.5x15.7mm",
              "--mend-edges", "--max-coc", "3"}}}) {
    CAPTURE(pair.properties);
    const auto theirs = gegl.result(gegl.refocus(pair.properties));
    CHECK(theirs == gegl.by_program(pair.options));
    CHECK(theirs != gegl.result(""));
    CHECK(!contains(gegl.said(), "softfocus"));
  }
#else
  skip("", "a build without GEGL's operation");
#endif
}

TEST_CASE("softfocus:refocus in GEGL: a region has the bits of the whole picture") {
#ifdef SOFTFOCUS_GEGL_OPERATION
  if (!has_gegl()) return skip("gegl", "no program gegl");
  const Gegl gegl;
  const std::string refocus = gegl.refocus("depth-encoding=metres blur-at-infinity=9");
  CHECK(gegl.result(refocus + " gegl:crop x=11 y=17 width=8 height=5 gegl:translate x=-11 y=-17") ==
        cropped(gegl.result(refocus), 11, 17, 8, 5));
#else
  skip("", "a build without GEGL's operation");
#endif
}

TEST_CASE("softfocus:refocus in GEGL: without a depth, and with a bad one, the picture stays") {
#ifdef SOFTFOCUS_GEGL_OPERATION
  if (!has_gegl()) return skip("gegl", "no program gegl");
  const Gegl gegl;
  const auto sharp = gegl.result("");
  CHECK(gegl.result("softfocus:refocus") == sharp);
  CHECK(!contains(gegl.said(), "softfocus"));
  CHECK(gegl.result(gegl.refocus("near=3 far=2")) == sharp);
  CHECK(contains(gegl.said(), "near must be less than far"));
  CHECK(gegl.result(gegl.refocus("depth-encoding=metres focus=0.01")) == sharp);
  CHECK(contains(gegl.said(), "softfocus:refocus: "));
  CHECK(gegl.result(gegl.refocus("depth-encoding=metres scale=-1")) == sharp);
  CHECK(contains(gegl.said(), "no number that is a distance"));
  const std::string side = std::to_string(kSide);
  // Nothing to refocus, and no end of it.
  CHECK(gegl.result("gegl:over aux=[ " + gegl.refocus("") + " ] gegl:crop width=" + side +
                    " height=" + side) == sharp);
  const std::string plane = "gegl:over aux=[ gegl:color value=red ",
                    corner = " gegl:crop width=5 height=5 ]";
  CHECK(gegl.result(plane + "softfocus:refocus aux=[ gegl:color ]" + corner) ==
        gegl.result(plane + corner));
#else
  skip("", "a build without GEGL's operation");
#endif
}

TEST_CASE("softfocus:refocus in GEGL: beside a smaller depth its border repeats") {
#ifdef SOFTFOCUS_GEGL_OPERATION
  if (!has_gegl()) return skip("gegl", "no program gegl");
  const Gegl gegl;
  constexpr int kWidth = 23, kHeight = 31;
  const auto depth_at = [](int x, int y) { return 1.0f + 0.1f * static_cast<float>(x + y); };
  std::vector<float> small, whole;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) small.push_back(depth_at(x, y));
  }
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      whole.push_back(depth_at(std::min(x, kWidth - 1), std::min(y, kHeight - 1)));
    }
  }
  const std::string refocus = gegl.refocus("depth-encoding=metres blur-at-infinity=9");
  gegl.write_depth(kWidth, kHeight, small);
  const auto beside = gegl.result(refocus);
  gegl.write_depth(kSide, kSide, whole);
  CHECK(beside == gegl.result(refocus));
#else
  skip("", "a build without GEGL's operation");
#endif
}
