// TIFF by libtiff, where the build has it: strips or tiles, any compression that it knows; whole
// numbers of 8, 16 or 32 bits, along the sRGB curve, and floats of 16 to 64 bits, of light.

#include <algorithm>
#include <iterator>
#include <string>

#include "tools/cli/errors.h"
#include "tools/pictures/image_file.h"
#include "tools/pictures/picture_file.h"

#ifdef SOFTFOCUS_WITH_TIFF
#include <tiffio.h>

#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "raster/numbers/half.h"
#endif

namespace softfocus {

#ifdef SOFTFOCUS_WITH_TIFF

std::string_view missing_tiff() { return {}; }

namespace {

/// A file in memory, for libtiff, and the first error that it told.
struct TiffMemory {
  Bytes written{};
  std::span<const std::byte> read{};
  std::uint64_t place = 0;
  std::string error{};

  std::uint64_t size() const { return std::max(read.size(), written.size()); }
};

TiffMemory& memory_of(thandle_t handle) { return *static_cast<TiffMemory*>(handle); }

tmsize_t read_some(thandle_t handle, void* to, tmsize_t wanted) {
  TiffMemory& memory = memory_of(handle);
  const std::span<const std::byte> all =
      memory.written.empty() ? memory.read : std::span<const std::byte>{memory.written};
  const std::uint64_t there = all.size() - std::min<std::uint64_t>(memory.place, all.size());
  const auto count = std::min(static_cast<std::size_t>(wanted), static_cast<std::size_t>(there));
  if (count > 0) std::memcpy(to, all.data() + memory.place, count);
  memory.place += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t write_some(thandle_t handle, void* from, tmsize_t given) {
  TiffMemory& memory = memory_of(handle);
  const auto count = static_cast<std::size_t>(given);
  const auto place = static_cast<std::size_t>(memory.place);
  if (memory.written.size() < place + count) memory.written.resize(place + count);
  std::memcpy(memory.written.data() + place, from, count);
  memory.place += count;
  return given;
}

toff_t seek(thandle_t handle, toff_t offset, int from) {
  TiffMemory& memory = memory_of(handle);
  memory.place = offset + (from == SEEK_CUR ? memory.place : from == SEEK_END ? memory.size() : 0);
  return memory.place;
}

int close_nothing(thandle_t) { return 0; }

toff_t size_of(thandle_t handle) { return memory_of(handle).size(); }

int keep_error(TIFF*, void* user, const char*, const char* format, std::va_list values) {
  TiffMemory& memory = memory_of(user);
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, values);
  if (memory.error.empty()) memory.error = text.data();
  return 1;
}

int mind_no_warning(TIFF*, void*, const char*, const char*, std::va_list) { return 1; }

using OpenTiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

[[noreturn]] void refuse_tiff(const TiffMemory& memory, const std::string& why) {
  throw FileError("the TIFF is damaged: " + (memory.error.empty() ? why : memory.error));
}

OpenTiff open_tiff(TiffMemory& memory, const char* mode) {
  constexpr tmsize_t kMostAtOnce = tmsize_t{1} << 32;
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options{
      TIFFOpenOptionsAlloc(), TIFFOpenOptionsFree};
  TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMostAtOnce);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_error, &memory);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), mind_no_warning, nullptr);
  OpenTiff tiff{TIFFClientOpenExt("TIFF", mode, &memory, read_some, write_some, seek, close_nothing,
                                  size_of, nullptr, nullptr, options.get()),
                TIFFClose};
  if (!tiff) refuse_tiff(memory, "it cannot be opened");
  return tiff;
}

template <class Number>
Number tag_of(TIFF* tiff, ttag_t tag) {
  Number value{};
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

/// What is read of a picture's head.
struct TiffForm {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 0, samples = 0, format = 0, photometric = 0;
  bool apart = false;  ///< a plane for each sample
  bool tiled = false;
  bool is_multiplied = false;  ///< colours by the sample behind them (associated alpha)
};

TiffForm form_of(TIFF* tiff) {
  std::uint16_t others = 0;
  const std::uint16_t* kinds = nullptr;
  const bool has_others = TIFFGetField(tiff, TIFFTAG_EXTRASAMPLES, &others, &kinds) == 1;
  return {tag_of<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH),
          tag_of<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH),
          tag_of<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE),
          tag_of<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL),
          tag_of<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT),
          tag_of<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC),
          tag_of<std::uint16_t>(tiff, TIFFTAG_PLANARCONFIG) == PLANARCONFIG_SEPARATE,
          TIFFIsTiled(tiff) != 0,
          has_others && others > 0 && kinds[0] == EXTRASAMPLE_ASSOCALPHA};
}

