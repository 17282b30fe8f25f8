#include "tools/files/picture_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/files/srgb16.h"

namespace softfocus {
namespace {

/// Some kinds of pictures are not read, but Debian has a program for each.
struct ForeignKind {
  std::string_view magic;
  std::size_t at;
  std::string_view name;
  std::string_view remedy;
};
constexpr std::string_view kByOiiotool = "oiiotool IN -o OUT.exr converts it, depth included";
constexpr std::string_view kByHeif =
    "heif-convert IN OUT.png converts it, its depth into a second file";
constexpr std::array kForeignKinds{
    ForeignKind{{"II*\0", 4}, 0, "a TIFF", kByOiiotool},
    ForeignKind{{"MM\0*", 4}, 0, "a TIFF", kByOiiotool},
    ForeignKind{{"II+\0", 4}, 0, "a TIFF", kByOiiotool},
    ForeignKind{"ftyphei", 4, "a HEIC", kByHeif},
    ForeignKind{"ftypmif1", 4, "a HEIC", kByHeif},
    ForeignKind{"ftypavif", 4, "an AVIF", kByHeif},
    ForeignKind{"WEBP", 8, "a WebP", "dwebp IN -o OUT.png converts it"},
    ForeignKind{"GIF8", 0, "a GIF", kByOiiotool},
    ForeignKind{"8BPS", 0, "a Photoshop file", kByOiiotool},
    ForeignKind{"SDPX", 0, "a DPX", kByOiiotool},
    ForeignKind{"XPDS", 0, "a DPX", kByOiiotool},
    ForeignKind{"P5", 0, "a PGM", "pnmtopng IN >OUT.png converts it"},
    ForeignKind{"P6", 0, "a PPM", "pnmtopng IN >OUT.png converts it"},
    ForeignKind{"BM", 0, "a BMP", kByOiiotool}};

constexpr std::array kReaders{&kPngReader, &kJpegReader, &kHdrReader,
                              &kPfmReader, &kNpyReader,  &kExrReader};

const PictureFileReader& reader_of(std::span<const std::byte> bytes) {
  for (const PictureFileReader* reader : kReaders) {
    if (reader->is(bytes)) return *reader;
  }
  for (const ForeignKind& kind : kForeignKinds) {
    if (bytes.size() >= kind.at + kind.magic.size() &&
        std::memcmp(bytes.data() + kind.at, kind.magic.data(), kind.magic.size()) == 0) {
      throw FileError("it is " + std::string{kind.name} + "; " + std::string{kind.remedy});
    }
  }
  throw FileError("it is none of PNG, JPEG, PFM, Radiance HDR, NumPy and OpenEXR");
}

[[noreturn]] void refuse(const PictureFile& file, const FileError& error) {
  throw FileError("cannot read '" + file.path.string() + "': " + error.what());
}

/// What comes before the last dot of a channel's name, and what comes behind it.
struct SplitName {
  std::string layer, channel;
};
SplitName split(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == name.npos) return {"", name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

/// From numbers of 0 to full_scale() along the sRGB curve, or any numbers of light, to halves.
class ToHalf {
 public:
  ToHalf(NumberType type, bool is_srgb) : type_(type) {
    if (type != NumberType::unsigned8 && type != NumberType::unsigned16) return;
    const auto count = static_cast<std::size_t>(full_scale(type)) + 1;
    table_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const float value = !is_srgb ? static_cast<float>(static_cast<double>(i) / full_scale(type))
                          : type == NumberType::unsigned8
                              ? srgb8_to_linear(static_cast<std::uint8_t>(i))
                              : srgb16_to_linear(static_cast<std::uint16_t>(i));
      table_[i] = float_to_half(value, HalfRounding::nearest_even);
    }
  }

  std::uint16_t operator()(float value) const {
    if (!table_.empty()) return table_[static_cast<std::size_t>(value)];
    if (value != value) return 0;
    if (type_ == NumberType::unsigned32) value = static_cast<float>(value / full_scale(type_));
    constexpr float kMost = 65504.0f;
    return float_to_half(std::clamp(value, -kMost, kMost), HalfRounding::nearest_even);
  }

 private:
  NumberType type_;
  std::vector<std::uint16_t> table_{};
};

}  // namespace

std::string_view name_of(NumberType type) {
  switch (type) {
    case NumberType::unsigned8: return "8 bits";
    case NumberType::unsigned16: return "16 bits";
    case NumberType::unsigned32: return "32 bits";
    case NumberType::half: return "half";
    case NumberType::single: return "float";
    case NumberType::double_precision: return "double";
  }
  return "";
}

double full_scale(NumberType type) {
  switch (type) {
    case NumberType::unsigned8: return 255.0;
    case NumberType::unsigned16: return 65535.0;
    case NumberType::unsigned32: return 4294967295.0;
    default: return 1.0;
  }
}

void check_picture_size(std::string_view kind, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSize && height <= kMaxImageSize) return;
  throw FileError(std::string{kind} + " is " + std::to_string(width) + "x" +
                  std::to_string(height) + " pixels; each side may be 1 to " +
                  std::to_string(kMaxImageSize));
}

