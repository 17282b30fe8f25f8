#include "tools/refocus/picture_with_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "raster/images/image.h"
#include "raster/numbers/half.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

constexpr std::array kUpsamplings{Choice<bool>{"colour", true}, Choice<bool>{"nearest", false}};
constexpr std::array kAlongs{Choice<DepthAlong>{"axis", DepthAlong::axis},
                             Choice<DepthAlong>{"ray", DepthAlong::ray}};
constexpr std::array kIccs{Choice<bool>{"keep", false}, Choice<bool>{"srgb", true}};

void add_mending_options(CLI::App& parser, Mending& mending) {
  add_choice(parser, "--upsample",
             "A map smaller than the picture grows along the colours' edges, or by its nearest "
             "pixel (default: colour)",
             kUpsamplings, mending.by_colour);
  add_flag(parser, "--mend-edges",
           "Depth between two surfaces, as anti-aliasing leaves it, becomes that of one of them",
           mending.edges);
  add_flag(parser, "--mend-bands", "Steps of a depth of 8 bits become slopes", mending.bands);
}

/// A file whose values hide depths, as a mask of the map's size.
PlaneValues read_mask(const std::string& name, const PictureFile& depth, bool flips) {
  PictureFile file = open_picture_file(name);
  take({flips}, file);
  const bool is_on_all = file.width == depth.width && file.height == depth.height;
  const PictureBox place = is_on_all ? box_of(depth) : depth.shown;
  if (file.width != place.width || file.height != place.height) {
    throw UsageError("--mask '" + name + "' is " + size_text({file.width, file.height}) +
                     " pixels and the depth " + size_text({place.width, place.height}) +
                     "; give one of that size");
  }
  // An EXR's first channel would be its alpha.
  const std::size_t plane = file.planes.size() == 1 ? 0 : choose_colour(file, {}, "--mask").red;
  return moved(read_planes(file, {&plane, 1}, 0.0f)[0], place, box_of(depth), 1.0f);
}

/// How much wider or higher than a depth's the colour's shape is: 1 of the same.
double stretching(const PictureFile& colour, int depth_width, int depth_height) {
  const double across = static_cast<double>(colour.width) / depth_width;
  const double down = static_cast<double>(colour.height) / depth_height;
  return std::max(across, down) / std::min(across, down);
}
double stretching(const PictureFile& colour, const PictureFile& depth) {
  return stretching(colour, depth.width, depth.height);
}

/// A map of an odd size is the half of one rounded either way.
bool has_shape_of(const PictureFile& colour, const PictureFile& depth) {
  return stretching(colour, depth) <= 1.0 + 1.5 / std::min(depth.width, depth.height);
}

void check_shape(const PictureFile& colour, const PictureFile& depth, const DepthOptions& options) {
  constexpr double kLittle = 1.02;  // networks want sides of multiples of 14 or 32
  const bool is_near = stretching(colour, depth) <= kLittle;
  if (options.fit || is_near || has_shape_of(colour, depth)) return;
  const bool is_turned = (colour.exif_orientation >= 5) != (depth.exif_orientation >= 5) &&
                         stretching(colour, depth.height, depth.width) <= kLittle;
  throw UsageError(
      "'" + depth.path.string() + "' is " + size_text({depth.width, depth.height}) +
      " pixels and the colour " + size_text({colour.width, colour.height}) + ", another shape; " +
      (is_turned ? "the EXIF orientation of one turns it: turn the other's pixels likewise"
                 : "give a depth of the same part of the picture") +
      ", or --depth-fit stretch or crop");
}

/// The part of a map that lies on the picture.
struct Part {
  int x = 0, y = 0, width = 0, height = 0;
};
Part part_on(const PictureFile& colour, const PictureFile& depth, const DepthOptions& options) {
  Part part{0, 0, depth.width, depth.height};
  if (options.fit != DepthFit::crop || has_shape_of(colour, depth)) return part;
  const double shape = static_cast<double>(colour.width) / colour.height;
  const auto whole = [](double side, int most) {
    return std::clamp(static_cast<int>(std::floor(side + 0.5)), 1, most);
  };
  if (shape * depth.height < depth.width) {
    part.width = whole(shape * depth.height, depth.width);
    part.x = (depth.width - part.width) / 2;
  } else {
    part.height = whole(depth.width / shape, depth.height);
    part.y = (depth.height - part.height) / 2;
  }
  return part;
}

