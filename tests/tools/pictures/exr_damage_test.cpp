// OpenEXR files that are damaged, cut short, or of a kind that is not read.

#include <ImfChannelList.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfHeader.h>
#include <ImfPartType.h>
#include <doctest/doctest.h>

#include "raster/images/image.h"
#include "tests/support/run_program.h"
#include "tools/cli/errors.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/picture_file.h"

using namespace softfocus;

namespace {

std::string refusal(const std::string& name) {
  try {
    const PictureFile file = open_picture_file(name);
    const std::size_t first = 0;
    read_planes(file, {&first, 1}, 0.0f);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("EXR: a deep picture is refused by its name") {
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  {
    Imf::Header header{12, 9};
    header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    const Imf::DeepScanLineOutputFile file{name.c_str(), header};
  }
  CHECK(contains(refusal(name), "deep"));
  CHECK(contains(refusal(name), "oiiotool --flatten"));
}

TEST_CASE("EXR: a file cut short anywhere is refused") {
  Image image = make_image(Format::rgba16f, 8, 40);
  const Bytes whole = encode_exr(image, ExrNumbers::half, "");
  const TemporaryDirectory directory;
  for (std::size_t length = 4; length + 1 < whole.size(); length += 7) {
    CAPTURE(length);
    const std::string_view text{reinterpret_cast<const char*>(whole.data()), length};
    write_file(directory.file("a.exr"), text);
    CHECK(refusal(directory.file("a.exr")) != "");
  }
}

TEST_CASE("bad input: an EXR's header that claims 2 GB is refused before room is made for them") {
  const Bytes whole = encode_exr(make_image(Format::rgba16f, 5, 9), ExrNumbers::half, "");
  const std::string all{reinterpret_cast<const char*>(whole.data()), whole.size()};
  const std::string most = "\xFF\xFF\xFF\x7F";
  const TemporaryDirectory directory;
  const std::string name = directory.file("a.exr");
  const auto refused = [&](const std::string& attribute) {
    write_file(name, all.substr(0, 8) + attribute + all.substr(8));  // behind magic and version
    return refusal(name);
  };
  using namespace std::string_literals;
  for (const std::string& type : {"string"s, "floatvector"s, "stringvector"s, "opaque"s}) {
    CAPTURE(type);
    std::string attribute = "big\0"s;
    attribute.append(type).append(1, '\0').append(most);
    CHECK(contains(refused(attribute), "claims a value of 2147483647 bytes"));
  }
  // A string within a vector, of a size that fits.
  const std::string vector = "big\0stringvector\0\x08\0\0\0"s;
  CHECK(contains(refused(vector + most + "text"), "claims a value of 2147483647 bytes"));
  CHECK(contains(refused(vector + "\xFF\xFF\xFF\xFFtext"), "claims a value of -1 bytes"));
  CHECK_FALSE(contains(refused(vector + "\4\0\0\0text"s), "claims"));
  // Values of types that the library reads whatever their size: what it takes for the next
  // attribute lies within them, or they within it.
  const std::string hidden = "big\0opaque\0"s + most;
  const std::string shown = "of another\0box2i\0"s;
  CHECK(contains(refused(shown + "\x20\0\0\0"s + std::string(16, '\0') + hidden), "another size"));
  CHECK(contains(refused(shown + "\x04\0\0\0text"s), "another size"));
  const std::string channels = "others\0chlist\0"s;
  CHECK(contains(refused(channels + "\x11\0\0\0\0"s + hidden), "another size"));
  CHECK(contains(refused("small\0preview\0\x08\0\0\0\xFF\xFF\0\0\xFF\xFF\0\0"s), "another size"));
  CHECK_FALSE(contains(refused("small\0preview\0\x0C\0\0\0\1\0\0\0\1\0\0\0rgba"s), "size"));
}

TEST_CASE("EXR: any changed byte is refused or gives a picture") {
  Image image = make_image(Format::rgba16f, 5, 9);
  const Bytes whole = encode_exr(image, ExrNumbers::half, "{}");
  int pictures = 0, refusals = 0;
  for (std::size_t i = 4; i < whole.size(); ++i) {
    for (const std::byte change : {std::byte{0x01}, std::byte{0x80}, std::byte{0xFF}}) {
      CAPTURE(i);
      Bytes damaged = whole;
      damaged[i] ^= change;
      try {
        const PictureFile file = open_picture_file(std::move(damaged), "a.exr");
        for (std::size_t plane = 0; plane < file.planes.size(); ++plane) {
          read_planes(file, {&plane, 1}, 0.0f);
        }
        ++pictures;
      } catch (const FileError&) {
        ++refusals;
      }
    }
  }
  CHECK(pictures > 0);
  CHECK(refusals > pictures);
}