bool begins_as_picture(std::span<const std::byte> bytes) {
  return std::any_of(kReaders.begin(), kReaders.end(),
                     [&](const PictureFileReader* reader) { return reader->is(bytes); });
}

PictureFile open_picture_file(Bytes bytes, const std::filesystem::path& path) {
  PictureFile file{.path = path, .bytes = std::move(bytes)};
  try {
    file.reader = &reader_of(file.bytes);
    file.reader->list(file);
  } catch (const FileError& error) {
    refuse(file, error);
  }
  return file;
}

PictureFile open_picture_file(const std::filesystem::path& path) {
  return open_picture_file(read_picture_bytes(path), path);
}

std::vector<PlaneValues> read_planes(const PictureFile& file, std::span<const std::size_t> planes,
                                     float outside) {
  try {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(file.width) * static_cast<std::uint64_t>(file.height);
    const auto there = memory_bytes();
    if (there && pixels * planes.size() > *there / sizeof(float)) {
      throw FileError("it has " + size_text({file.width, file.height}) +
                      " pixels, more than fit into memory; give a smaller picture");
    }
    std::vector<PlaneValues> values(planes.size());
    for (PlaneValues& plane : values) plane.assign(static_cast<std::size_t>(pixels), outside);
    file.reader->read(file, planes, values);
    return values;
  } catch (const FileError& error) {
    refuse(file, error);
  }
}

std::string plane_names(const PictureFile& file) { return names_of(file.planes); }

std::vector<ColourLayer> colour_layers(const PictureFile& file) {
  std::vector<std::string> names;
  for (const PlaneInfo& plane : file.planes) {
    const std::string layer = split(plane.name).layer;
    if (std::find(names.begin(), names.end(), layer) == names.end()) names.push_back(layer);
  }
  std::vector<ColourLayer> layers;
  for (const std::string& name : names) {
    const auto find = [&](std::string_view channel) -> std::optional<std::size_t> {
      for (std::size_t i = 0; i < file.planes.size(); ++i) {
        SplitName of = split(file.planes[i].name);
        for (char& c : of.channel) {
          if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
        }
        if (of.layer != name) continue;
        if (of.channel == channel || (of.channel.size() > 1 &&
                                      (of.channel == "RED" || of.channel == "GREEN" ||
                                       of.channel == "BLUE" || of.channel == "ALPHA") &&
                                      of.channel.substr(0, 1) == channel)) {
          return i;
        }
      }
      return std::nullopt;
    };
    const auto red = find("R"), green = find("G"), blue = find("B"), grey = find("Y");
    if (red && green && blue) {
      layers.push_back({name, *red, *green, *blue, find("A")});
    } else if (grey && !red && !find("X")) {  // X, Y, Z are a direction
      layers.push_back({name, *grey, *grey, *grey, find("A")});
    }
  }
  return layers;
}

Picture read_colour(const PictureFile& file, const ColourLayer& layer, bool with_alpha) {
  std::vector<std::size_t> planes{layer.red};
  if (layer.green != layer.red) planes.insert(planes.end(), {layer.green, layer.blue});
  const bool has_alpha = with_alpha && layer.alpha;
  if (has_alpha) planes.push_back(*layer.alpha);
  Picture picture{make_image(Format::rgba16f, file.width, file.height), has_alpha};
  const auto put = [&](const PlaneValues& from, std::size_t plane, std::size_t first,
                       std::size_t last) {
    const ToHalf to_half{file.planes[plane].type, file.is_srgb && first < 3};
    std::size_t next = 0;
    for (int y = 0; y < file.height; ++y) {
      const auto to = row<std::uint16_t>(picture.image, y);
      for (std::size_t i = 0; i < to.size(); i += 4) {
        const std::uint16_t half = to_half(from[next++]);
        for (std::size_t c = first; c <= last; ++c) to[i + c] = half;
      }
    }
  };
  const std::size_t at_once = file.reader->reads_apart ? 1 : planes.size();
  for (std::size_t i = 0; i < planes.size(); i += at_once) {
    const std::vector<PlaneValues> values =
        read_planes(file, std::span{planes}.subspan(i, at_once), 0.0f);
    for (std::size_t p = i; p < i + at_once; ++p) {
      const bool is_alpha = has_alpha && p + 1 == planes.size();
      const bool is_grey = !is_alpha && layer.green == layer.red;
      const std::size_t channel = is_alpha ? 3 : p;
      put(values[p - i], planes[p], channel, is_grey ? 2 : channel);
    }
  }
  return picture;
}

void put_in_alpha(const PlaneValues& values, Image& picture) {
  std::size_t next = 0;
  for (int y = 0; y < picture.height; ++y) {
    const auto to = row<std::uint16_t>(picture, y);
    for (std::size_t i = 3; i < to.size(); i += 4) {
      to[i] = float_to_half(values[next++], HalfRounding::nearest_even);
    }
  }
}

}  // namespace softfocus
