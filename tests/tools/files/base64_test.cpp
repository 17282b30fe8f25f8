#include "tools/files/base64.h"

#include <doctest/doctest.h>

#include <string_view>

using namespace softfocus;

namespace {

std::string of(std::string_view text) {
  return base64(std::as_bytes(std::span{text.data(), text.size()}));
}

}  // namespace

TEST_CASE("base64: the examples of RFC 4648, section 10") {
  CHECK(of("") == "");
  CHECK(of("f") == "Zg==");
  CHECK(of("fo") == "Zm8=");
  CHECK(of("foo") == "Zm9v");
  CHECK(of("foob") == "Zm9vYg==");
  CHECK(of("fooba") == "Zm9vYmE=");
  CHECK(of("foobar") == "Zm9vYmFy");
}

TEST_CASE("base64: bytes with their highest bit set") {
  CHECK(of("\xFF\xEF\xBE") == "/+++");
  CHECK(of(std::string_view{"\x00\x00\x00", 3}) == "AAAA");
}
