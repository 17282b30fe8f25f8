#pragma once
// A colour and its depth from one file or two, as `refocus` and `inspect` read them.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "raster/numbers/parameter.h"
#include "tools/cli/parser.h"
#include "tools/pictures/picture_notes.h"
#include "tools/refocus/chosen_layers.h"
#include "tools/refocus/depth/depth_encodings.h"
#include "tools/refocus/depth/depth_map.h"
#include "tools/refocus/depth/mend_depth.h"
#include "tools/refocus/depth/phone_depth.h"
#include "tools/refocus/photo_lens.h"

namespace softfocus {

/// How a depth of another shape than the picture lies on it: stretched in one direction, or its
/// middle, of the picture's shape.
enum class DepthFit : std::uint8_t { stretch, crop };

// The choices of --holes and --depth-fit, which the simulator's page has too.
inline constexpr std::array kHoles{
    Choice<Holes>{"background", Holes::background}, Choice<Holes>{"near", Holes::near_side},
    Choice<Holes>{"far", Holes::far_side}, Choice<Holes>{"infinity", Holes::infinity},
    Choice<Holes>{"refuse", Holes::refused}};
inline constexpr const char* kHolesText =
    "What is not known is background, infinitely far, if it touches the border or is larger than "
    "things, and else filled from the far side; or all is filled from the near or far side, or "
    "infinitely far, or refused (default: background)";
inline constexpr std::array kDepthFits{Choice<DepthFit>{"stretch", DepthFit::stretch},
                                       Choice<DepthFit>{"crop", DepthFit::crop}};
inline constexpr const char* kDepthFitText =
    "A depth of another shape than the picture is stretched, or its middle is taken (default: "
    "stretched by up to 2 %, else refused)";

/// How files are taken, whatever is in them.
struct FileReading {
  bool flips = false;    ///< rows of PFM files run the other way
  bool to_srgb = false;  ///< colours of an ICC profile are converted
};

/// Adds --flip and --icc.
void add_file_options(CLI::App& parser, FileReading& files);
/// For a file of colours or a depth.
void take(const FileReading& files, PictureFile& file);

struct DepthOptions {
  std::optional<std::string> layer;  ///< of the colour
  std::optional<std::string> depth_layer;
  std::optional<std::string> mask;          ///< a file that is 0 where the depth is missing
  const DepthEncoding* encoding = nullptr;  ///< none: as believed
  DepthNumbers numbers;
  std::optional<DepthAlong> along;  ///< none: the encoding's
  std::vector<double> missing_codes;
  Holes holes = Holes::background;
  std::optional<DepthFit> fit;  ///< none: stretched by up to 2 %
  FileReading files;
  Mending mending;
};

/// Adds --layer, --depth-layer, --depth-encoding, its numbers, --depth-along, --missing, --mask,
/// --holes, --depth-fit and the three ways of mending.
void add_depth_options(CLI::App& parser, DepthOptions& options);

inline constexpr std::size_t kNoPlane = ~std::size_t{0};

/// Another view of a picture, as a right eye's.
struct OtherView {
  std::string name;
  ColourLayer colour{};
  std::size_t depth_plane = kNoPlane;
};

/// Files whose headers were read. The colour's has all pixels that are there, beside those that are
/// shown too, if the depth has the same size.
struct PictureSources {
  PictureFile colour_file;
  std::optional<PictureFile> depth_file{};  ///< none: the colour's
  std::optional<PhoneDepth> phone{};        ///< the depth's file came inside of the colour's
  ColourLayer colour{};
  std::size_t depth_plane = 0;
  std::optional<PictureNotes> notes{};  ///< of the colour's file
  HeaderLens lens{};                    ///< likewise, if there are no notes

  std::string view{};              ///< the colour's, of several that are not chosen from
  std::vector<OtherView> views{};  ///< the others that have a colour

