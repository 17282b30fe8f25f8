#include "tools/pictures/picture_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "raster/images/texel.h"
#include "raster/numbers/srgb.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/pictures/image_file.h"

namespace softfocus {
namespace {

/// Some kinds of pictures are not read, but Debian has a program for each.
struct ForeignKind {
  std::string_view magic;
  std::size_t at;
  std::string_view name;
  std::string_view remedy;
};
// To PNG, whole numbers stay what they are. In an EXR they would be parts of their largest, in
// halves, and sRGB numbers would be taken for light.
constexpr std::string_view kByOiiotool =
    "oiiotool IN -o OUT.png converts it, -o OUT.exr one of floats, depth included";
constexpr std::string_view kByNetpbm = "pnmtopng IN >OUT.png converts it";
constexpr std::string_view kByDjxl = "djxl IN OUT.png converts it";
constexpr std::string_view kByHeif =
    "heif-convert IN OUT.png converts both parts, the picture and, as OUT-depth.png, its depth";
constexpr std::array kForeignKinds{
    ForeignKind{"ftyphei", 4, "a HEIC", kByHeif},
    ForeignKind{"ftyphev", 4, "a HEIC", kByHeif},
    ForeignKind{"ftypmif1", 4, "a HEIC", kByHeif},
    ForeignKind{"ftypavif", 4, "an AVIF", kByHeif},
    ForeignKind{"WEBP", 8, "a WebP", "dwebp IN -o OUT.png converts it"},
    ForeignKind{"GIF8", 0, "a GIF", kByOiiotool},
    ForeignKind{"8BPS", 0, "a Photoshop file", kByOiiotool},
    ForeignKind{"SDPX", 0, "a DPX", kByOiiotool},
    ForeignKind{"XPDS", 0, "a DPX", kByOiiotool},
    ForeignKind{"P1", 0, "a PBM", kByNetpbm},
    ForeignKind{"P2", 0, "a PGM", kByNetpbm},
    ForeignKind{"P3", 0, "a PPM", kByNetpbm},
    ForeignKind{"P4", 0, "a PBM", kByNetpbm},
    ForeignKind{"P5", 0, "a PGM", kByNetpbm},
    ForeignKind{"P6", 0, "a PPM", kByNetpbm},
    ForeignKind{"P7", 0, "a PAM", "pamtopng IN >OUT.png converts it"},
    ForeignKind{"\xFF\x0A", 0, "a JPEG XL", kByDjxl},
    ForeignKind{"JXL ", 4, "a JPEG XL", kByDjxl},
    ForeignKind{"jP  ", 4, "a JPEG 2000", kByOiiotool},
    ForeignKind{"BM", 0, "a BMP", kByOiiotool}};

constexpr std::array kReaders{&kPngReader, &kJpegReader, &kHdrReader, &kPfmReader,
                              &kNpyReader, &kExrReader,  &kTiffReader};

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
  if (bytes.empty()) throw FileError("it is empty");
  throw FileError("it is none of PNG, JPEG, TIFF, PFM, Radiance HDR, NumPy and OpenEXR");
}

[[noreturn]] void refuse(const PictureFile& file, const FileError& error) {
  throw FileError("cannot read '" + file.path.string() + "': " + error.what());
}

/// A channel's name, before its last dot and behind it.
struct SplitName {
  std::string layer, channel;
};
SplitName split(const std::string& name) {
  const auto dot = name.rfind('.');
  if (dot == name.npos) return {"", name};
  return {name.substr(0, dot), name.substr(dot + 1)};
}

/// The halves of numbers of 0 to full_scale(), along the sRGB curve or of light. Empty for others
/// than whole ones of 8 or 16 bits.
std::vector<std::uint16_t> half_table(NumberType type, bool is_srgb) {
  if (type != NumberType::unsigned8 && type != NumberType::unsigned16) return {};
  std::vector<std::uint16_t> table(static_cast<std::size_t>(full_scale(type)) + 1);
  for (std::size_t i = 0; i < table.size(); ++i) {
    const float value = !is_srgb ? static_cast<float>(static_cast<double>(i) / full_scale(type))
                        : type == NumberType::unsigned8
                            ? srgb8_to_linear(static_cast<std::uint8_t>(i))
                            : srgb16_to_linear(static_cast<std::uint16_t>(i));
    table[i] = float_to_half(value, HalfRounding::nearest_even);
  }
  return table;
}

/// The largest half.
constexpr float kMostLight = 65504.0f;

float light_of(NumberType type, float value) {
  if (value != value) return 0.0f;
  return type == NumberType::unsigned32 ? static_cast<float>(value / full_scale(type)) : value;
}

}  // namespace

