// softfocus inspect: what is in pictures' files, and what refocus would take it for.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"
#include "tools/refocus/depth/depth_map.h"
#include "tools/refocus/report.h"

namespace softfocus {
namespace {

struct InspectOptions {
  std::vector<std::string> files;
  RefocusOptions preview;  ///< only its output, format, reading and lens are used
  bool json = false;
  bool quiet = false;
};

struct InspectedPlane {
  PlaneInfo info;
  NumbersSeen seen;
};

struct InspectedFile {
  PictureFile file;
  std::vector<InspectedPlane> planes{};
  std::vector<ColourLayer> colours{};
  std::optional<PictureNotes> notes{};
  HeaderLens lens{};  ///< if there are no notes
  std::optional<std::size_t> depth_plane{};
  BelievedEncoding believed{};
  std::optional<DepthHistogram>
      histogram{};  ///< in metres if the encoding can do it, else in codes
  bool in_metres = false;
  std::size_t missing = 0;
};

std::optional<std::size_t> likely_depth(const PictureFile& file, const DepthOptions& reading) {
  if (reading.depth_layer) return choose_depth(file, reading.depth_layer, true);
  try {
    const bool has_colour = !colour_layers(file).empty() && file.planes.size() >= 3;
    return choose_depth(file, {}, has_colour);
  } catch (const UsageError&) {  // none that the names tell
    return std::nullopt;
  }
}

/// Numbers whose meaning is not known, as a map, without those that mean nothing anyway.
DepthMap map_of_numbers(PlaneValues values, const PictureFile& file, const DepthOptions& reading) {
  for (float& value : values) {
    const auto& missing = reading.missing_codes;
    const bool is_missing =
        std::find(missing.begin(), missing.end(), static_cast<double>(value)) != missing.end();
    if (is_missing || value == -std::numeric_limits<float>::infinity()) value = kNoDepthThere;
  }
  return {file.width, file.height, std::move(values)};
}

/// Looks at the plane found to be the depth.
void look_at_depth(InspectedFile& found, PlaneValues values, const DepthOptions& reading) {
  const PictureFile& file = found.file;
  const std::size_t plane = *found.depth_plane;
  const NumberType type = file.planes[plane].type;
  found.believed = reading.encoding != nullptr
                       ? BelievedEncoding{reading.encoding, "--depth-encoding or the file says so"}
                       : believed_encoding(found.planes[plane].seen, type, found.notes.has_value(),
                                           file.planes[plane].name);
  const DepthEncoding* encoding = found.believed.encoding;
  try {
    if (encoding != nullptr) check_depth_numbers(*encoding, reading.numbers);
  } catch (const UsageError& error) {
    found.believed.why += "; " + std::string{error.what()};
    encoding = nullptr;
  }
  found.in_metres = encoding != nullptr;
  const DepthReading as_said{
      .encoding = encoding, .numbers = reading.numbers, .missing_codes = reading.missing_codes};
  const DepthMap map = found.in_metres ? depth_of_codes(std::move(values), type, file.width,
                                                        file.height, as_said, {})
                                       : map_of_numbers(std::move(values), file, reading);
  found.missing = missing_depths(map);
  found.histogram = depth_histogram(map, !found.in_metres);
}

/// A depth that was written as a grey picture of three equal channels.
std::optional<PlaneValues> grey_in_colours(const InspectedFile& found) {
  if (found.colours.size() != 1 || found.file.reader == &kExrReader) return std::nullopt;
  try {
    return depth_codes(found.file, found.colours.front().red);
  } catch (const UsageError&) {  // the channels differ
    return std::nullopt;
  }
}

/// Calls look(plane, its values in a band of rows), in order. A file that has rows is decoded once,
/// in bands, so that one of forty layers takes little memory.
void look_at_planes(const PictureFile& file, std::optional<std::size_t> depth_plane,
                    const std::function<void(std::size_t plane, PlaneValues& values)>& look) {
  std::vector<std::size_t> planes(file.planes.size());
  std::iota(planes.begin(), planes.end(), std::size_t{0});
  if (file.reader->rows == nullptr || !file.has_rows) {
    std::vector<PlaneValues> values = read_planes(file, planes, 0.0f);
    for (const std::size_t plane : planes) look(plane, values[plane]);
    return;
  }
  constexpr std::size_t kMostValues = std::size_t{1} << 26;
  constexpr std::size_t kLargestBlock = 256;  // rows, of an EXR
  const auto columns = static_cast<std::size_t>(file.width);
  const int most_rows = static_cast<int>(
      std::clamp<std::size_t>(kMostValues / (columns * planes.size()), 1, kLargestBlock));
  const ReadRows read = rows_of(file, planes);
  std::vector<PlaneValues> values(planes.size());
  for (int y = 0; y < file.height; y += most_rows) {
    const Rows rows{y, std::min(most_rows, file.height - y)};
    for (const std::size_t plane : planes) {
      values[plane].assign(columns * static_cast<std::size_t>(rows.count),
                           plane == depth_plane ? kNoDepthThere : 0.0f);
    }
    read(rows, values);
    for (const std::size_t plane : planes) look(plane, values[plane]);
  }
}

InspectedFile inspected(PictureFile opened, const DepthOptions& reading) {
  InspectedFile found{.file = std::move(opened)};
  const PictureFile& file = found.file;
  found.colours = colour_layers(file);
  found.notes = find_notes(file.path, file.bytes).notes;
  if (!found.notes) found.lens = find_exr_lens(file.bytes);
  found.depth_plane = likely_depth(file, reading);
  std::vector<NumberCounter> counters;
  for (const PlaneInfo& plane : file.planes) counters.emplace_back(plane.type);
  PlaneValues depth;
  look_at_planes(file, found.depth_plane, [&](std::size_t plane, PlaneValues& values) {
    counters[plane].add(values);
    if (found.depth_plane == plane) depth.insert(depth.end(), values.begin(), values.end());
  });
  for (std::size_t i = 0; i < file.planes.size(); ++i) {
    found.planes.push_back({file.planes[i], counters[i].seen()});
  }
  if (found.depth_plane) {
    look_at_depth(found, std::move(depth), reading);
    return found;
  }
  if (std::optional<PlaneValues> grey = grey_in_colours(found)) {
    found.depth_plane = found.colours.front().red;
    look_at_depth(found, std::move(*grey), reading);
  }
  return found;
}

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text;
}

std::string seen_text(const NumbersSeen& seen) {
  const bool is_any_finite = seen.infinities + seen.nans < seen.count;
  std::string text = is_any_finite ? short_number(seen.least) + " to " + short_number(seen.largest)
                                   : "nothing finite";
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  add(seen.different, "different");
  add(seen.zeros, "zero");
  add(seen.negatives, "negative");
  add(seen.infinities, "infinite");
  add(seen.nans, "NaN");
  return text;
}

std::string histogram_text(const DepthHistogram& histogram, bool in_metres) {
  constexpr std::size_t kColumns = 40;
  const std::string unit = in_metres ? " m" : "";
  std::size_t most = std::max<std::size_t>(histogram.infinite, 1);
  for (const DepthBin& bin : histogram.bins) most = std::max(most, bin.count);
  std::string text;
  const auto line = [&](const std::string& label, std::size_t count) {
    text += "    " + padded(label, 24) + std::string((count * kColumns + most - 1) / most, '#') +
            " " + std::to_string(count) + "\n";
  };
  for (const DepthBin& bin : histogram.bins) {
    line(short_number(bin.from) + " to " + short_number(bin.to) + unit, bin.count);
  }
  if (histogram.infinite > 0) line(in_metres ? "infinitely far" : "infinite", histogram.infinite);
  return text;
}

std::string lens_text(const HeaderLens& lens) {
  std::string text;
  const auto add = [&text](const std::optional<double>& value, const char* before,
                           const char* after) {
    if (!value) return;
    text += (text.empty() ? "  lens: " : ", ") + (before + short_number(*value)) + after;
  };
  add(lens.focal_length_mm, "", " mm");
  add(lens.f_number, "f/", "");
  add(lens.focus_m, "focus ", " m");
  if (!text.empty()) text += "\n";
  if (!lens.camera.empty()) text += "  camera: " + lens.camera + "\n";
  for (const std::string& fault : lens.faults) text += "  " + fault + ": ignored\n";
  return text;
}

/// What the numbers of a file's colours are.
std::string colours_text(const PictureFile& file) {
  if (!file.icc_name.empty()) return ", ICC profile " + file.icc_name;
  return file.is_srgb ? ", sRGB" : ", linear";
}

std::string text_of(const InspectedFile& found) {
  const PictureFile& file = found.file;
  std::string text = file.path.string() + ": " + std::string{file.reader->name} + ", " +
                     size_text({file.width, file.height}) +
                     (file.remark.empty() ? "" : ", " + file.remark) + colours_text(file) + "\n";
  std::size_t widest = 8;
  for (const InspectedPlane& plane : found.planes) {
    widest = std::max(widest, plane.info.name.size());
  }
  for (const InspectedPlane& plane : found.planes) {
    text += "  " + padded(plane.info.name, widest + 2) +
            padded(std::string{name_of(plane.info.type)}, 9) + seen_text(plane.seen) + "\n";
  }
  for (const ColourLayer& layer : found.colours) {
    text +=
        "  colour: " + (layer.name.empty() ? "without a layer's name" : "--layer " + layer.name) +
        (layer.alpha ? ", with alpha" : "") + "\n";
  }
  if (found.notes) text += "  notes: softfocus wrote it, of " + found.notes->scene + "\n";
  text += lens_text(found.lens);
  if (!found.depth_plane) return text + "  depth: none that the channels' names tell\n";
  text += "  depth: " + found.planes[*found.depth_plane].info.name + ", ";
  text += found.believed.encoding != nullptr
              ? "read as " + std::string{found.believed.encoding->name} + " (" +
                    found.believed.why + ")"
              : "not to be told: " + found.believed.why;
  text += "\n  " + std::to_string(found.missing) + " of " +
          std::to_string(found.planes[*found.depth_plane].seen.count) + " pixels without a depth\n";
  return text + histogram_text(*found.histogram, found.in_metres);
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json_of(const InspectedFile& found) {
  const PictureFile& file = found.file;
  Json planes = Json::array();
  for (const InspectedPlane& plane : found.planes) {
    planes.push_back({{"name", plane.info.name},
                      {"type", name_of(plane.info.type)},
                      {"least", plane.seen.least},
                      {"largest", plane.seen.largest},
                      {"nan", plane.seen.nans},
                      {"infinite", plane.seen.infinities},
                      {"zero", plane.seen.zeros},
                      {"negative", plane.seen.negatives}});
  }
  Json layers = Json::array();
  for (const ColourLayer& layer : found.colours) layers.push_back(layer.name);
  Json json{{"file", file.path.string()},
            {"kind", file.reader->name},
            {"width", file.width},
            {"height", file.height},
            {"remark", file.remark},
            {"srgb", file.is_srgb && file.icc_name.empty()},
            {"icc_profile", file.icc_name.empty() ? Json(nullptr) : Json(file.icc_name)},
            {"planes", planes},
            {"colour_layers", layers},
            {"lens", nullptr},
            {"depth", nullptr}};
  const HeaderLens& lens = found.lens;
  if (lens.focus_m || lens.f_number || lens.focal_length_mm) {
    json["lens"] = {{"focus_m", json_of(lens.focus_m)},
                    {"f_number", json_of(lens.f_number)},
                    {"focal_length_mm", json_of(lens.focal_length_mm)}};
  }
  if (!found.depth_plane) return json;
  Json bins = Json::array();
  for (const DepthBin& bin : found.histogram->bins) {
    bins.push_back({{"from", bin.from}, {"to", bin.to}, {"count", bin.count}});
  }
  json["depth"] = {{"plane", found.planes[*found.depth_plane].info.name},
                   {"encoding", nullptr},
                   {"why", found.believed.why},
                   {"missing", found.missing},
                   {"in_metres", found.in_metres},
                   {"infinite", found.histogram->infinite},
                   {"histogram", bins}};
  if (found.believed.encoding != nullptr) json["depth"]["encoding"] = found.believed.encoding->name;
  return json;
}

/// The circles of the lens that was asked for, as a grey picture.
void write_circles(const InspectOptions& options) {
  RefocusOptions preview = options.preview;
  preview.colour = options.files[0];
  preview.depth = options.files.size() > 1 ? options.files[1] : "";
  preview.show = RefocusShow::coc;
  ThreadPool pool{preview.pool.threads, preview.pool.isa};
  const PictureSources sources = open_sources(preview.colour, preview.depth, preview.reading);
  Image colour = read_colour(sources.colour_file, sources.colour, false).image;
  preview.photo = with_sources(preview.photo, sources);
  const ReadDepth depth = read_depth(sources, colour, preview.reading, preview.photo, pool);
  UsedRefocus used;
  used.lens =
      settle_lens(preview.photo, sources.notes, preview.reading.numbers.focal_px, depth.map);
  PictureOnItsWay circles = refocused({std::move(colour), {}}, depth.map, preview, used, pool);
  cut_to_shown(sources.colour_file, circles, nullptr);
  WholeFile file{preview.output};
  file.write(encode(circles.picture, preview.format));
  file.commit();
  if (options.quiet) return;
  std::cerr << "circles in " << preview.output << ": black is sharp, white a radius of "
            << short_number(static_cast<double>(used.settings.max_coc_px)) << " px\n"
            << refocus_text(preview, sources, depth, used);
}

/// The file, and the depth that a phone put into it.
std::vector<InspectedFile> inspected(const std::string& name, const DepthOptions& reading) {
  std::vector<InspectedFile> all;
  PictureFile file = open_picture_file(name);
  take(reading.files, file);
  std::optional<PhoneDepth> phone;
  if (file.reader == &kJpegReader) phone = find_phone_depth(file.bytes);
  all.push_back(inspected(std::move(file), reading));
  if (!phone) return all;
  DepthOptions said = reading;
  if (said.encoding == nullptr) {
    said.encoding = phone->encoding;
    for (const OfDepth& of : kDepthNumbers) {
      if (!(said.numbers.*of.place)) said.numbers.*of.place = phone->numbers.*of.place;
    }
  }
  all.push_back(inspected(open_picture_file(std::move(phone->file), name + ", its depth"), said));
  return all;
}

int inspect(const InspectOptions& options) {
  if (const std::string& output = options.preview.output; !output.empty()) {
    check_writable(output);
    for (const std::string& file : options.files) {
      check_not_read("-o", output, {{file, "a file to inspect"}});
    }
  }
  Json all = Json::array();
  for (const std::string& name : options.files) {
    for (const InspectedFile& found : inspected(name, options.preview.reading)) {
      if (options.json) {
        all.push_back(json_of(found));
      } else {
        std::cout << text_of(found);
      }
    }
  }
  if (options.json) std::cout << json_text(all, 2) << '\n';
  if (!options.preview.output.empty()) write_circles(options);
  return kDone;
}

}  // namespace

Command add_inspect_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "inspect",
                                 "Show what is in pictures' files, and what their depth means");
  const auto options = std::make_shared<InspectOptions>();
  add_value_list(*parser, "FILES", "", "Pictures, depths, or both",
                 [options](const std::vector<std::string>& names) { options->files = names; });
  begin_group(*parser, "Output");
  add_text(*parser, "-o,--output", "FILE",
           "A grey picture of the circles of confusion, of one file or of a colour and its depth",
           options->preview.output);
  add_flag(*parser, "--json", "Print JSON", options->json);
  add_depth_options(*parser, options->preview.reading);
  add_photo_lens_options(*parser, options->preview.photo);
  add_quiet_option(*parser, options->quiet);
  return {parser, [parser, options] {
            if (options->files.empty()) {
              throw UsageError("FILES is missing: give pictures, softfocus inspect a.exr");
            }
            check_photo_lens(*parser);
            check_no_keys(options->preview.photo.lens);
            RefocusOptions& preview = options->preview;
            if (!preview.output.empty()) {
              if (options->files.size() > 2) {
                throw UsageError("-o: it takes one file, or a colour and its depth; " +
                                 std::to_string(options->files.size()) + " are given");
              }
              if (std::count(options->files.begin(), options->files.end(), "-") > 0) {
                throw UsageError("-o: standard input can be read once; give a file in place of -");
              }
              if (preview.output == "-") {
                throw UsageError("-o -: standard output has the text; give -o a file");
              }
              settle_format(*parser, preview.output, preview.format);
            }
            return inspect(*options);
          }};
}

}  // namespace softfocus
