#include "tools/pictures/png_text.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

constexpr std::size_t kFrame = 12;  // of a chunk: length, type, CRC
constexpr std::size_t kPngHeaderEnd = 8 + kFrame + 13;
constexpr std::uint32_t kIhdr = 0x49484452, kIend = 0x49454E44;

constexpr std::array<std::uint32_t, 256> kCrcOfByte = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1u) != 0 ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
    table[byte] = crc;
  }
  return table;
}();

/// CRC-32 of ISO 3309, as the PNG specification's annex D gives it.
std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const std::byte byte : bytes) {
    crc = crc >> 8 ^ kCrcOfByte[(crc ^ std::to_integer<std::uint32_t>(byte)) & 0xFFu];
  }
  return ~crc;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void append(std::vector<std::byte>& bytes, std::string_view text) {
  const auto more = std::as_bytes(std::span{text.data(), text.size()});
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void append_big_endian(std::vector<std::byte>& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<std::byte>(value >> shift & 0xFFu));
  }
}

/// The keyword, and behind its zero what remains; nullopt without a zero.
struct Keyed {
  std::string_view keyword, rest;
};
std::optional<Keyed> split_at_zero(std::string_view data) {
  const std::size_t zero = data.find('\0');
  if (zero == data.npos) return std::nullopt;
  return Keyed{data.substr(0, zero), data.substr(zero + 1)};
}

/// The text of an iTXt, behind the keyword: a flag and a method of compression, a language and
/// the keyword translated, each with a zero at its end.
std::optional<std::string_view> international_text(std::string_view rest) {
  if (rest.size() < 2 || rest[0] != '\0') return std::nullopt;
  const auto language = split_at_zero(rest.substr(2));
  if (!language) return std::nullopt;
  const auto translated = split_at_zero(language->rest);
  if (!translated) return std::nullopt;
  return translated->rest;
}

}  // namespace

void append_png_chunk(std::vector<std::byte>& bytes, std::string_view type, std::string_view data) {
  append_big_endian(bytes, static_cast<std::uint32_t>(data.size()));
  const std::size_t start = bytes.size();
  append(bytes, type);
  append(bytes, data);
  append_big_endian(bytes, crc32(std::span{bytes}.subspan(start)));
}

bool is_png(std::span<const std::byte> bytes) { return text_of(bytes).starts_with("\x89PNG"); }

void check_png_chunks(std::span<const std::byte> png) {
  const FileError truncated{"the PNG is cut short"};
  if (png.size() < kPngSignature.size()) throw truncated;
  for (auto rest = png.subspan(kPngSignature.size());;) {
    if (rest.size() < kFrame) throw truncated;
    const std::size_t length = big_endian<std::uint32_t>(rest);
    if (rest.size() - kFrame < length) throw truncated;
    const auto type_and_data = rest.subspan(4, 4 + length);
    if (crc32(type_and_data) != big_endian<std::uint32_t>(rest.subspan(8 + length))) {
      throw FileError("the PNG is damaged: a checksum is wrong");
    }
    // stb would call a large one of no known type.
    if (big_endian<std::uint32_t>(type_and_data) == kIhdr && length >= 8) {
      const auto sides = type_and_data.subspan(4);
      check_picture_size("the PNG", big_endian<std::uint32_t>(sides),
                         big_endian<std::uint32_t>(sides.subspan(4)));
    }
    rest = rest.subspan(kFrame + length);
    if (big_endian<std::uint32_t>(type_and_data) != kIend) continue;
    if (!rest.empty()) throw FileError("the PNG goes on after its end");
    return;
  }
}

bool has_transparent_colour(std::span<const std::byte> png) {
  constexpr std::size_t kColourTypeAt = 8 + 8 + 9;  // behind the signature and IHDR's frame
  if (png.size() <= kColourTypeAt) return false;
  const std::byte colour_type = png[kColourTypeAt];
  if (colour_type != std::byte{0} && colour_type != std::byte{2}) return false;
  for (auto rest = png.subspan(kPngSignature.size()); rest.size() >= kFrame;) {
    const std::string_view type = text_of(rest.subspan(4, 4));
    if (type == "tRNS") return true;
    if (type == "IDAT") return false;
    rest = rest.subspan(kFrame + big_endian<std::uint32_t>(rest));
  }
  return false;
}

std::span<const std::byte> find_png_chunk(std::span<const std::byte> png, std::string_view type) {
  for (auto rest = png.subspan(kPngSignature.size()); rest.size() >= kFrame;) {
    const std::size_t length = big_endian<std::uint32_t>(rest);
    if (text_of(rest.subspan(4, 4)) == type) return rest.subspan(8, length);
    rest = rest.subspan(kFrame + length);
  }
  return {};
}

std::vector<std::byte> with_png_texts(std::span<const std::byte> png,
                                      const std::vector<PngText>& texts) {
  std::vector<std::byte> result{png.begin(), png.begin() + kPngHeaderEnd};
  for (const auto& [keyword, text] : texts) {
    const bool plain = std::all_of(text.begin(), text.end(),
                                   [](char c) { return c >= ' ' && c <= '~' && c != '"'; });
    // A zero ends the keyword; behind an iTXt's no compression, no language, no translation.
    const std::string ends = plain ? std::string(1, '\0') : std::string(5, '\0');
    append_png_chunk(result, plain ? "tEXt" : "iTXt",
                     std::string{keyword}.append(ends).append(text));
  }
  result.insert(result.end(), png.begin() + kPngHeaderEnd, png.end());
  return result;
}

std::optional<std::string> find_png_text(std::span<const std::byte> png, std::string_view keyword) {
  for (auto rest = png.subspan(kPngSignature.size()); rest.size() >= kFrame;) {
    const std::size_t length = big_endian<std::uint32_t>(rest);
    const std::string_view type = text_of(rest.subspan(4, 4));
    const auto keyed = split_at_zero(text_of(rest.subspan(8, length)));
    if (keyed && keyed->keyword == keyword) {
      if (type == "tEXt") return std::string{keyed->rest};
      if (type == "iTXt") {
        if (const auto text = international_text(keyed->rest)) return std::string{*text};
      }
    }
    rest = rest.subspan(kFrame + length);
  }
  return std::nullopt;
}

}  // namespace softfocus
