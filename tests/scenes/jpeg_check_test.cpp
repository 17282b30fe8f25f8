#include "scenes/files/picture_check.h"

#include <doctest/doctest.h>

#include <string>

using namespace softfocus;

namespace {

std::string segment(unsigned char marker, const std::string& body) {
  const std::size_t length = body.size() + 2;
  return std::string{'\xFF', static_cast<char>(marker), static_cast<char>(length >> 8),
                     static_cast<char>(length & 0xFF)} +
         body;
}

// One table whose 16 counts are as given, with its values.
std::string huffman_table(std::size_t codes) {
  std::string body(1, '\0');
  std::size_t left = codes;
  for (int i = 0; i < 16; ++i) {
    const std::size_t here = left < 255 ? left : 255;
    body += static_cast<char>(here);
    left -= here;
  }
  return body + std::string(codes, '\x7F');
}

const std::string kStart = "\xFF\xD8";
const std::string kFrame = segment(0xC0, std::string(15, '\1'));

}  // namespace

TEST_CASE("a Huffman table of 256 codes is full and one of 257 overfull") {
  CHECK_FALSE(has_overfull_huffman_table(kStart + segment(0xC4, huffman_table(256)) + kFrame));
  CHECK(has_overfull_huffman_table(kStart + segment(0xC4, huffman_table(257)) + kFrame));
}

TEST_CASE("an overfull Huffman table is found as the second of a segment and behind a frame") {
  const std::string two = segment(0xC4, huffman_table(12) + huffman_table(300));
  CHECK(has_overfull_huffman_table(kStart + two + kFrame));
  CHECK(has_overfull_huffman_table(kStart + kFrame + "scan data" + two));
  CHECK(has_overfull_huffman_table(kStart + "junk" + two + kFrame));
}

TEST_CASE("what looks like a Huffman table inside a thumbnail is none") {
  const std::string inside = segment(0xE1, segment(0xC4, huffman_table(300)));
  CHECK_FALSE(has_overfull_huffman_table(kStart + inside + kFrame));
}

TEST_CASE("a Huffman table that ends with the file is read as stb_image reads it") {
  const std::string whole = kStart + segment(0xC4, huffman_table(300));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    // The counts add up to more than 256 once the second of them is there.
    CHECK(has_overfull_huffman_table(whole.substr(0, length)) == (length >= 9));
  }
}

TEST_CASE("a JPEG without its end marker is cut") {
  CHECK(is_cut_jpeg(kStart + kFrame));
  CHECK(is_cut_jpeg(kStart + kFrame + "\xFF\xDA scan"));
  CHECK_FALSE(is_cut_jpeg(kStart + kFrame + "\xFF\xDA scan\xFF\xD9"));
  CHECK_FALSE(is_cut_jpeg("\x89PNG"));
}

TEST_CASE("a scan needs the Huffman tables that it names, and those before it alone") {
  // Two components, tables 0 and 1 of each class; then where the coefficients begin and end.
  const auto scan = [](const std::string& coefficients) {
    return segment(0xDA, std::string{2, 1, 0, 2, 0x11} + coefficients) +
           std::string("data\xFF\0more", 10);
  };
  const std::string whole = scan(std::string("\x00\x3F\x00", 3));
  const auto tables = [](const std::string& numbers) {
    std::string body;
    for (const char number : numbers) {
      body += number;
      body += huffman_table(3).substr(1);
    }
    return segment(0xC4, body);
  };
  const std::string all = tables(std::string("\x00\x01\x10\x11", 4)), frame = kStart + kFrame;
  CHECK_FALSE(lacks_huffman_table(frame + all + whole));
  CHECK_FALSE(lacks_huffman_table(frame + all + whole + "\xFF\xD3" + whole));
  CHECK(lacks_huffman_table(frame + whole + all));
  const auto lacks_with = [&](const std::string& given) {
    return lacks_huffman_table(frame + given + whole);
  };
  for (const char* three : {"\x01\x10\x11", "\x02\x01\x10\x11", "\x03\x10\x11\x01"}) {
    CHECK(lacks_with(tables(three)));
  }
  CHECK(lacks_huffman_table(frame + tables(std::string("\x00\x01\x10\x12", 4)) + whole));
  // Progressive: the first coefficient apart, once and again to refine it, and the others.
  const std::string progressive = kStart + segment(0xC2, std::string(15, '\1'));
  const std::string first = scan(std::string("\x00\x00\x01", 3));
  const std::string refined = scan(std::string("\x00\x00\x10", 3)), others = scan("\1\5\1");
  CHECK_FALSE(lacks_huffman_table(progressive + tables(std::string("\x00\x01", 2)) + first));
  CHECK(lacks_huffman_table(progressive + tables("\x10\x11") + first));
  CHECK_FALSE(lacks_huffman_table(progressive + refined));
  CHECK_FALSE(lacks_huffman_table(progressive + tables("\x10\x11") + others));
  CHECK(lacks_huffman_table(progressive + tables(std::string("\x00\x01", 2)) + others));
}