void cut(PlaneValues& values, int width, const Part& part) {
  if (values.empty()) return;
  PlaneValues kept;
  for (int y = part.y; y < part.y + part.height; ++y) {
    const auto from = values.begin() + std::ptrdiff_t{y} * width + part.x;
    kept.insert(kept.end(), from, from + part.width);
  }
  values = std::move(kept);
}

}  // namespace

void add_depth_options(CLI::App& parser, DepthOptions& options) {
  begin_group(parser, "Depth");
  add_text(parser, "--layer", "NAME", "Layer of COLOUR (default: R G B, Combined or the first)",
           options.layer);
  add_text(parser, "--depth-layer", "NAME",
           "Layer or channel of the depth (default: Z, Depth, or a NumPy file's alpha)",
           options.depth_layer);
  add_value(parser, "--depth-encoding", "NAME",
            "What the depth's numbers mean: " + names_of(depth_encodings()) +
                " (default: by the numbers, where they tell; softfocus inspect says)",
            [&options](const std::string& text) {
              options.encoding = find_depth_encoding(text);
              if (options.encoding == nullptr) {
                refuse_name("--depth-encoding", text, names_in(depth_encodings()));
              }
            });
  offer(parser, "--depth-encoding", [] { return names_in(depth_encodings()); });
  for (const OfDepth& of : kDepthNumbers) {
    add_parameter(parser, of.number, "", options.numbers.*of.place);
  }
  add_choice(parser, "--depth-along",
             "Whether depth is measured along the camera's axis or the pixel's ray (default: the "
             "encoding's, axis but for blender-mist)",
             kAlongs, options.along);
  add_repeatable_value(parser, "--missing", "NUMBER",
                       "This number in the depth file means that nothing is known; may be repeated "
                       "(NaN and what the encoding says always do)",
                       [&options](const std::string& text) {
                         options.missing_codes.push_back(
                             parse_number("--missing", text, -1e30, 1e30, "a decimal number"));
                       });
  add_text(parser, "--mask", "FILE", "A picture of the depth's size, 0 where nothing is known",
           options.mask);
  add_choice(parser, "--holes", kHolesText, kHoles, options.holes);
  add_choice(parser, "--depth-fit", kDepthFitText, kDepthFits, options.fit);
  add_file_options(parser, options.files);
  add_mending_options(parser, options.mending);
}

void add_file_options(CLI::App& parser, FileReading& files) {
  add_flag(parser, "--flip",
           "Rows of PFM files run from the top down, or of those that bear Photoshop's mark, whose "
           "do, from the bottom up",
           files.flips);
  add_choice(
      parser, "--icc",
      "Colours of an ICC profile stay its own, which a .png gets, or become sRGB's (default: "
      "keep)",
      kIccs, files.to_srgb);
}

void take(const FileReading& files, PictureFile& file) {
  file.top_first = file.top_first != files.flips;
  if (!files.to_srgb || file.icc.empty()) return;
  if (!missing_lcms().empty()) throw UsageError("--icc srgb: " + std::string{missing_lcms()});
  file.to_srgb = true;
}

namespace {

/// Whether XMP says so (Google's GPano).
bool is_photo_panorama(const PictureFile& file) {
  if (file.reader != &kJpegReader && file.reader != &kPngReader) return false;
  constexpr std::size_t kMost = std::size_t{1} << 18;
  const std::string_view text{reinterpret_cast<const char*>(file.bytes.data()),
                              std::min(file.bytes.size(), kMost)};
  return text.find("GPano:ProjectionType") != text.npos;
}

/// Whether the colour and its depth show as many pixels.
bool show_alike(const PictureSources& sources) {
  return sources.of_depth().shown == sources.colour_file.shown;
}

/// Pixels beside those that are shown are filtered, too. A depth without windows lies on the
/// colour's data window if it has its size.
void take_windows(PictureSources& sources) {
  PictureFile& colour = sources.colour_file;
  if (sources.depth_file && sources.depth_file->reader != &kExrReader && !show_alike(sources)) {
    PictureFile& depth = *sources.depth_file;
    if (depth.width == colour.data.width && depth.height == colour.data.height) {
      depth.data = colour.data;
      depth.shown = colour.shown;
    }
  }
  if (!show_alike(sources)) return;
  take_data_window(colour);
  if (sources.depth_file) take_data_window(*sources.depth_file);
}

void choose_planes(PictureSources& sources, const DepthOptions& options) {
  sources.colour = choose_colour(sources.colour_file, options.layer, "--layer");
  const bool has_circles = options.encoding == &circles_encoding();
  sources.depth_plane =
      choose_depth(sources.of_depth(), options.depth_layer, !sources.depth_file, has_circles);
  if (!options.layer) find_views(sources);
  sources.notes = find_notes(sources.colour_file.path, source_of(sources.colour_file)).notes;
  if (!sources.notes) sources.lens = find_exr_lens(source_of(sources.colour_file));
  if (is_photo_panorama(sources.colour_file)) sources.lens.camera = "panoramic";
}

/// The depth of a phone lies as the pixels of its picture do.
void open_phone_depth(PictureSources& sources) {
  const PictureFile& colour = sources.colour_file;
  sources.phone = find_phone_depth(colour.bytes);
  if (!sources.phone) return;
  std::filesystem::path path = colour.path;
  PictureFile depth = open_picture_file(std::move(sources.phone->file), path += ", its depth");
  if (depth.exif_orientation == 1) {
    depth.exif_orientation = colour.exif_orientation;
    if (depth.exif_orientation >= 5) std::swap(depth.width, depth.height);
    depth.shown = depth.data = {0, 0, depth.width, depth.height};
  }
  sources.depth_file = std::move(depth);
}

}  // namespace