void check_picture_size(std::string_view kind, std::int64_t width, std::int64_t height,
                        int most_rows) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSize && height <= most_rows) return;
  throw FileError(
      std::string{kind} + " is " + std::to_string(width) + "x" + std::to_string(height) +
      " pixels; each side may be 1 to " + std::to_string(kMaxImageSize) +
      (most_rows > kMaxImageSize ? ", the height to " + std::to_string(most_rows) : ""));
}

bool begins_as_picture(std::span<const std::byte> bytes) {
  return std::any_of(kReaders.begin(), kReaders.end(),
                     [&](const PictureFileReader* reader) { return reader->is(bytes); });
}

namespace {

/// Reads what stands before the values.
void list(PictureFile& file) {
  file.reader->list(file);
  file.shown = {0, 0, file.width, file.height};
  if (file.data.width == 0) file.data = file.shown;
}

}  // namespace

void take_data_window(PictureFile& file) {
  file.left = file.data.x;
  file.top = file.data.y;
  file.width = file.data.width;
  file.height = file.data.height;
}

PlaneValues moved(const PlaneValues& values, const PictureBox& from, const PictureBox& to,
                  float outside) {
  PlaneValues result(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height),
                     outside);
  const int left = std::max(from.x, to.x);
  const int right = std::min(from.x + from.width, to.x + to.width);
  for (int y = std::max(from.y, to.y);
       left < right && y < std::min(from.y + from.height, to.y + to.height); ++y) {
    const auto first = values.begin() + std::ptrdiff_t{y - from.y} * from.width + (left - from.x);
    std::copy(first, first + (right - left),
              result.begin() + std::ptrdiff_t{y - to.y} * to.width + (left - to.x));
  }
  return result;
}

PictureFile open_picture_file(Bytes bytes, const std::filesystem::path& path) {
  PictureFile file{.path = path, .bytes = std::move(bytes)};
  try {
    file.reader = &reader_of(file.bytes);
    list(file);
  } catch (const FileError& error) {
    refuse(file, error);
  }
  return file;
}

PictureFile open_picture_file(const std::filesystem::path& path) {
  return open_picture_file(read_picture_bytes(path), path);
}

namespace {

/// The most that is read of a file's beginning. No header of a picture that is larger than memory
/// comes near.
constexpr std::size_t kMostOfHeader = std::size_t{1} << 20;

/// Reads what stands before the values. False if it is read whole.
bool list_on_disk(PictureFile& file) {
  const ByteSource source{file.disk};
  source.at(0, static_cast<std::size_t>(std::min<std::uint64_t>(kMostOfHeader, source.size())),
            file.bytes);
  file.reader = &reader_of(file.bytes);
  if (file.reader->rows == nullptr) return false;
  list(file);
  return file.has_rows;
}

}  // namespace

std::optional<PictureFile> open_on_disk(const std::filesystem::path& path, std::string& why) {
  const std::string name = "'" + path.string() + "'";
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    why = name + " is no file on a disk";
    return std::nullopt;
  }
  PictureFile file{.path = path};
  try {
    file.disk = std::make_shared<const DiskFile>(path);
    if (list_on_disk(file)) return file;
    why = name + (file.has_rows
                      ? " is of a kind that is read whole, " + std::string{file.reader->name}
                      : " is stored by columns");
  } catch (const FileError& damage) {
    refuse(file, damage);
  } catch (const std::system_error& failure) {
    why = name + ": " + failure.code().message();
  }
  return std::nullopt;
}