std::optional<NumberType> number_type(const TiffForm& form) {
  const bool is_float = form.format == SAMPLEFORMAT_IEEEFP;
  if (!is_float && form.format != SAMPLEFORMAT_UINT && form.format != SAMPLEFORMAT_VOID) return {};
  switch (form.bits) {
    case 8: return is_float ? std::nullopt : std::optional{NumberType::unsigned8};
    case 16: return is_float ? NumberType::half : NumberType::unsigned16;
    case 32: return is_float ? NumberType::single : NumberType::unsigned32;
    case 64: return is_float ? std::optional{NumberType::double_precision} : std::nullopt;
    default: return {};
  }
}

/// Others are palettes, inks, YCbCr, a few bits: libtiff makes colours of 8 bits of them.
bool is_plain(const TiffForm& form) {
  if (form.bits < 8) return false;
  return form.photometric == PHOTOMETRIC_MINISBLACK || form.photometric == PHOTOMETRIC_RGB ||
         (form.photometric == PHOTOMETRIC_MINISWHITE && form.format != SAMPLEFORMAT_IEEEFP);
}

void list_tiff(PictureFile& file) {
  TiffMemory memory{.read = file.bytes};
  const OpenTiff tiff = open_tiff(memory, "rm");
  const TiffForm form = form_of(tiff.get());
  check_picture_size("the TIFF", form.width, form.height);
  constexpr std::uint64_t kMostPixelsAByte = 4096;  // LZW, the densest, has 2,730
  if (std::uint64_t{form.width} * form.height / kMostPixelsAByte > file.bytes.size()) {
    refuse_tiff(memory, "it is too small a file for the size that it claims");
  }
  file.width = static_cast<int>(form.width);
  file.height = static_cast<int>(form.height);
  const std::optional<NumberType> type = number_type(form);
  std::string names = "RGBA";
  if (is_plain(form)) {
    if (!type) {
      throw FileError("the TIFF has " +
                      std::string{form.format == SAMPLEFORMAT_INT ? "signed " : ""} +
                      "numbers of " + std::to_string(form.bits) +
                      " bits; whole ones of 8, 16 or 32 bits and floats would be right");
    }
    const bool is_grey = form.photometric != PHOTOMETRIC_RGB;
    names = is_grey ? "YA" : "RGBA";
    if (form.samples < (is_grey ? 1 : 3)) refuse_tiff(memory, "it has too few channels");
    names.resize(std::min<std::size_t>(names.size(), form.samples));
  }
  for (const char name : names) {
    file.planes.push_back(
        {.name = std::string{name}, .type = is_plain(form) ? *type : NumberType::unsigned8});
  }
  file.is_srgb = !is_plain(form) || form.format != SAMPLEFORMAT_IEEEFP;
  std::uint32_t length = 0;
  void* profile = nullptr;
  if (TIFFGetField(tiff.get(), TIFFTAG_ICCPROFILE, &length, &profile) == 1) {
    const auto* start = static_cast<const std::byte*>(profile);
    take_profile(file, Bytes{start, start + length});
  }
  turn_by_exif(file, tag_of<std::uint16_t>(tiff.get(), TIFFTAG_ORIENTATION));
  if (TIFFNumberOfDirectories(tiff.get()) > 1) {
    file.remark += (file.remark.empty() ? "" : ", ") + std::string{"the first of its pictures"};
  }
}

float sample_at(const std::byte* from, NumberType type) {
  const auto as = [&]<class Number>(Number number) {
    std::memcpy(&number, from, sizeof number);
    return number;
  };
  switch (type) {
    case NumberType::unsigned8: return static_cast<float>(as(std::uint8_t{}));
    case NumberType::unsigned16: return static_cast<float>(as(std::uint16_t{}));
    case NumberType::unsigned32: return static_cast<float>(as(std::uint32_t{}));
    case NumberType::half: return half_to_float(as(std::uint16_t{}));
    case NumberType::single: return as(float{});
    case NumberType::double_precision: return static_cast<float>(as(double{}));
  }
  return 0.0f;
}