void find_views(PictureSources& sources) {
  const std::string own = sources.colour_file.planes[sources.colour.red].view;
  if (sources.colour_file.views.size() < 2 || own.empty()) return;
  sources.view = own;
  const std::size_t depth = sources.depth_plane;
  const auto depth_of = [&](const std::string& view) {
    return depth == kNoPlane ? std::nullopt : plane_in_view(sources.of_depth(), depth, view);
  };
  sources.depth_plane = depth_of(own).value_or(depth);
  for (const std::string& name : sources.colour_file.views) {
    if (name == own) continue;
    if (const auto colour = layer_in_view(sources.colour_file, sources.colour, name)) {
      sources.views.push_back({name, *colour, depth_of(name).value_or(kNoPlane)});
    }
  }
}

void exchange(PictureSources& sources, OtherView& view) {
  std::swap(sources.colour, view.colour);
  std::swap(sources.depth_plane, view.depth_plane);
}

PictureSources open_sources(const std::string& colour, const std::string& depth,
                            const DepthOptions& options) {
  PictureSources sources{.colour_file = open_picture_file(colour)};
  if (!depth.empty()) {
    sources.depth_file = open_picture_file(depth);
  } else if (sources.colour_file.reader == &kJpegReader) {
    open_phone_depth(sources);
  }
  take(options.files, sources.colour_file);
  if (sources.depth_file) {
    take({options.files.flips}, *sources.depth_file);
  }
  take_windows(sources);
  if (!show_alike(sources)) check_shape(sources.colour_file, *sources.depth_file, options);
  choose_planes(sources, options);
  return sources;
}

std::optional<PictureSources> open_sources_on_disk(const std::string& colour,
                                                   const std::string& depth,
                                                   const DepthOptions& options, std::string& why) {
  auto colour_file = open_on_disk(colour, why);
  if (!colour_file) return std::nullopt;
  PictureSources sources{.colour_file = std::move(*colour_file)};
  if (!depth.empty()) sources.depth_file = open_on_disk(depth, why);
  if (!depth.empty() && !sources.depth_file) return std::nullopt;
  take(options.files, sources.colour_file);
  if (sources.depth_file) take({options.files.flips}, *sources.depth_file);
  const PictureFile& of_depth = sources.of_depth();
  if (of_depth.width != sources.colour_file.width ||
      of_depth.height != sources.colour_file.height) {
    why = "the depth has another size than the colour";
    return std::nullopt;
  }
  take_windows(sources);
  if (box_of(sources.of_depth()) != box_of(sources.colour_file)) {
    why = "the depth has another data window than the colour";
    return std::nullopt;
  }
  choose_planes(sources, options);
  return sources;
}

BelievedEncoding believed_encoding(const PictureSources& sources, const NumbersSeen& seen) {
  const PictureFile& file = sources.of_depth();
  const PlaneInfo& plane = file.planes[sources.depth_plane];
  if (sources.phone && sources.phone->encoding != nullptr) {
    return {sources.phone->encoding, "the file says so"};
  }
  return believed_encoding(seen, plane.type, !sources.depth_file && sources.notes, plane.name);
}

DepthNumbers depth_numbers(const PictureSources& sources, const DepthOptions& options,
                           const DepthEncoding* encoding) {
  DepthNumbers numbers = options.numbers;
  if (!sources.phone || sources.phone->encoding != encoding) return numbers;
  for (const OfDepth& of : kDepthNumbers) {
    std::optional<double>& number = numbers.*of.place;
    if (!number) number = sources.phone->numbers.*of.place;
  }
  return numbers;
}

