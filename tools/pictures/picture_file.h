#pragma once
// A picture's file as planes of numbers: colour, depth, whatever it holds, by name. One reader a
// kind of file. A file is opened first, which reads its header alone; then those planes are read
// that are wanted, so that a file of forty layers takes the memory of two. Some kinds can be read a
// band of rows at a time from the disk.
//
//   PNG, JPEG   R G B, or Y if grey, and A; whole numbers up to 255 or 65535; palettes are looked
//   up HDR, PFM    R G B, or Y if grey NPY         '<f2', '<f4', '<f8', '|u1', '<u2', C or Fortran
//   order, (height, width) or
//               (height, width, 1 to 4): Y, YA, RGB, RGBA
//   EXR         its channels, "layer.R"; of a file with several parts "part.layer.R"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/files/byte_source.h"
#include "tools/pictures/image_file.h"

namespace softfocus {

enum class NumberType : std::uint8_t {
  unsigned8,
  unsigned16,
  unsigned32,
  half,
  single,
  double_precision
};

std::string_view name_of(NumberType type);

/// The largest whole number of the type, by which 0 to 1 is meant; 1 for numbers that are no
/// whole ones.
double full_scale(NumberType type);

struct PlaneInfo {
  std::string name;
  NumberType type = NumberType::single;
  int part = 0;           ///< of an EXR
  std::string channel{};  ///< its name in that part
  std::string view{};     ///< "left", "right"; empty if the EXR has none, or it is of no view
};

/// Pixels of a picture, from the upper left corner of what is shown.
struct PictureBox {
  int x = 0, y = 0, width = 0, height = 0;
  friend bool operator==(const PictureBox&, const PictureBox&) = default;
};

struct PictureFileReader;

/// A file whose header was read.
struct PictureFile {
  std::filesystem::path path;
  Bytes bytes{};  ///< all of them or, of a file that stays on the disk, those of its header
  std::shared_ptr<const DiskFile> disk{};
  const PictureFileReader* reader = nullptr;
  int width = 0;   ///< 1 to kMaxImageSize
  int height = 0;  ///< likewise, or to kMostRows of a file that stays on the disk
  /// The place of the first pixel: of an EXR that is read to its data window, beside what is shown.
  int left = 0, top = 0;
  PictureBox shown{};                ///< the size that is shown; of an EXR its display window
  PictureBox data{};                 ///< the pixels that are there: an EXR's data windows
  double pixel_aspect = 1.0;         ///< a pixel's width over its height
  std::vector<std::string> views{};  ///< of an EXR that has two or more, the first the default
  std::vector<PlaneInfo> planes{};
  /// Whether 0..1 stands for the sRGB curve and not for light. Alpha and depth have none.
  bool is_srgb = false;
  bool top_first = false;  ///< of a PFM: rows run from the top down
  Bytes icc{};             ///< an ICC profile of red, green and blue that stands in the file
  std::string icc_name{};  ///< its name, or that of another profile
  bool to_srgb = false;    ///< colours are converted from the profile to sRGB's light
  bool has_rows = true;    ///< whether a row's values lie together, as `rows` of its reader needs
  int exif_orientation =
      1;                 ///< 1 if the pixels stand upright, else 2 to 8; planes are turned by it
  std::string remark{};  ///< what else there is to tell: "3 parts, data window 10,10..99,99"
};

inline ByteSource source_of(const PictureFile& file) {
  return file.disk ? ByteSource{file.disk} : ByteSource{file.bytes};
}

/// Values row by row from the top, width x height of them, whole numbers as they are.
using PlaneValues = std::vector<float>;

/// Rows of a picture that are read or written together.
struct Rows {
  int first = 0, count = 0;
};

/// Fills a band of some planes. They have the band's size, and their values are set to what stands
/// outside of an EXR's data window. Needs the file that it was made for. Throws FileError, the file
/// itself unnamed.
using ReadRows = std::function<void(Rows rows, std::span<PlaneValues> values)>;

/// One kind of file. `list` fills in all but path, bytes, disk and reader; `read` fills planes like
/// ReadRows all at once. Both throw FileError, the file itself unnamed. A kind has either `read` or
/// `rows`, which reads from the disk, too.
struct PictureFileReader {
  std::string_view name;
  bool (*is)(std::span<const std::byte> bytes);
  void (*list)(PictureFile& file);
  void (*read)(const PictureFile& file, std::span<const std::size_t> planes,
               std::span<PlaneValues> values);
  /// Whether planes may as well be read one after the other, in a third of the memory.
  bool reads_apart = false;
  ReadRows (*rows)(const PictureFile& file, std::vector<std::size_t> planes) = nullptr;
};

extern const PictureFileReader kPngReader, kJpegReader, kHdrReader, kPfmReader, kNpyReader,
    kExrReader, kTiffReader;

/// Why this build reads and writes no TIFF, as a sentence; empty if it does.
std::string_view missing_tiff();

/// Takes an ICC profile; of grey and of inks the name alone: what is written has red, green, blue.
void take_profile(PictureFile& file, Bytes icc);

/// The file's planes are to stand upright, by an orientation of Exif and TIFF.
void turn_by_exif(PictureFile& file, int orientation);

/// The pixel as it is stored that the upright picture shows at (x, y): orientations 5 to 8 lie on
/// their side (CIPA DC-008, 4.6.5).
std::size_t stored_place(const PictureFile& file, int x, int y);

/// Whether there is a reader for what begins so.
bool begins_as_picture(std::span<const std::byte> bytes);

/// Planes hold what is there in place of what is shown.
void take_data_window(PictureFile& file);

/// Values of planes that lie on pixels `from` for pixels `to`; where there are none, `outside`.
PlaneValues moved(const PlaneValues& values, const PictureBox& from, const PictureBox& to,
                  float outside);

/// The pixels of a file's planes.
inline PictureBox box_of(const PictureFile& file) {
  return {file.left, file.top, file.width, file.height};
}

/// Reads the header. Throws FileError that names the file: for what is no picture, is damaged, has
/// a side beyond kMaxImageSize, or claims more values than so few bytes can hold. For other kinds
/// of pictures it names the program that converts them.
PictureFile open_picture_file(const std::filesystem::path& path);
PictureFile open_picture_file(Bytes bytes, const std::filesystem::path& path);

/// The height of a file that is read by rows.
inline constexpr int kMostRows = 1 << 20;

/// Opens a file that stays on the disk, for rows_of(). Nothing, with the reason in `why`, if it is
/// of a kind that is read whole, no regular file, or cannot be opened.
std::optional<PictureFile> open_on_disk(const std::filesystem::path& path, std::string& why);

/// A reader of bands of these planes. Its errors name the file.
ReadRows rows_of(const PictureFile& file, std::vector<std::size_t> planes);

/// The planes with these indices. Pixels that an EXR lacks are `outside`. Throws FileError that
/// names the file, or for more values than the machine has memory.
std::vector<PlaneValues> read_planes(const PictureFile& file, std::span<const std::size_t> planes,
                                     float outside);

/// Throws FileError for a side that is not 1 to kMaxImageSize, or a height not 1 to `most_rows`.
/// `kind`: "the PNG".
void check_picture_size(std::string_view kind, std::int64_t width, std::int64_t height,
                        int most_rows = kMaxImageSize);

/// For that check: what the file may have.
inline int most_rows_of(const PictureFile& file) { return file.disk ? kMostRows : kMaxImageSize; }

/// "a.R", "a.G", ...: the names of all planes, for messages.
std::string plane_names(const PictureFile& file);

/// Channels that make up a colour.
struct ColourLayer {
  std::string name;                          ///< what stands before ".R"; empty for plain R, G, B
  std::size_t red = 0, green = 0, blue = 0;  ///< all the same if it is grey
  std::optional<std::size_t> alpha{};
};

/// All of them, in the file's order.
std::vector<ColourLayer> colour_layers(const PictureFile& file);

/// Turns a colour's planes into halves of linear light. Numbers beyond the largest half are cut to
/// it, NaN becomes 0.
class ColourHalves {
 public:
  /// `with_alpha`: and its alpha, if it has one. `light`: colours are multiplied by it.
  ColourHalves(const PictureFile& file, const ColourLayer& layer, bool with_alpha,
               float light = 1.0f);