/// The stored picture's planes. Calls `put(sample, x, y, value)`.
template <class Put>
void read_plain(TIFF* tiff, const TiffMemory& memory, const TiffForm& form, NumberType type,
                const Put& put) {
  const std::uint32_t across =
      form.tiled ? tag_of<std::uint32_t>(tiff, TIFFTAG_TILEWIDTH) : form.width;
  const std::uint32_t down =
      form.tiled ? tag_of<std::uint32_t>(tiff, TIFFTAG_TILELENGTH)
                 : std::min(tag_of<std::uint32_t>(tiff, TIFFTAG_ROWSPERSTRIP), form.height);
  if (across == 0 || down == 0) refuse_tiff(memory, "its blocks have no size");
  const tmsize_t bytes = form.tiled ? TIFFTileSize(tiff) : TIFFStripSize(tiff);
  // A block may be larger than its picture, by less than a tile of the usual sizes.
  constexpr std::uint64_t kMostBeyond = std::uint64_t{1} << 24;
  const std::uint64_t all = std::uint64_t{form.width} * form.height * form.samples * form.bits / 8;
  if (bytes <= 0 || static_cast<std::uint64_t>(bytes) > 4 * all + kMostBeyond) {
    refuse_tiff(memory, "its blocks have no size that fits the picture");
  }
  std::vector<std::byte> block(static_cast<std::size_t>(bytes));
  const std::size_t each = form.bits / 8u, samples = form.apart ? 1 : form.samples;
  const auto read_block = [&](std::uint32_t x, std::uint32_t y, std::uint16_t sample) {
    const std::uint32_t number =
        form.tiled ? TIFFComputeTile(tiff, x, y, 0, sample) : TIFFComputeStrip(tiff, y, sample);
    const tmsize_t got = form.tiled ? TIFFReadEncodedTile(tiff, number, block.data(), bytes)
                                    : TIFFReadEncodedStrip(tiff, number, block.data(), bytes);
    const std::uint32_t rows = std::min(down, form.height - y);
    const std::size_t needed = static_cast<std::size_t>(rows) * across * samples * each;
    if (got < 0 || static_cast<std::size_t>(got) < std::min(needed, block.size()) ||
        needed > block.size()) {
      refuse_tiff(memory, "it is cut short");
    }
    for (std::uint32_t j = 0; j < rows; ++j) {
      for (std::uint32_t i = 0; i < std::min(across, form.width - x); ++i) {
        const std::size_t pixel = static_cast<std::size_t>(j) * across + i;
        for (std::size_t s = 0; s < samples; ++s) {
          put(form.apart ? sample : s, x + i, y + j,
              sample_at(block.data() + (pixel * samples + s) * each, type));
        }
      }
    }
  };
  for (std::uint32_t y = 0; y < form.height; y += down) {
    for (std::uint32_t x = 0; x < form.width; x += across) {
      const int planes = form.apart ? form.samples : 1;
      for (int sample = 0; sample < planes; ++sample) {
        read_block(x, y, static_cast<std::uint16_t>(sample));
      }
    }
  }
}

/// Divides colours by their alpha, as PNG has them. Whole numbers stay whole.
void divide_by_alpha(std::vector<PlaneValues>& planes, NumberType type, bool is_whole) {
  const PlaneValues& alpha = planes.back();
  const auto full = static_cast<float>(full_scale(type));
  for (std::size_t c = 0; c + 1 < planes.size(); ++c) {
    for (std::size_t i = 0; i < alpha.size(); ++i) {
      if (!(alpha[i] > 0.0f)) continue;
      const float straight = planes[c][i] * (full / alpha[i]);
      planes[c][i] = is_whole ? std::min(std::floor(straight + 0.5f), full) : straight;
    }
  }
}