void settle_encoding(const PictureSources& sources, const DepthOptions& options, ReadDepth& read) {
  const PictureFile& file = sources.of_depth();
  read.encoding = options.encoding;
  if (read.encoding == nullptr) {
    const BelievedEncoding believed = believed_encoding(sources, read.seen);
    if (knows_nothing(read.seen)) {
      throw UsageError("'" + file.path.string() + "' has no depth: " + believed.why +
                       "; give another file, or --depth-layer");
    }
    if (believed.encoding == nullptr) {
      throw UsageError("'" + file.path.string() + "': " + believed.why +
                       "; give a --depth-encoding");
    }
    read.encoding = believed.encoding;
    read.why = believed.why;
    const bool is_ours = !sources.depth_file && sources.notes;
    read.is_guess = !is_ours && !sources.phone;
  }
  check_depth_numbers(*read.encoding, depth_numbers(sources, options, read.encoding));
  const bool is_said = sources.phone && sources.phone->encoding == read.encoding;
  read.along = options.along.value_or(is_said ? sources.phone->along : read.encoding->along);
}

DepthReading depth_reading(const PictureSources& sources, const DepthOptions& options,
                           const PhotoLens& photo, const ReadDepth& read) {
  DepthReading reading{.encoding = read.encoding,
                       .numbers = depth_numbers(sources, options, read.encoding),
                       .along = read.along,
                       .missing_codes = options.missing_codes};
  // A smaller map has a smaller focal length in pixels.
  const PictureFile& colour = sources.colour_file;
  reading.pixels_per_tangent = pixels_per_tangent(photo, sources.notes, options.numbers.focal_px,
                                                  colour.shown.width, colour.shown.height) *
                               read.height / colour.height;
  const double scale = static_cast<double>(read.height) / colour.height;
  reading.axis_x = (colour.shown.width / 2.0 - colour.left - colour.width / 2.0) * scale;
  reading.axis_y = (colour.shown.height / 2.0 - colour.top - colour.height / 2.0) * scale;
  reading.pixel_aspect = colour.pixel_aspect;
  return reading;
}

PhotoLens with_sources(PhotoLens photo, const PictureSources& sources) {
  const PictureFile& file = sources.colour_file;
  photo.of_file = sources.lens;
  photo.film = {{-file.left, -file.top, file.shown.width, file.shown.height}, file.pixel_aspect};
  return photo;
}

namespace {

/// Values of pixels `from` for pixels `to`, of the nearest where there are none.
PlaneValues nearest_on(const PlaneValues& values, const PictureBox& from, const PictureBox& to) {
  PlaneValues result;
  for (int y = to.y; y < to.y + to.height; ++y) {
    const int row = std::clamp(y - from.y, 0, from.height - 1);
    for (int x = to.x; x < to.x + to.width; ++x) {
      const int column = std::clamp(x - from.x, 0, from.width - 1);
      result.push_back(values[static_cast<std::size_t>(row) * static_cast<std::size_t>(from.width) +
                              static_cast<std::size_t>(column)]);
    }
  }
  return result;
}

}  // namespace

ReadDepth read_depth(const PictureSources& sources, const Image& colour,
                     const DepthOptions& options, const PhotoLens& photo, ThreadPool& pool) {
  const PictureFile& file = sources.of_depth();
  const NumberType type = file.planes[sources.depth_plane].type;
  PlaneValues codes = depth_codes(file, sources.depth_plane);
  PlaneValues mask =
      options.mask ? read_mask(*options.mask, file, options.files.flips) : PlaneValues{};
  const PictureBox box = box_of(sources.colour_file);
  const bool is_beside = show_alike(sources) && box != box_of(file);
  const Part part =
      is_beside ? Part{0, 0, box.width, box.height} : part_on(sources.colour_file, file, options);
  const int width = part.width, height = part.height;

  ReadDepth read{.seen = numbers_seen(codes, type), .width = width, .height = height};
  if (is_beside) {
    codes = nearest_on(codes, box_of(file), box);
    if (!mask.empty()) mask = nearest_on(mask, box_of(file), box);
  } else if (width < file.width || height < file.height) {
    cut(codes, file.width, part);
    cut(mask, file.width, part);
    read.fit = "the middle " + size_text({width, height}) + " of " +
               size_text({file.width, file.height}) + " pixels lies on the picture";
  } else if (!has_shape_of(sources.colour_file, file)) {
    read.fit =
        size_text({width, height}) + " pixels are stretched to the picture's shape, by " +
        short_number(std::round(1000.0 * stretching(sources.colour_file, file) - 1000.0) / 10.0) +
        " %";
  }
  if (!show_alike(sources) && sources.colour_file.data != sources.colour_file.shown) {
    read.fit += read.fit.empty() ? "" : "; ";
    read.fit += "the display window alone is filtered, for the depth has another size";
  }
  settle_encoding(sources, options, read);
  DepthReading reading = depth_reading(sources, options, photo, read);
  CodeEnds ends{type, reading};
  ends.add(codes, mask);
  ends.put_in(reading.numbers);
  read.numbers = reading.numbers;
  const bool has_bands = options.mending.bands && full_scale(type) > 1.0;
  if (has_bands) codes = without_bands(codes, width, height, pool);
  read.mended.bands = has_bands;
  read.map = depth_of_codes(std::move(codes), type, width, height, reading, mask);
  read.filled = missing_depths(read.map);
  const std::size_t all = read.map.metres.size();
  if (read.filled == all) {
    throw UsageError("'" + file.path.string() + "' has no depth that is known (read as " +
                     std::string{read.encoding->name} + "); another --depth-encoding would do");
  }
  if (read.filled > 0 && options.holes == Holes::refused) {
    throw UsageError("--holes refuse: '" + file.path.string() + "' knows no depth at " +
                     std::to_string(read.filled) + " of " + std::to_string(all) +
                     " pixels; --holes far fills them");
  }
  read.background = fill_holes(read.map, options.holes);
  mend(read.map, colour, options.mending, read.mended, pool);
  add_to_ends(read.ends, read.map.metres);
  return read;
}

