// softfocus refocus: the depth that phones put into a JPEG.

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/cli_refused.h"
#include "tools/files/base64.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_file.h"
#include "tools/refocus/depth/phone_depth.h"

using namespace softfocus;
using nlohmann::json;

namespace {

std::string segment(char marker, const std::string& data) {
  const std::size_t length = data.size() + 2;
  return std::string{'\xFF', marker, static_cast<char>(length >> 8), static_cast<char>(length)} +
         data;
}

const std::string kXmp{"http://ns.adobe.com/xap/1.0/\0", 29};
const std::string kExtension{"http://ns.adobe.com/xmp/extension/\0", 35};

std::string xmp(const std::string& attributes) {
  return segment('\xE1', kXmp + "<x:xmpmeta><rdf:Description " + attributes + "/></x:xmpmeta>");
}

/// The test's JPEG of 16x8 pixels with segments behind its start.
std::string jpeg_with(const std::string& segments) {
  const std::string jpeg = text_of(read_picture_bytes(SOFTFOCUS_TEST_DATA "/red-blue-16x8.jpg"));
  return jpeg.substr(0, 2) + segments + jpeg.substr(2);
}

/// A grey JPEG of 16x8 pixels: 28 on the left, 228 on the right.
std::string grey_jpeg(const std::string& segments) {
  const std::string ones(64, '\1');
  const std::string lengths(14, '\0');
  return "\xFF\xD8" + segments + segment('\xDB', '\0' + ones) +
         segment('\xC0', std::string{"\x08\0\x08\0\x10\1\1\x11\0", 9}) +
         segment('\xC4', std::string{"\0\0\2", 3} + lengths + "\x0A\x0B") +
         segment('\xC4', std::string{"\x10\1\0", 3} + lengths + std::string(1, '\0')) +
         segment('\xDA', std::string{"\1\1\0\0\x3F\0", 6}) + "\x0D\xF3\x90\x1F\xFF\xD9";
}

/// A map of 16x8 codes, left and right, as the text of a PNG in base64.
std::string map_text(std::uint16_t left, std::uint16_t right) {
  std::vector<std::uint16_t> codes(128);
  int i = 0;
  for (std::uint16_t& code : codes) code = i++ % 16 < 8 ? left : right;
  return base64(encode_grey_png_16(codes, 16, 8));
}

std::optional<PhoneDepth> found_in(const std::string& jpeg) {
  return find_phone_depth(std::as_bytes(std::span{jpeg}));
}

json refocused(const std::string& jpeg, std::vector<std::string> more = {}) {
  const TemporaryDirectory directory;
  write_file(directory.file("a.jpg"), jpeg);
  more.insert(more.begin(),
              {"refocus", directory.file("a.jpg"), "-o", directory.file("o.npy"), "--json"});
  const ProgramRun run = run_program(more);
  CAPTURE(run.err);
  REQUIRE(run.status == 0);
  return json::parse(run.out);
}

const std::string kRange = "GDepth:Format=\"RangeInverse\" GDepth:Near=\"1.5\" GDepth:Far=\"6\" ";

}  // namespace

TEST_CASE("phone: GDepth in XMP is read, with its format, near and far") {
  const std::string data = "GDepth:Data='" + map_text(0, 65535) + "'";
  const json report = refocused(jpeg_with(xmp(kRange + data)));
  CHECK(report["depth_encoding"] == "gdepth-inverse");
  CHECK(report["nearest_m"].get<double>() == doctest::Approx(1.5));
  CHECK(report["farthest_m"].get<double>() == doctest::Approx(6.0));
  CHECK(report["depth_believed"] == "the file says so");
  const auto linear = found_in(jpeg_with(
      segment('\xE1', kXmp +
                          "<GDepth:Format>RangeLinear</GDepth:Format><GDepth:Near>500"
                          "</GDepth:Near><GDepth:Far>4000</GDepth:Far><GDepth:Units>mm"
                          "</GDepth:Units><GDepth:MeasureType>OpticRay</GDepth:MeasureType>"
                          "<GDepth:Data>" +
                          map_text(0, 1) + "</GDepth:Data>")));
  REQUIRE(linear);
  CHECK(linear->encoding == find_depth_encoding("gdepth-linear"));
  CHECK(linear->numbers.near_m == 0.5);
  CHECK(linear->numbers.far_m == 4.0);
  CHECK(linear->along == DepthAlong::ray);
}

