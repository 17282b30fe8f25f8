#include "tools/refocus/depth/phone_depth.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "tools/files/base64.h"
#include "tools/files/byte_order.h"
#include "tools/pictures/png_text.h"

namespace softfocus {
namespace {

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A JPEG among the bytes of a file.
struct JpegPart {
  std::size_t begin = 0, end = 0;
  std::string xmp{};  ///< the extension behind the text that it extends
  bool is_grey = false;
};

constexpr std::string_view kStart{"\xFF\xD8\xFF", 3}, kEnd{"\xFF\xD9", 2};
constexpr std::string_view kXmp{"http://ns.adobe.com/xap/1.0/\0", 29};
constexpr std::string_view kExtension{"http://ns.adobe.com/xmp/extension/\0", 35};

/// Adds a segment of extended XMP, behind whose name stand 32 letters, its length and its place.
void add_extension(std::string_view data, std::string& extension) {
  constexpr std::size_t kName = 32, kHeader = kName + 8;
  if (data.size() < kHeader) return;
  const auto numbers = std::as_bytes(std::span{data.substr(kName)});
  const std::size_t length = big_endian<std::uint32_t>(numbers);
  const std::size_t place = big_endian<std::uint32_t>(numbers.subspan(4));
  data.remove_prefix(kHeader);
  // As much as is there, not as much as is claimed.
  if (place > extension.size() || data.size() > length || place > length - data.size()) return;
  extension.resize(std::max(extension.size(), place + data.size()));
  data.copy(extension.data() + place, data.size());
}

/// The JPEG that begins there; nothing if it has no scan or no end.
std::optional<JpegPart> jpeg_at(std::span<const std::byte> file, std::size_t begin) {
  constexpr std::uint32_t kApp1 = 0xFFE1, kStartOfScan = 0xFFDA, kFirstFrame = 0xFFC0;
  JpegPart part{.begin = begin};
  std::string extension;
  for (std::size_t at = begin + 2; at + 4 <= file.size();) {
    const std::uint32_t marker = big_endian<std::uint16_t>(file.subspan(at));
    const std::size_t length = big_endian<std::uint16_t>(file.subspan(at + 2));
    if (marker < 0xFF01 || length < 2 || at + 2 + length > file.size()) return std::nullopt;
    const std::string_view data = text_of(file.subspan(at + 4, length - 2));
    if (marker == kApp1 && data.starts_with(kXmp)) part.xmp += data.substr(kXmp.size());
    if (marker == kApp1 && data.starts_with(kExtension)) {
      add_extension(data.substr(kExtension.size()), extension);
    }
    constexpr std::size_t kComponents = 5;  // behind bits, height and width
    const bool is_frame = marker >= kFirstFrame && marker <= kFirstFrame + 2;
    if (is_frame && data.size() > kComponents) part.is_grey = data[kComponents] == 1;
    at += 2 + length;
    if (marker != kStartOfScan) continue;
    // In a scan FF is followed by 0 or the number of a restart.
    const std::size_t end = text_of(file).find(kEnd, at);
    if (end == std::string_view::npos) return std::nullopt;
    part.end = end + kEnd.size();
    part.xmp += extension;
    return part;
  }
  return std::nullopt;
}

/// The value of an attribute or of an element of that name; empty if there is none.
std::string_view xmp_value(std::string_view xmp, std::string_view name) {
  constexpr std::string_view kBlanks = " \t\r\n";
  for (std::size_t at = xmp.find(name); at != xmp.npos; at = xmp.find(name, at + 1)) {
    std::string_view rest = xmp.substr(at + name.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlanks), rest.size()));
    if (rest.empty()) return {};
    char closing = '<';
    if (rest.front() == '=') {
      rest.remove_prefix(std::min(rest.find_first_of("\"'"), rest.size()));
      if (rest.empty()) return {};
      closing = rest.front();
    } else if (rest.front() != '>') {
      continue;  // a longer name
    }
    rest.remove_prefix(1);
    const std::string_view value = rest.substr(0, rest.find(closing));
    if (!value.empty()) return value;
  }
  return {};
}

std::optional<double> xmp_number(std::string_view xmp, std::string_view name) {
  const std::string text{xmp_value(xmp, name)};
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(number)) return std::nullopt;
  return number;
}

bool has_word(std::string_view text, std::string_view word) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  return std::search(text.begin(), text.end(), word.begin(), word.end(), same) != text.end();
}