namespace {

void multiply(const PlaneValues& opacity, Image& colour) {
  std::size_t pixel = 0;
  for (int y = 0; y < colour.height; ++y) {
    const auto halves = row<std::uint16_t>(colour, y);
    for (std::size_t i = 0; i < halves.size(); i += 4, ++pixel) {
      if (opacity[pixel] == 1.0f) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        halves[i + c] = float_to_half(half_to_float(halves[i + c]) * opacity[pixel],
                                      HalfRounding::nearest_even);
      }
    }
  }
}

}  // namespace

bool may_be_opacity(const PictureSources& sources) {
  const auto& alpha = sources.colour.alpha;
  const bool is_depth = !sources.depth_file && alpha == sources.depth_plane;
  const bool is_ours = sources.notes && sources.colour_file.reader == &kNpyReader;
  return alpha && !is_depth && !is_ours;
}

bool is_sure_of_alpha(const PictureFile& file) { return file.reader == &kExrReader; }

void take_opacity(const PictureFile& file, float whole, PlaneValues& alpha, Image& colour) {
  for (float& value : alpha) value = value > 0.0f ? std::min(value / whole, 1.0f) : 0.0f;
  if (file.reader != &kExrReader) multiply(alpha, colour);
}

PlaneValues take_opacity(const PictureSources& sources, Image& colour) {
  if (!may_be_opacity(sources)) return {};
  const std::size_t plane = *sources.colour.alpha;
  const PictureFile& file = sources.colour_file;
  PlaneValues opacity = std::move(read_planes(file, {&plane, 1}, 0.0f)[0]);
  const auto whole = static_cast<float>(full_scale(file.planes[plane].type));
  if (!is_sure_of_alpha(file) && std::any_of(opacity.begin(), opacity.end(), [&](float value) {
        return !(value >= 0.0f && value <= whole);
      })) {
    return {};
  }
  take_opacity(file, whole, opacity, colour);
  return opacity;
}

bool is_transparent(const PlaneValues& opacity) {
  return std::any_of(opacity.begin(), opacity.end(), [](float value) { return value < 1.0f; });
}

Image opacity_picture(const PlaneValues& opacity, const Image& like) {
  Image picture = make_image(like.format, like.width, like.height);
  std::size_t pixel = 0;
  for (int y = 0; y < like.height; ++y) {
    const auto from = row<std::uint16_t>(like, y);
    const auto to = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < to.size(); i += 4, ++pixel) {
      const std::uint16_t half = float_to_half(opacity[pixel], HalfRounding::nearest_even);
      to[i] = to[i + 1] = to[i + 2] = half;
      to[i + 3] = from[i + 3];
    }
  }
  return picture;
}

PlaneValues opacity_of(const Image& picture) {
  PlaneValues opacity;
  opacity.reserve(static_cast<std::size_t>(picture.width) *
                  static_cast<std::size_t>(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t i = 0; i < halves.size(); i += 4) {
      opacity.push_back(std::clamp(half_to_float(halves[i]), 0.0f, 1.0f));
    }
  }
  return opacity;
}

}  // namespace softfocus