  /// The planes to read: one if it is grey.
  const std::vector<std::size_t>& planes() const { return planes_; }
  /// Puts the values of planes()[i] into as many pixels of RGBA16F.
  void put(std::size_t i, const PlaneValues& values, Image& picture);

  /// How many colours were cut to the largest half so far.
  std::size_t cut() const { return cut_; }

 private:
  struct Channel {
    std::size_t first, last;  // of the picture
    NumberType type;
    std::vector<std::uint16_t> table;  // of whole numbers up to 16 bits; else empty
    float light;
  };
  std::vector<std::size_t> planes_{};
  std::vector<Channel> channels_{};
  std::size_t cut_ = 0;
};

/// Why this build converts no profiles, as a sentence; empty if it does.
std::string_view missing_lcms();

/// Turns numbers of 0 to `full` along the file's profile into light of sRGB's primaries, which may
/// be below 0. Throws FileError, the file unnamed, for a profile that cannot be used.
void profile_to_light(const PictureFile& file, double full, const std::array<PlaneValues*, 3>& rgb);

/// The largest finite number, without its sign.
float brightest_of(std::span<const float> values);

/// Whether finite colours may be beyond the largest half.
bool may_be_bright(const PictureFile& file, const ColourLayer& layer);

/// A colour and, if `with_alpha`, its alpha as RGBA16F in linear light; else alpha is 0. Bright
/// colours are divided by 2^most_power at the most.
Picture read_colour(const PictureFile& file, const ColourLayer& layer, bool with_alpha,
                    int most_power = 0);

/// Values, one a pixel, as the nearest halves of an RGBA16F picture's alpha.
void put_in_alpha(const PlaneValues& values, Image& picture);

}  // namespace softfocus