void read_tiff(const PictureFile& file, std::span<const std::size_t> planes,
               std::span<PlaneValues> values) {
  TiffMemory memory{.read = file.bytes};
  const OpenTiff tiff = open_tiff(memory, "rm");
  const TiffForm form = form_of(tiff.get());
  const std::size_t pixels = static_cast<std::size_t>(form.width) * form.height;
  std::vector<PlaneValues> stored(file.planes.size(), PlaneValues(pixels));
  if (is_plain(form)) {
    const NumberType type = file.planes[0].type;
    const bool is_inverse = form.photometric == PHOTOMETRIC_MINISWHITE;
    const auto full = static_cast<float>(full_scale(type));
    read_plain(tiff.get(), memory, form, type,
               [&](std::size_t sample, std::uint32_t x, std::uint32_t y, float value) {
                 if (sample >= stored.size()) return;
                 stored[sample][static_cast<std::size_t>(y) * form.width + x] =
                     is_inverse && sample == 0 ? full - value : value;
               });
    const std::size_t colours = form.photometric == PHOTOMETRIC_RGB ? 3 : 1;
    if (form.is_multiplied && stored.size() > colours) {
      divide_by_alpha(stored, type, form.format != SAMPLEFORMAT_IEEEFP);
    }
  } else {
    std::vector<std::uint32_t> packed(pixels);
    // As it is stored: the orientation is for the planes below.
    TIFFSetField(tiff.get(), TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
    if (TIFFReadRGBAImageOriented(tiff.get(), form.width, form.height, packed.data(),
                                  ORIENTATION_TOPLEFT, 1) != 1) {
      throw FileError("libtiff does not make colours of the TIFF (" + memory.error +
                      "); oiiotool IN -o OUT.png converts many more");
    }
    for (std::size_t i = 0; i < pixels; ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        stored[c][i] = static_cast<float>(packed[i] >> (8 * c) & 255u);
      }
    }
  }
  std::size_t to = 0;
  for (int y = 0; y < file.height; ++y) {
    for (int x = 0; x < file.width; ++x, ++to) {
      const std::size_t at = stored_place(file, x, y);
      for (std::size_t i = 0; i < planes.size(); ++i) values[i][to] = stored[planes[i]][at];
    }
  }
}

}  // namespace

Bytes encode_tiff(const Image& image, std::span<const float> alpha,
                  std::span<const std::byte> icc) {
  std::vector<std::uint16_t> values = srgb16_values(image, alpha);
  const std::size_t channels = alpha.empty() ? 3 : 4;
  const std::size_t row_values = channels * static_cast<std::size_t>(image.width);
  TiffMemory memory;
  OpenTiff tiff = open_tiff(memory, "wlm");  // low byte first
  TIFF* const to = tiff.get();
  TIFFSetField(to, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(image.width));
  TIFFSetField(to, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(image.height));
  TIFFSetField(to, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(to, TIFFTAG_SAMPLESPERPIXEL, static_cast<int>(channels));
  TIFFSetField(to, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(to, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  // Compressed bytes would be those of one zlib.
  TIFFSetField(to, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(to, TIFFTAG_ROWSPERSTRIP, static_cast<std::uint32_t>(image.height));
  constexpr std::uint16_t kAlpha = EXTRASAMPLE_UNASSALPHA;
  if (channels == 4) TIFFSetField(to, TIFFTAG_EXTRASAMPLES, 1, &kAlpha);
  if (!icc.empty()) {
    TIFFSetField(to, TIFFTAG_ICCPROFILE, static_cast<std::uint32_t>(icc.size()), icc.data());
  }
  bool is_whole = true;
  for (int y = 0; y < image.height; ++y) {
    is_whole =
        is_whole && TIFFWriteScanline(to, values.data() + row_values * static_cast<std::size_t>(y),
                                      static_cast<std::uint32_t>(y)) == 1;
  }
  is_whole = is_whole && TIFFFlush(to) == 1;
  tiff.reset();
  if (!is_whole) throw FileError("the TIFF cannot be written: " + memory.error);
  return std::move(memory.written);
}

#else

std::string_view missing_tiff() {
  return "this build has no TIFF files; install the library (libtiff-dev) and build again";
}

Bytes encode_tiff(const Image&, std::span<const float>, std::span<const std::byte>) {
  throw FileError(std::string{missing_tiff()});
}

namespace {

void list_tiff(PictureFile&) { throw FileError(std::string{missing_tiff()}); }
void read_tiff(const PictureFile&, std::span<const std::size_t>, std::span<PlaneValues>) {}

}  // namespace

#endif

namespace {

bool is_tiff(std::span<const std::byte> bytes) {
  constexpr std::string_view kMarks[] = {{"II*\0", 4}, {"MM\0*", 4}, {"II+\0", 4}, {"MM\0+", 4}};
  const std::string_view start{reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 4)};
  return std::find(std::begin(kMarks), std::end(kMarks), start) != std::end(kMarks);
}

}  // namespace

const PictureFileReader kTiffReader{"TIFF", is_tiff, list_tiff, read_tiff};

}  // namespace softfocus