  const PictureFile& of_depth() const { return depth_file ? *depth_file : colour_file; }
};

/// Finds the views beside that of the chosen colour; its depth is of the same.
void find_views(PictureSources& sources);
/// Exchanges the colour and its depth with another view's.
void exchange(PictureSources& sources, OtherView& view);

/// Opens COLOUR and, unless it is empty, DEPTH, else a depth inside of a JPEG, and chooses layers.
/// Throws FileError; UsageError for layers that are not there and a depth of another shape than the
/// colour.
PictureSources open_sources(const std::string& colour, const std::string& depth,
                            const DepthOptions& options);

/// Opens files that stay on the disk. Nothing, with the reason in `why`, if one of them is read
/// whole, or they differ in size.
std::optional<PictureSources> open_sources_on_disk(const std::string& colour,
                                                   const std::string& depth,
                                                   const DepthOptions& options, std::string& why);

/// The lens with what the colour's file says.
PhotoLens with_sources(PhotoLens photo, const PictureSources& sources);

/// A depth map and how it was read.
struct ReadDepth {
  DepthMap map{};  ///< of the colour's size, nothing missing
  NumbersSeen seen{};
  const DepthEncoding* encoding = nullptr;
  DepthNumbers numbers{};  ///< as used; of an encoding by_ends with the map's
  std::string why{};       ///< of a believed encoding
  bool is_guess = false;   ///< the numbers alone say what they mean
  DepthAlong along = DepthAlong::axis;
  int width = 0, height = 0;  ///< of the file's map, its middle if that is taken
  std::string fit{};          ///< of another shape than the colour: a clause
  DepthEnds ends{};
  std::size_t filled = 0;      ///< missing depths of the map
  std::size_t background = 0;  ///< of these those that became infinitely far
  MendedDepth mended{};
};

/// The encoding that the depth's file says or its numbers suggest.
BelievedEncoding believed_encoding(const PictureSources& sources, const NumbersSeen& seen);

/// The numbers that were given, and those that the file says of that encoding.
DepthNumbers depth_numbers(const PictureSources& sources, const DepthOptions& options,
                           const DepthEncoding* encoding);

/// Settles the encoding, asked for or believed by `read.seen`. Throws UsageError if it cannot be
/// told or lacks numbers.
void settle_encoding(const PictureSources& sources, const DepthOptions& options, ReadDepth& read);

/// How the codes of the depth's file are read then, but for their ends.
DepthReading depth_reading(const PictureSources& sources, const DepthOptions& options,
                           const PhotoLens& photo, const ReadDepth& read);

/// Reads the depth of `sources`, mends it beside `colour` (RGBA16F) and fills what is missing.
/// Throws FileError; UsageError for an encoding that cannot be told or lacks numbers, and missing
/// depths that are not to be filled.
ReadDepth read_depth(const PictureSources& sources, const Image& colour,
                     const DepthOptions& options, const PhotoLens& photo, ThreadPool& pool);

// The alpha of a picture that is refocused. Colour is filtered multiplied by it, and alpha as the
// colour of a second picture with the same depth: so each method treats both alike, and what was
// one straight colour stays it.

/// The alpha of the colour of `sources`, 0 to 1 a pixel, by which `colour` is multiplied here
/// unless the file's is (EXR). Empty if there is none, or if it is no alpha: numbers beyond 0 and
/// 1 of other files than EXR, and a fourth channel of NumPy files of ours, are depths.
PlaneValues take_opacity(const PictureSources& sources, Image& colour);

/// Whether an alpha is one whatever its numbers are. Renderers' filters leave an EXR's a little
/// below 0 and above 1.
bool is_sure_of_alpha(const PictureFile& file);

/// Whether the alpha of `sources` may be one by what its file is, and need but be within 0 and 1.
bool may_be_opacity(const PictureSources& sources);

/// The numbers of the file's alpha, of that full scale, as opacity, cut to 0 and 1 (NaN is 0), by
/// which `colour` is multiplied unless the file's is.
void take_opacity(const PictureFile& file, float whole, PlaneValues& alpha, Image& colour);

/// Whether any pixel is not opaque.
bool is_transparent(const PlaneValues& opacity);

/// A picture whose red, green and blue are the opacity, with the depths of `like`.
Image opacity_picture(const PlaneValues& opacity, const Image& like);

/// The way back, cut to 0 and 1.
PlaneValues opacity_of(const Image& picture);

}  // namespace softfocus
