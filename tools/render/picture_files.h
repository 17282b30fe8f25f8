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

/// The circles of what was drawn; those beyond the limit are cut so far that it can be seen.
CircleSizes cut_circles(const ConstImageView& drawn, const UsedLens& used, ThreadPool& pool);

/// Them as a line, or nothing.
std::string cut_warning(const CircleSizes& sizes, const RenderOptions& options,
                        const UsedLens& used);

}  // namespace softfocus
