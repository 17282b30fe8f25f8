#pragma once
// A render's files beside the pixels: its notes, and warnings of what the picture lacks.

#include <filesystem>
#include <optional>
#include <string>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "scenes/scene.h"
#include "tools/pictures/picture_notes.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"

namespace softfocus {

/// Throws UsageError if the picture, its sidecar or the report would be written over what the
/// picture is made from.
void check_outputs(const RenderOptions& options, const Scene& scene);

/// How the picture was made.
PictureNotes notes_of(const RenderOptions& options, const RenderRecord& record);

/// The file of a layer behind the first, which is layer 1: FILE.png becomes FILE.layer2.png.
std::filesystem::path layer_place(const RenderOptions& options, std::size_t layer);

/// The file of --depth-output: what the picture has in alpha.
Bytes depth_bytes(const RenderOptions& options, const Image& picture);

/// The sidecar's path: none for a format that has notes inside, standard output, a device or a
/// pipe.
std::optional<std::filesystem::path> sidecar_place(const RenderOptions& options);

/// Whether the largest circle is the scene's default, and larger ones are cut to it.
bool cuts_by_default(const RenderOptions& options);

/// Whether the largest circle is the picture's own, as the method takes no longer for it.
bool takes_all_circles(const RenderOptions& options);

/// The circles that are cut so far that it can be seen, as a line, or nothing.
std::string cut_warning(const Image& drawn, const RenderOptions& options, const UsedLens& used,
                        ThreadPool& pool);

}  // namespace softfocus
