// A PNG (PNG specification, 5.2 and 5.3) is a signature of 8 bytes and chunks: a big-endian length,
// a type of 4 letters, so many bytes, and a checksum of 4.

#include "scenes/files/picture_check.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace softfocus {

bool has_cut_png_chunk(std::string_view bytes) {
  constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
  constexpr std::size_t kFrame = 12;
  if (!bytes.starts_with(kSignature)) return false;
  for (bytes.remove_prefix(kSignature.size()); bytes.size() >= kFrame;) {
    std::uint32_t length = 0;
    for (const char byte : bytes.substr(0, 4)) {
      length = length << 8 | static_cast<unsigned char>(byte);
    }
    if (length > bytes.size() - kFrame) return true;
    if (bytes.substr(4, 4) == "IEND") return false;
    bytes.remove_prefix(kFrame + length);
  }
  return true;
}

// A JPEG (ITU T.81, B.1.1) is a sequence of segments: 0xFF, a marker, and for most a
// big-endian length that counts itself, then so many bytes less two. In a scan's data a
// 0xFF is always followed by 0 or a restart marker.

namespace {

constexpr std::size_t kHuffmanTables = 0xC4, kEnd = 0xD9, kScan = 0xDA;

// The byte there, 0 past the end, as stb_image reads it.
std::size_t byte_at(std::string_view bytes, std::size_t at) {
  return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0;
}

std::size_t length_at(std::string_view bytes, std::size_t at) {
  return byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
}

// Tables from `at`, where the segment's length stands: each a byte of class and number,
// 16 counts, and as many values as the counts add up to.
bool is_overfull(std::string_view bytes, std::size_t at) {
  std::size_t left = length_at(bytes, at);
  if (left < 2) return false;
  left -= 2;
  at += 2;
  while (left > 0) {
    const std::size_t table = byte_at(bytes, at);
    if (table >> 4 > 1 || (table & 15) > 3) return false;  // stb_image refuses it
    std::size_t codes = 0;
    for (std::size_t i = 1; i <= 16; ++i) codes += byte_at(bytes, at + i);
    if (codes > 256) return true;
    at += 17 + codes;
    if (left < 17 + codes) return false;  // stb_image refuses what is too long
    left -= 17 + codes;
  }
  return false;
}

bool begins_frame(std::size_t marker) { return marker >= 0xC0 && marker <= 0xC2; }

bool is_restart(std::size_t marker) { return marker >= 0xD0 && marker <= 0xD7; }

bool has_length(std::size_t marker) {
  return marker >= 0xC0 && !(marker >= 0xD0 && marker <= 0xD9);
}

// Of the first coefficient and of the others: class 0 and 1, four of each.
using KnownTables = std::array<std::array<bool, 16>, 16>;

void note_tables(std::string_view bytes, std::size_t at, KnownTables& known) {
  const std::size_t end = at + length_at(bytes, at);
  for (at += 2; at < end;) {
    const std::size_t table = byte_at(bytes, at);
    known[table >> 4][table & 15] = true;
    std::size_t codes = 0;
    for (std::size_t i = 1; i <= 16; ++i) codes += byte_at(bytes, at + i);
    at += 17 + codes;
  }
}

// A scan's segment (B.2.3), `at` where its length stands: components, each with its tables of both
// classes; the coefficients from Ss to Se; and in Ah how many bits are there already.
bool knows_tables(std::string_view bytes, std::size_t at, bool is_progressive,
                  const KnownTables& known) {
  const std::size_t components = byte_at(bytes, at + 2);
  const std::size_t first = byte_at(bytes, at + 3 + 2 * components);
  const bool refines = byte_at(bytes, at + 5 + 2 * components) >> 4 > 0;
  for (std::size_t i = 0; i < components; ++i) {
    const std::size_t tables = byte_at(bytes, at + 4 + 2 * i);
    const bool needs_first = !is_progressive || (first == 0 && !refines);
    const bool needs_others = !is_progressive || first > 0;
    if ((needs_first && !known[0][tables >> 4]) || (needs_others && !known[1][tables & 15])) {
      return false;
    }
  }
  return true;
}

}  // namespace

bool is_cut_jpeg(std::string_view bytes) {
  if (!bytes.starts_with("\xFF\xD8")) return false;
  const std::size_t last_scan = bytes.rfind("\xFF\xDA");
  return last_scan == std::string_view::npos ||
         bytes.find("\xFF\xD9", last_scan) == std::string_view::npos;
}

bool has_overfull_huffman_table(std::string_view bytes) {
  if (byte_at(bytes, 0) != 0xFF) return false;
  // Up to the frame segment by segment, as stb_image goes: a picture's thumbnail or
  // colour profile may hold anything. Junk between segments is passed over.
  std::size_t at = 0;
  while (at < bytes.size()) {
    if (byte_at(bytes, at++) != 0xFF) continue;
    while (byte_at(bytes, at) == 0xFF) ++at;
    const std::size_t marker = byte_at(bytes, at++);
    if (begins_frame(marker)) break;
    if (marker == kHuffmanTables && is_overfull(bytes, at)) return true;
    if (has_length(marker)) at += length_at(bytes, at);
  }
  // From there on wherever the marker stands: in a scan's data it cannot by chance.
  while ((at = bytes.find("\xFF\xC4", at)) != std::string_view::npos) {
    at += 2;
    if (is_overfull(bytes, at)) return true;
  }
  return false;
}

bool lacks_huffman_table(std::string_view bytes) {
  if (byte_at(bytes, 0) != 0xFF) return false;
  KnownTables known{};
  bool is_progressive = false, in_scan = false;
  for (std::size_t at = 0; at < bytes.size();) {
    if (byte_at(bytes, at++) != 0xFF) continue;
    while (byte_at(bytes, at) == 0xFF) ++at;
    const std::size_t marker = byte_at(bytes, at++);
    if (in_scan && (marker == 0 || is_restart(marker))) continue;
    if (marker == kEnd) break;
    in_scan = marker == kScan;
    if (begins_frame(marker)) is_progressive = marker == 0xC2;
    if (marker == kHuffmanTables) note_tables(bytes, at, known);
    if (in_scan && !knows_tables(bytes, at, is_progressive, known)) return true;
    if (has_length(marker)) at += length_at(bytes, at);
  }
  return false;
}

}  // namespace softfocus
