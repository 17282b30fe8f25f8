#pragma once
// OpenEXR, where the build has the library.

#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/lens.h"
#include "raster/threads/parallel.h"
#include "tools/files/byte_source.h"
#include "tools/pictures/image_file.h"

namespace softfocus {

/// Why this build has no OpenEXR and how to get it, as a sentence; empty if it has.
std::string_view missing_exr();

enum class ExrNumbers : std::uint8_t { half, single };

struct PictureFile;

/// A plane of another EXR that gets other values.
struct ReplacedPlane {
  std::size_t plane = 0;
  std::vector<float> values{};  ///< a number a pixel
};

/// Data to write beside a picture, and its depth in alpha. Each may be empty; the planes have a
/// number a pixel. PNG takes the alpha alone, EXR all, other formats nothing.
struct PictureExtras {
  std::span<const float> alpha{};       ///< 0 to 1: the picture's colour is multiplied by it
  std::span<const float> depth_m{};     ///< channel Z, in place of the picture's own halves
  bool has_depth = true;                ///< whether there is a channel Z at all
  std::span<const float> radii_px{};    ///< channel coc, negative nearer than the focus
  std::optional<ThinLens> lens{};       ///< attributes focus, aperture, nominalFocalLength
  const PictureFile* source = nullptr;  ///< an EXR: its attributes, windows, and of its planes
  std::span<const std::size_t> kept{};  ///< these, as they are, unless a name above is theirs
  std::span<const ReplacedPlane> replaced{};  ///< or so
  std::string view{};                         ///< of the picture, if the planes are of others
  int light_power = 0;  ///< colours are multiplied by 2^light_power: of an EXR in floats then
  std::span<const std::byte> icc{};  ///< a profile of the colours, for a PNG
  ThreadPool* pool = nullptr;        ///< whose threads encode, if any
};

/// An RGBA16F picture: R, G, B in halves or floats, and alpha, the depth in metres, as the float
/// channel Z. `notes`, if any, become the attribute `softfocus`. ZIP-compressed: the values are the
/// same everywhere, the file's bytes are zlib's. `notes_after`: see PictureToWrite. Throws
/// FileError.
Bytes encode_exr(const Image& image, ExrNumbers numbers, const std::string& notes,
                 const PictureExtras& extras = {},
                 const std::function<std::string()>& notes_after = {});

/// A depth in metres as the float channel Z.
Bytes encode_depth_exr(std::span<const float> values, int width, int height);

/// The attribute `softfocus` of such a file, or nothing.
std::optional<std::string> find_exr_notes(const ByteSource& bytes);

/// The lens in a file's header, each value if it is there: the standard attributes `focus`,
/// `aperture` and `nominalFocalLength`.
struct HeaderLens {
  std::optional<double> focus_m{};
  std::optional<double> f_number{};
  std::optional<double> focal_length_mm{};
  std::string camera{};               ///< "orthographic" or "panoramic" if the file says so
  std::vector<std::string> faults{};  ///< attributes that no lens can have, as clauses
};

/// The lens of an EXR; else nothing. Does not throw.
HeaderLens find_exr_lens(const ByteSource& bytes);

/// By the first bytes.
inline bool is_exr(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0;
}

}  // namespace softfocus
