#include "tools/refocus/refocused_file.h"

#include "tools/pictures/exr_file.h"

namespace softfocus {

bool is_of_exr(FileFormat format) {
  return format == FileFormat::exr || format == FileFormat::exr_float;
}

std::vector<std::size_t> kept_planes(const RefocusOptions& options, const PictureSources& sources) {
  const bool is_exr = sources.colour_file.reader == &kExrReader;
  return options.keep_layers && is_exr ? other_planes(sources) : std::vector<std::size_t>{};
}

std::vector<std::size_t> other_planes(const PictureSources& sources) {
  std::vector<std::size_t> others;
  const ColourLayer& colour = sources.colour;
  for (std::size_t i = 0; i < sources.colour_file.planes.size(); ++i) {
    const bool is_colour =
        i == colour.red || i == colour.green || i == colour.blue || i == colour.alpha;
    const bool is_depth = !sources.depth_file && i == sources.depth_plane;
    if (!is_colour && !is_depth) others.push_back(i);
  }
  return others;
}

bool keeps_alpha(FileFormat format) {
  return is_of_exr(format) || format == FileFormat::png || format == FileFormat::png_16;
}

Bytes refocused_file(const RefocusOptions& options, const PictureSources& sources,
                     const DepthMap& depth, const UsedRefocus& used, const PictureOnItsWay& result,
                     const PictureNotes& notes) {
  PictureExtras extras{.alpha = result.opacity};
  PlaneValues radii_px;
  std::vector<std::size_t> kept;
  if (is_of_exr(options.format) && options.show == RefocusShow::image) {
    radii_px = circle_radii(depth, used);
    extras.radii_px = radii_px;
    extras.depth_m = depth.metres;
    if (sources.colour_file.reader == &kExrReader) {
      kept = kept_planes(options, sources);
      extras.source = &sources.colour_file;
      extras.kept = kept;
    }
  }
  return encode_with_notes(result.picture, options.format, notes, extras);
}

}  // namespace softfocus
