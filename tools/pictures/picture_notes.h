#pragma once
// Notes in a picture's file on how it was made: its lens, field of view and method.
//
//   PNG        in the file: `Software` (tEXt) and `softfocus` (iTXt), the notes as JSON
//   EXR        in the file: the attribute `softfocus`
//   PFM, NPY, HDR   a sidecar beside it, its name and ".json", with the same JSON and the hash of
//              the picture's file, by which a sidecar that is left from another picture shows

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "dof/lens.h"
#include "tools/files/json.h"
#include "tools/pictures/exr_file.h"

namespace softfocus {

/// The lens, and the camera behind it.
struct NotedLens {
  ThinLens lens;
  double coc_scale = 1.0;
  double fov_y_degrees = 40.0;
};

/// Adds the lens's numbers to an object, by the keys of scene files.
void add_lens(Json& json, const ThinLens& lens, double coc_scale);

struct PictureNotes {
  std::string scene;
  double frame = 0.0;
  int width = 0;
  int height = 0;
  std::string show;
  double fov_y_degrees = 40.0;
  std::optional<NotedLens> lens;       ///< none of a picture without one, as the pinhole's
  Json method;                         ///< its name and settings; null if none was at work
  std::vector<std::string> effects{};  ///< "gaussian:sigma=2", in the order in which they came
  std::uint64_t picture_hash = 0;      ///< hash_image() of the RGBA16F picture
};

Json notes_json(const PictureNotes& notes);

/// The notes in a JSON text, or nullopt if it is not one that notes_json() gave.
std::optional<PictureNotes> parse_notes(std::string_view text);

/// A picture's file with its notes and the extras in it, as far as the format can. `hash`, if any,
/// gives the notes their hash, and is asked when all else is encoded.
Bytes encode_with_notes(const Image& image, FileFormat format, PictureNotes notes,
                        const PictureExtras& extras = {},
                        const std::function<std::uint64_t()>& hash = {});

/// Whether a format keeps its notes in a sidecar.
bool needs_sidecar(FileFormat format);

/// The picture's name and ".json".
std::filesystem::path sidecar_of(const std::filesystem::path& picture);

/// The sidecar of an output, if its format has one. There is none beside standard output, a device
/// or a pipe.
std::optional<std::filesystem::path> sidecar_place(const std::string& output, FileFormat format);

/// The sidecar's text for a picture with these bytes.
std::string sidecar_text(const PictureNotes& notes, const ByteSource& picture);

/// Whether a sidecar can stand there: there is nothing, or one that may be replaced.
bool is_free_for_sidecar(const std::filesystem::path& sidecar);

/// What is said if it cannot.
std::string busy_sidecar_warning(const std::filesystem::path& sidecar);

/// The notes that belong to a picture, and where they stand.
struct FoundNotes {
  std::optional<PictureNotes> notes;
  std::filesystem::path place;  ///< the picture's file or the sidecar
  bool stale = false;           ///< a sidecar is there, but of another picture: no notes
};

/// `bytes` are those of the file `picture`. Other text counts as no notes.
FoundNotes find_notes(const std::filesystem::path& picture, const ByteSource& bytes);

}  // namespace softfocus
