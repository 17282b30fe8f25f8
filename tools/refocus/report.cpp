#include "tools/refocus/report.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/files/hash_text.h"

namespace softfocus {
namespace {

std::string circles_text(const ReadDepth& depth) {
  return short_number(depth.numbers.least_code) + " to " +
         short_number(depth.numbers.largest_code) + " px radius";
}

std::string lines_of_lens(const SettledLens& lens) {
  std::string text = "focus            " + short_number(static_cast<double>(lens.coc.focus_m)) +
                     " m, by " + lens.focus_from;
  if (lens.range) {
    text += "; sharp from " + short_number(lens.range->near_m) + " m to " +
            short_number(lens.range->far_m) + " m";
  }
  if (lens.has_lens) {
    text += "\nlens             " + short_number(lens.lens.focal_length_mm) + " mm, f/" +
            short_number(lens.lens.f_number) + ", coc scale " + short_number(lens.coc_scale) +
            ", by " + lens.lens_from + "\nfield of view    " + short_number(lens.fov_y_degrees) +
            " degrees from top to bottom, by " + lens.camera_from;
  }
  return text + "\nblur at infinity " +
         short_number(static_cast<double>(lens.coc.radius_at_infinity_px)) + " px radius\n";
}

/// "0.71 m to 12 m" of a map without missing depths.
std::string depth_range_text(const DepthEnds& ends) {
  if (ends.far_m == 0.0) return "nothing nearer than infinity";
  return short_number(ends.near_m) + " m to " + short_number(ends.far_m) + " m" +
         (ends.has_infinite ? ", and infinity" : "");
}

std::string percent_text(std::size_t count, std::size_t of) {
  return short_number(std::round(1000.0 * static_cast<double>(count) / static_cast<double>(of)) /
                      10.0) +
         " %";
}

/// The pixels without a depth, and what became of them.
std::string holes_text(const ReadDepth& depth, Holes holes) {
  const std::size_t all =
      static_cast<std::size_t>(depth.width) * static_cast<std::size_t>(depth.height);
  const std::size_t from_side = depth.filled - depth.background;
  std::string infinite = percent_text(depth.background, all) + " have none and are background";
  const std::string filled = percent_text(from_side, all) + " have none and are filled from the " +
                             (holes == Holes::near_side ? "near" : "far") + " side";
  if (from_side == 0) return infinite;
  return depth.background == 0 ? filled : infinite + ", " + filled;
}

/// Whether a guess puts so much where few pictures have anything that it may be wrong.
bool is_odd(const ReadDepth& depth) {
  const DepthEnds& ends = depth.ends;
  return depth.is_guess && ends.finite > 0 &&
         2 * std::max(ends.beyond_100_m, ends.within_1_cm) >= ends.finite;
}

}  // namespace

std::string depth_line(const RefocusOptions& options, const PictureSources& sources,
                       const ReadDepth& depth, const UsedRefocus& used) {
  std::string line = options.circles
                         ? "the circles are " + circles_text(depth)
                         : "the depth is " + std::string{depth.encoding->name} +
                               (depth.along == DepthAlong::ray ? " along the ray, " : ", ") +
                               depth_range_text(depth.ends) +
                               (depth.why.empty() ? "" : " (believed: " + depth.why + ")");
  if (depth.filled > 0) line += "; " + holes_text(depth, options.reading.holes);
  if (!depth.fit.empty()) line += "; " + depth.fit;
  const int orientation = sources.colour_file.exif_orientation;
  if (orientation != 1) line += "; EXIF turns the picture, " + std::to_string(orientation);
  const std::string& icc = sources.colour_file.icc_name;
  if (!icc.empty()) {
    line += sources.colour_file.to_srgb ? "; the colours are converted to sRGB from the profile "
                                        : "; the colours are of the profile ";
    line += icc;
  }
  if (used.light_power > 0) {
    line += "; colours up to " + short_number(used.brightest) + " are filtered at 1/" +
            std::to_string(1 << used.light_power) + " of their light";
  }
  return line;
}

std::string odd_depth_warning(const PictureSources& sources, const ReadDepth& depth) {
  if (!is_odd(depth)) return {};
  const DepthEnds& ends = depth.ends;
  const bool is_far = ends.beyond_100_m >= ends.within_1_cm;
  return "'" + sources.of_depth().path.string() + "' is taken for " +
         std::string{depth.encoding->name} + ", which puts " +
         percent_text(is_far ? ends.beyond_100_m : ends.within_1_cm, ends.finite) +
         (is_far ? " beyond 100 m" : " within 1 cm") +
         "; give the --depth-encoding: midas or inverse if large numbers are near, millimetres, "
         "centimetres, metres with a --scale";
}

std::string_view name_of(DepthAlong along) { return along == DepthAlong::axis ? "axis" : "ray"; }

std::string refocus_text(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used) {
  const PictureFile& file = sources.of_depth();
  std::string text = "colour           " + options.colour +
                     (sources.colour.name.empty() ? "" : ", layer " + sources.colour.name) +
                     "\ndepth            " + file.path.string() + ", channel " +
                     file.planes[sources.depth_plane].name + ", " +
                     std::string{depth.encoding->name} + " along the " +
                     std::string{name_of(depth.along)} +
                     (depth.why.empty() ? "" : " (believed: " + depth.why + ")") + "\n";
  if (!options.circles) text += "                 " + depth_range_text(depth.ends) + "\n";
  if (depth.filled > 0) {
    text += "                 " + holes_text(depth, options.reading.holes) + "\n";
  }
  if (!depth.fit.empty()) text += "                 " + depth.fit + "\n";
  if (depth.mended.upsampled) {
    text +=
        "                 " + size_text({depth.width, depth.height}) + " pixels, brought to " +
        size_text({depth.map.width, depth.map.height}) +
        (options.reading.mending.by_colour ? " along the colours' edges\n" : " by the nearest\n");
  }
  if (options.reading.mending.edges) {
    text += "                 " + std::to_string(depth.mended.edge_pixels) +
            " pixels between two surfaces given to one\n";
  }
  text +=
      options.circles ? "circles          " + circles_text(depth) + "\n" : lines_of_lens(used.lens);
  if (used.choice)
    text += "chosen           " + setting_text(*used.choice) + ": " + used.choice->reason + "\n";
  if (options.show == RefocusShow::image) {
    text += "method           " + std::string{used.method->name} + ", circles up to " +
            short_number(static_cast<double>(used.settings.max_coc_px)) + " px radius\n";
  }
  if (options.unmix) {
    text += "edges            " + std::to_string(used.unmixed_pixels) + " pixels taken apart\n";
  }
  if (used.by_rows) text += "read             a band of rows at a time\n";
  if (!used.why_whole.empty()) text += "read             whole: " + used.why_whole + "\n";
  return text;
}

std::string refocus_json(const RefocusOptions& options, const PictureSources& sources,
                         const ReadDepth& depth, const UsedRefocus& used, std::uint64_t hash) {
  const PictureFile& file = sources.of_depth();
  const DepthEnds& ends = depth.ends;
  const SettledLens& lens = used.lens;
  Json json{{"colour", options.colour},
            {"layer", sources.colour.name},
            {"depth", file.path.string()},
            {"depth_channel", file.planes[sources.depth_plane].name},
            {"depth_encoding", depth.encoding->name},
            {"depth_along", name_of(depth.along)},
            {"depth_believed", nullptr},
            {"width", depth.map.width},
            {"height", depth.map.height},
            {"nearest_m", number_or_null(ends.near_m)},
            {"farthest_m", number_or_null(ends.far_m)},
            {"filled_pixels", static_cast<std::int64_t>(depth.filled)},
            {"background_pixels", static_cast<std::int64_t>(depth.background)},
            {"mended_edge_pixels", static_cast<std::int64_t>(depth.mended.edge_pixels)},
            {"unmixed_pixels", static_cast<std::int64_t>(used.unmixed_pixels)},
            {"focus_m", lens.coc.focus_m},
            {"focus_from", lens.focus_from},
            {"radius_at_infinity_px", lens.coc.radius_at_infinity_px},
            {"largest_circle_px", used.largest_circle_px},
            {"max_coc_px", used.settings.max_coc_px},
            {"method", nullptr},
            {"lens", nullptr},
            {"by_rows", used.by_rows},
            {"why_whole", nullptr},
            {"picture_hash", hash_text(hash)}};
  if (!depth.why.empty()) json["depth_believed"] = depth.why;
  if (!used.why_whole.empty()) json["why_whole"] = used.why_whole;
  if (options.show == RefocusShow::image) json["method"] = used.method->name;
  if (options.circles) {
    for (const char* key : {"nearest_m", "farthest_m", "focus_m", "radius_at_infinity_px"}) {
      json[key] = nullptr;
    }
  }
  if (lens.has_lens) {
    json["lens"] = {{"focal_length_mm", lens.lens.focal_length_mm},
                    {"f_number", lens.lens.f_number},
                    {"coc_scale", lens.coc_scale},
                    {"lens_from", lens.lens_from},
                    {"fov_y_degrees", lens.fov_y_degrees},
                    {"camera_from", lens.camera_from}};
  }
  return json_text(json, 2) + "\n";
}

PictureNotes refocus_notes(const RefocusOptions& options, const UsedRefocus& used, int width,
                           int height, std::uint64_t hash) {
  PictureNotes notes{.scene = std::filesystem::path{options.colour}.filename().string(),
                     .width = width,
                     .height = height,
                     .show = options.show == RefocusShow::image ? "image"
                             : options.show == RefocusShow::coc ? "coc"
                                                                : "depth",
                     .fov_y_degrees = used.lens.fov_y_degrees,
                     .lens = {},
                     .method = {},
                     .picture_hash = hash};
  if (options.show == RefocusShow::image) {
    notes.method = {{"name", used.method->name},
                    {"max_coc_px", used.settings.max_coc_px},
                    {"leak", used.settings.leak},
                    {"arithmetic", arithmetic_name(options.arithmetic)},
                    {"profile", options.profile_name}};
    if (options.aperture != Aperture{}) {
      notes.method["aperture"] = aperture_json(options.aperture);
    }
    if (options.highlights) {
      notes.method["highlights"] = {{"gain", options.highlights->gain},
                                    {"threshold", options.highlights->threshold}};
    }
    if (options.border != Border::by_method) notes.method["border"] = name_of(options.border);
    if (options.unmix) notes.method["unmix_edges"] = true;
  }
  if (used.lens.has_lens) notes.lens = {used.lens.lens, used.lens.coc_scale, notes.fov_y_degrees};
  return notes;
}

void tell(const RefocusOptions& options, const PictureSources& sources, const ReadDepth& depth,
          const UsedRefocus& used, std::uint64_t hash, Refocused& made) {
  for (const std::string& fault : sources.lens.faults) {
    made.warnings.push_back("'" + options.colour + "': " + fault + "; it is ignored");
  }
  if (const std::string& camera = sources.lens.camera; !camera.empty() && !options.circles) {
    made.warnings.push_back("'" + options.colour + "' says that its camera is " + camera +
                            ", and a lens's circles are a perspective's; --circles FILE takes "
                            "those of any camera");
  }
  if (std::string odd = odd_depth_warning(sources, depth); !odd.empty()) {
    made.warnings.push_back(std::move(odd));
  }
  if (options.show == RefocusShow::image && used.largest_circle_px >= kLargestMaxCoc) {
    made.warnings.push_back("circles of more than " +
                            std::to_string(static_cast<int>(kLargestMaxCoc)) +
                            " pixels are cut to that; a larger --f-number has smaller ones");
  }
  if (used.cut > 0) {
    made.warnings.push_back(cut_light_warning(options.colour, used.cut, used.light_power));
  }
  if (const std::string lost = lost_profile_warning(sources.colour_file, options.format);
      !lost.empty()) {
    made.warnings.push_back(lost);
  }
  made.depth = depth_line(options, sources, depth, used);
  made.report = refocus_text(options, sources, depth, used);
  made.json = refocus_json(options, sources, depth, used, hash);
}

std::string cut_light_warning(const std::string& colour, std::size_t cut, int light_power) {
  const std::string most = short_number(std::ldexp(65504.0, light_power));
  return "'" + colour + "': colours beyond " + most + " or infinite are cut to that, in " +
         std::to_string(cut) + " values; divide all by a power of two before, multiply after";
}

std::string lost_profile_warning(const PictureFile& file, FileFormat format) {
  const bool is_kept = keeps_profile(format) && !file.icc.empty();
  if (file.icc_name.empty() || file.to_srgb || is_kept) return {};
  return "'" + file.path.string() + "' has colours of the profile " + file.icc_name +
         ", which the result has no place for: programs will take them for sRGB; " +
         (file.icc.empty() ? "it is no profile of red, green and blue"
                           : ".png keeps it, and --icc srgb converts the colours");
}

std::string lost_view_warning(const std::string& colour, const OtherView& view) {
  return "'" + colour + "' has a view " + view.name +
         ", which the result leaves out; an .exr with " + "its layers has it, and --layer '" +
         view.colour.name + "' chooses it";
}

std::string lost_alpha_warning(const std::string& colour) {
  return "'" + colour +
         "' is transparent in places; the result's format has no alpha, and black there; .exr and "
         ".png have";
}

}  // namespace softfocus