TEST_CASE("phone: options overrule what the file says") {
  const std::string jpeg = jpeg_with(xmp(kRange + "GDepth:Data='" + map_text(0, 65535) + "'"));
  CHECK(refocused(jpeg, {"--far", "12m"})["farthest_m"].get<double>() == doctest::Approx(12.0));
  const json said =
      refocused(jpeg, {"--depth-encoding", "white-near", "--near", "1", "--far", "2"});
  CHECK(said["depth_encoding"] == "white-near");
  CHECK(said["farthest_m"] == 2.0);
}

TEST_CASE("phone: GDepth in extended XMP is put together from its segments") {
  const std::string data = "<rdf:Description GDepth:Data=\"" + map_text(0, 65535) + "\"/>";
  std::string segments = xmp(kRange);
  const auto number = [](std::size_t value) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  for (std::size_t at = 0; at < data.size(); at += 50) {
    segments += segment('\xE1', kExtension + std::string(32, 'A') + number(data.size()) +
                                    number(at) + data.substr(at, 50));
  }
  CHECK(refocused(jpeg_with(segments))["farthest_m"].get<double>() == doctest::Approx(6.0));
}

TEST_CASE("phone: a map behind the picture is found by what is said of it, or by being grey") {
  const std::string plain = jpeg_with("");
  CHECK_FALSE(found_in(plain));
  CHECK_FALSE(found_in(plain + plain));  // a preview
  const json report = refocused(jpeg_with(xmp(kRange)) + grey_jpeg(""));
  CHECK(report["nearest_m"].get<double>() == doctest::Approx(1.635).epsilon(0.01));
  CHECK(report["farthest_m"].get<double>() == doctest::Approx(4.554).epsilon(0.01));
  const auto unsaid = found_in(plain + grey_jpeg(""));
  REQUIRE(unsaid);
  CHECK(unsaid->encoding == nullptr);
  const std::string gain = grey_jpeg(xmp("hdrgm:Version=\"1.0\""));
  CHECK_FALSE(found_in(plain + gain));
  CHECK(text_of(found_in(plain + gain + grey_jpeg(""))->file) == grey_jpeg(""));
  const std::string said = grey_jpeg(xmp("a:Type=\"aux:disparity\""));
  CHECK(text_of(found_in(plain + plain + grey_jpeg("") + said)->file) == said);
}

TEST_CASE("phone: Apple's disparity stands for the floats that its file names") {
  const std::string map = grey_jpeg(
      xmp("apdi:AuxiliaryImageType=\"disparity\" apdi:IntMinValue=\"28\" apdi:IntMaxValue=\"228\" "
          "apdi:FloatMinValue=\"0.25\" apdi:FloatMaxValue=\"2\""));
  const json report = refocused(jpeg_with("") + map);
  CHECK(report["depth_encoding"] == "inverse");
  CHECK(report["nearest_m"].get<double>() == doctest::Approx(0.5));
  CHECK(report["farthest_m"].get<double>() == doctest::Approx(4.0));
}

TEST_CASE("phone: the depth is turned as its picture is") {
  const std::string exif{"Exif\0\0MM\0*\0\0\0\x08\0\1\1\x12\0\3\0\0\0\1\0\6\0\0\0\0\0\0", 32};
  const json report = refocused(jpeg_with(segment('\xE1', exif) + xmp(kRange)) + grey_jpeg(""));
  CHECK(report["width"] == 8);
  CHECK(report["height"] == 16);
  CHECK(report["farthest_m"].get<double>() == doctest::Approx(4.554).epsilon(0.01));
}

TEST_CASE("phone: files cut short anywhere have no depth, or this one") {
  const std::string whole = jpeg_with(xmp(kRange)) + grey_jpeg("");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const auto depth = found_in(whole.substr(0, length));
    if (depth) CHECK(text_of(depth->file) == grey_jpeg(""));
  }
}

TEST_CASE("phone: inspect shows the picture and its depth") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.jpg"), jpeg_with(xmp(kRange)) + grey_jpeg(""));
  const ProgramRun run = run_program({"inspect", directory.file("a.jpg")});
  CHECK(run.status == 0);
  CHECK(contains(run.out, "a.jpg, its depth: JPEG, 16x8"));
  CHECK(contains(run.out, "read as gdepth-inverse"));
}