/// Near and far in metres, and what lies between, by GDepth or Dynamic Depth.
void take_range(std::string_view xmp, PhoneDepth& depth) {
  for (const std::string prefix : {"GDepth:", "DepthMap:"}) {
    const std::string_view format = xmp_value(xmp, prefix + "Format");
    if (format.empty()) continue;
    depth.encoding =
        find_depth_encoding(has_word(format, "linear") ? "gdepth-linear" : "gdepth-inverse");
    const double unit = xmp_value(xmp, prefix + "Units") == "mm" ? 0.001 : 1.0;
    const auto near = xmp_number(xmp, prefix + "Near"), far = xmp_number(xmp, prefix + "Far");
    if (near && *near > 0.0) depth.numbers.near_m = *near * unit;
    if (far && *far > 0.0 && *far < 1e12) depth.numbers.far_m = *far * unit;
    if (has_word(xmp_value(xmp, prefix + "MeasureType"), "opticray")) depth.along = DepthAlong::ray;
    return;
  }
}

/// Apple's: the whole numbers' ends, and the floats that they stand for.
void take_floats(std::string_view xmp, PhoneDepth& depth) {
  const auto least = xmp_number(xmp, ":FloatMinValue"), most = xmp_number(xmp, ":FloatMaxValue");
  if (!least || !most || !(*least < *most)) return;
  const double first = xmp_number(xmp, ":IntMinValue").value_or(0.0);
  const double last = xmp_number(xmp, ":IntMaxValue").value_or(255.0);
  if (!(first < last)) return;
  depth.encoding = find_depth_encoding(has_word(xmp, "disparity") ? "inverse" : "metres");
  depth.numbers.scale = (*most - *least) / (last - first);
  depth.numbers.offset = *least - *depth.numbers.scale * first;
}

/// The picture behind the first that is its depth. Maps of how much brighter the first may be shown
/// are grey, too.
std::optional<JpegPart> depth_among(std::span<const JpegPart> parts, bool is_said) {
  const auto find = [&](auto fits) -> std::optional<JpegPart> {
    for (const JpegPart& part : parts) {
      if (!has_word(part.xmp, "gainmap") && !has_word(part.xmp, "hdrgm") && fits(part)) return part;
    }
    return std::nullopt;
  };
  if (auto part = find([](const JpegPart& p) {
        return has_word(p.xmp, "depth") || has_word(p.xmp, "disparity");
      })) {
    return part;
  }
  if (auto part = find([](const JpegPart& p) { return p.is_grey; })) return part;
  return is_said ? find([](const JpegPart&) { return true; }) : std::nullopt;
}

}  // namespace

std::optional<PhoneDepth> find_phone_depth(std::span<const std::byte> jpeg) {
  const auto first = jpeg_at(jpeg, 0);
  if (!first) return std::nullopt;
  PhoneDepth depth;
  take_range(first->xmp, depth);
  for (const char* const name : {"GDepth:Data", "DepthMap:Data"}) {
    depth.file = bytes_of_base64(xmp_value(first->xmp, name));
    if (!depth.file.empty()) return depth;
  }
  const std::string_view text = text_of(jpeg);
  std::vector<JpegPart> parts;
  const std::size_t behind = first->end;
  std::size_t at = text.find(kStart, behind);
  // A film behind the picture may hold what looks like many.
  constexpr int kMostTries = 64;
  for (int tries = 0; at != text.npos && tries < kMostTries; ++tries, at = text.find(kStart, at)) {
    const auto part = jpeg_at(jpeg, at);
    if (part) parts.push_back(*part);
    at = part ? part->end : at + 1;
  }
  if (const auto part = depth_among(parts, depth.encoding != nullptr)) {
    const auto bytes = jpeg.subspan(part->begin, part->end - part->begin);
    depth.file.assign(bytes.begin(), bytes.end());
    take_range(part->xmp, depth);
    take_floats(part->xmp, depth);
    return depth;
  }
  if (const std::size_t png = text.find(kPngSignature, behind); png != text.npos) {
    const auto bytes = jpeg.subspan(png);
    const std::size_t end = text.substr(png).find("IEND");
    if (end == text.npos || end + 8 > bytes.size()) return std::nullopt;
    depth.file.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end + 8));
    return depth;
  }
  return std::nullopt;
}

}  // namespace softfocus