ReadRows rows_of(const PictureFile& file, std::vector<std::size_t> planes) {
  try {
    return [&file, read = file.reader->rows(file, std::move(planes))](
               Rows rows, std::span<PlaneValues> values) {
      try {
        read(rows, values);
      } catch (const FileError& error) {
        refuse(file, error);
      }
    };
  } catch (const FileError& error) {
    refuse(file, error);
  }
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
    if (file.reader->rows != nullptr) {
      file.reader->rows(file, {planes.begin(), planes.end()})({0, file.height}, values);
    } else {
      file.reader->read(file, planes, values);
    }
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

ColourHalves::ColourHalves(const PictureFile& file, const ColourLayer& layer, bool with_alpha,
                           float light) {
  const auto add = [&](std::size_t plane, std::size_t first, std::size_t last) {
    planes_.push_back(plane);
    const bool is_light = file.to_srgb && first < 3;
    const NumberType type = is_light ? NumberType::single : file.planes[plane].type;
    channels_.push_back(
        {first, last, type, half_table(type, file.is_srgb && first < 3), first < 3 ? light : 1.0f});
  };
  const bool is_grey = layer.green == layer.red;
  add(layer.red, 0, is_grey ? 2 : 0);
  if (!is_grey) add(layer.green, 1, 1);
  if (!is_grey) add(layer.blue, 2, 2);
  if (with_alpha && layer.alpha) add(*layer.alpha, 3, 3);
}

void ColourHalves::put(std::size_t i, const PlaneValues& values, Image& picture) {
  const Channel& channel = channels_[i];
  std::size_t next = 0;
  for (int y = 0; y < picture.height; ++y) {
    const auto to = row<std::uint16_t>(picture, y);
    for (std::size_t x = 0; x < to.size(); x += 4) {
      std::uint16_t half = 0;
      if (channel.table.empty()) {
        const float value = light_of(channel.type, values[next++]) * channel.light;
        const float kept = std::clamp(value, -kMostLight, kMostLight);
        half = float_to_half(kept, HalfRounding::nearest_even);
        cut_ += kept != value && channel.first < 3;
      } else {
        half = channel.table[static_cast<std::size_t>(values[next++])];
      }
      for (std::size_t c = channel.first; c <= channel.last; ++c) to[x + c] = half;
    }
  }
}

float brightest_of(std::span<const float> values) {
  float brightest = 0.0f;
  for (const float value : values) {
    const float size = std::fabs(value);
    if (size > brightest && size <= std::numeric_limits<float>::max()) brightest = size;
  }
  return brightest;
}

namespace {

/// Red, green and blue, the first of `values`, which are read together.
void convert(const PictureFile& file, const ColourLayer& layer, std::vector<PlaneValues>& values) {
  if (layer.green == layer.red || values.size() < 3) return;
  try {
    profile_to_light(file, full_scale(file.planes[layer.red].type),
                     {&values[0], &values[1], &values[2]});
  } catch (const FileError& error) {
    refuse(file, error);
  }
}

}  // namespace

bool may_be_bright(const PictureFile& file, const ColourLayer& layer) {
  const NumberType type = file.planes[layer.red].type;
  return type == NumberType::single || type == NumberType::double_precision;
}

Picture read_colour(const PictureFile& file, const ColourLayer& layer, bool with_alpha,
                    int most_power) {
  const std::vector<std::size_t> all = ColourHalves{file, layer, with_alpha}.planes();
  const std::span planes{all};
  const std::size_t colours = layer.green == layer.red ? 1 : 3;
  Picture picture{make_image(Format::rgba16f, file.width, file.height), with_alpha && layer.alpha};
  const std::size_t at_once = file.reader->reads_apart ? 1 : planes.size();
  std::vector<PlaneValues> values;
  const auto read = [&](std::size_t first) {
    if (first > 0 || at_once < planes.size() || values.empty()) {
      values = read_planes(file, planes.subspan(first, at_once), 0.0f);
    }
  };
  if (may_be_bright(file, layer)) {
    float brightest = 0.0f;
    for (std::size_t i = 0; i < planes.size(); i += at_once) {
      read(i);
      for (std::size_t p = i; p < std::min(i + at_once, colours); ++p) {
        brightest = std::max(brightest, brightest_of(values[p - i]));
      }
    }
    while (picture.light_power < most_power &&
           brightest > std::ldexp(kMostLight, picture.light_power)) {
      ++picture.light_power;
    }
    picture.brightest = static_cast<double>(brightest);
  }
  ColourHalves halves{file, layer, with_alpha, std::ldexp(1.0f, -picture.light_power)};
  for (std::size_t i = 0; i < planes.size(); i += at_once) {
    read(i);
    if (file.to_srgb) convert(file, layer, values);
    for (std::size_t p = i; p < i + at_once; ++p) halves.put(p, values[p - i], picture.image);
  }
  picture.cut = halves.cut();
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
