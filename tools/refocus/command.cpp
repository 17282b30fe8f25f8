// softfocus refocus: a picture and its depth to a picture with depth of field.

#include <algorithm>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include "scenes/load/pipeline_file.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/cli/progress.h"
#include "tools/files/whole_file.h"
#include "tools/refocus/options.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/refocus/refocus_by_rows.h"
#include "tools/refocus/refocused.h"
#include "tools/sequence/journal.h"

namespace softfocus {
namespace {

/// A frame's pictures and working memory while it is refocused: the colour as planes and as a
/// picture, the depth, the filtered picture and one between.
constexpr std::uint64_t kRefocusBytesPerPixel = 64;

/// Refocuses one picture.
using RefocusFrame = std::function<void(const RefocusOptions& options, FrameRun& run)>;

/// Files in the order of frame_files().
RefocusOptions options_of(const RefocusOptions& all, const std::vector<FrameFiles>& files,
                          const FrameOutput& output, FrameNumber number) {
  RefocusOptions options = all;
  options.colour = files.front().at(number);
  if (!all.depth.empty()) options.depth = files[1].at(number);
  if (all.reading.mask) options.reading.mask = files.back().at(number);
  options.output = output.at(number);
  options.photo.lens = at_frame(all.photo.lens, static_cast<double>(number));
  return options;
}

FrameWork work_of(const RefocusOptions& options, FrameNumber number, const std::string& settings) {
  FrameWork work{.number = number,
                 .file = options.colour,
                 .settings = hash_of(settings + lens_text(options.photo.lens))};
  work.inputs = {options.colour};
  if (!options.depth.empty()) work.inputs.emplace_back(options.depth);
  if (options.reading.mask) work.inputs.emplace_back(*options.reading.mask);
  std::error_code error;
  const auto notes = sidecar_of(options.colour);
  if (std::filesystem::exists(notes, error)) work.inputs.push_back(notes);
  if (options.output == "-") return work;
  work.outputs = {options.output};
  if (const auto sidecar = sidecar_place(options.output, options.format)) {
    work.outputs.push_back(*sidecar);
  }
  return work;
}

/// By the first frame whose size can be read; 0 if there is none.
std::uint64_t bytes_of_a_frame(const std::vector<FrameWork>& frames) {
  constexpr std::size_t kTries = 8;
  for (std::size_t i = 0; i < std::min(frames.size(), kTries); ++i) {
    try {
      const PictureFile file = open_picture_file(frames[i].inputs.front());
      return kRefocusBytesPerPixel * static_cast<std::uint64_t>(file.width) *
             static_cast<std::uint64_t>(file.height);
    } catch (const std::exception&) {  // that frame will say why
    }
  }
  return 0;
}

/// COLOUR, DEPTH and --mask, those that are given.
std::vector<FrameFiles> frame_files(const RefocusOptions& options) {
  std::vector<FrameFiles> files{{"COLOUR", options.colour}};
  if (!options.depth.empty()) {
    files.emplace_back(options.circles ? "--circles" : "DEPTH", options.depth);
  }
  if (options.reading.mask) files.emplace_back("--mask", *options.reading.mask);
  return files;
}

/// Whether many pictures are asked for.
bool is_sequence(const RefocusOptions& options, const std::vector<FrameFiles>& files) {
  return options.sequence.frames ||
         std::any_of(files.begin(), files.end(), [](const FrameFiles& f) { return f.many(); });
}

/// Refocuses the frames. Throws UsageError before any is begun; returns the exit status.
int refocus_frames(const RefocusOptions& options, const CLI::App& parser,
                   const std::vector<FrameFiles>& files, const RefocusFrame& refocus) {
  const FrameOutput output{"-o", options.output};
  const std::string settings = given_settings(parser, options.profile);
  std::vector<FrameWork> frames;
  for (const FrameNumber number : chosen_frames(options.sequence, files)) {
    frames.push_back(work_of(options_of(options, files, output, number), number, settings));
  }
  check_outputs_apart(frames);
  frames = of_shard(std::move(frames), options.sequence.shard);
  FrameRunOptions run = run_options(options.sequence, options.output, options.format, options.pool,
                                    options.json, options.verbose);
  run.quiet = options.quiet;
  run.at_once = frames_at_once(frames.size(), options.pool.threads, bytes_of_a_frame(frames),
                               memory_bytes().value_or(0));
  return run_frames(frames, run, [&](std::size_t frame, FrameRun& frame_run) {
    refocus(options_of(options, files, output, frames[frame].number), frame_run);
  });
}

void check_outputs(const RefocusOptions& options) {
  if (options.output == "-") return;
  check_writable(options.output);
  std::vector<ReadFile> inputs{{options.colour, "the picture"}};
  if (!options.depth.empty())
    inputs.push_back({options.depth, options.circles ? "the circles" : "its depth"});
  if (options.reading.mask) inputs.push_back({*options.reading.mask, "the mask"});
  if (options.method.filter != nullptr) {
    for (const std::string& file : files_of(*options.method.filter)) {
      inputs.push_back({file, "a file of the pipeline"});
    }
  }
  check_not_read("-o", options.output, inputs);
  if (const auto sidecar = sidecar_place(options.output, options.format))
    check_not_read("the sidecar of -o", *sidecar, inputs);
}

/// With the light that halves can hold, and what that does.
PictureOnItsWay colour_of(const PictureSources& sources, const RefocusOptions& options,
                          UsedRefocus& used) {
  // fixed-8 knows white as 1.
  const int most_power = options.arithmetic == Arithmetic::floats ? kMostLightPower : 0;
  Picture read = read_colour(sources.colour_file, sources.colour, false, most_power);
  used.brightest = read.brightest;
  used.light_power = read.light_power;
  used.cut = read.cut;
  return {std::move(read.image), {}, read.light_power};
}

/// Filters another view of a picture as the first was, and adds the planes of its colour.
void refocus_view(PictureSources& sources, OtherView& view, const RefocusOptions& options,
                  const PhotoLens& photo, UsedRefocus& used, ThreadPool& pool,
                  std::vector<ReplacedPlane>& planes) {
  exchange(sources, view);
  UsedRefocus of_view = used;
  PictureOnItsWay source = colour_of(sources, options, of_view);
  used.brightest = std::max(used.brightest, of_view.brightest);
  used.light_power = std::max(used.light_power, of_view.light_power);
  used.cut += of_view.cut;
  source.opacity = take_opacity(sources, source.picture);
  const ReadDepth depth = read_depth(sources, source.picture, options.reading, photo, pool);
  add_planes(refocused(std::move(source), depth.map, options, of_view, pool), sources.colour,
             planes);
  exchange(sources, view);
}

/// In memory.
Refocused refocus_whole(const RefocusOptions& options, const std::string& why, Progress& progress,
                        ThreadPool& pool) {
  progress.show("reading");
  PictureSources sources = open_sources(options.colour, options.depth, options.reading);
  const std::uint64_t kept = options.method.name() == "two-pass" ? 40 : kWholeBytesPerPixel;
  const double aspect = sources.colour_file.pixel_aspect;
  const double repeated = std::max(aspect, 1.0 / aspect);  // until pixels are square
  check_memory(options.colour, {sources.colour_file.width, sources.colour_file.height},
               static_cast<std::uint64_t>(repeated * static_cast<double>(kept)));
  UsedRefocus used{.why_whole = why};
  PictureOnItsWay source = colour_of(sources, options, used);
  source.opacity = take_opacity(sources, source.picture);
  const bool loses_alpha = is_transparent(source.opacity) && !keeps_alpha(options.format);
  if (loses_alpha) source.opacity.clear();
  PhotoLens photo = with_sources(options.photo, sources);
  ReadDepth depth = read_depth(sources, source.picture, options.reading, photo, pool);
  // The bytes read are not needed again, but for an EXR's other layers. `= {}` would keep the
  // memory.
  if (sources.depth_file && sources.views.empty()) sources.depth_file->bytes = Bytes{};
  if (sources.colour_file.reader != &kExrReader) sources.colour_file.bytes = Bytes{};
  if (options.circles) photo.circles = coc_of_circles(depth.numbers);
  used.lens = settle_lens(photo, sources.notes, options.reading.numbers.focal_px, depth.map);
  progress.show("filtering");
  PictureOnItsWay result = refocused(std::move(source), depth.map, options, used, pool);
  Refocused made;
  std::vector<ReplacedPlane> views;
  for (OtherView& view : sources.views) {
    if (!keeps_data_window(options, sources) || !options.keep_layers) {
      made.warnings.push_back(lost_view_warning(options.colour, view));
    } else if (view.depth_plane == kNoPlane) {
      made.warnings.push_back("'" + options.colour + "': its view " + view.name +
                              " has no depth of its own and stays as it is");
    } else {
      progress.show("filtering " + view.name);
      refocus_view(sources, view, options, photo, used, pool, views);
    }
  }
  if (!keeps_data_window(options, sources)) {
    cut_to_shown(sources.colour_file, result, &depth.map.metres);
    depth.map.width = result.picture.width;
    depth.map.height = result.picture.height;
  }

  progress.show("writing");
  const PictureNotes notes = refocus_notes(options, used, result.picture.width,
                                           result.picture.height, hash_image(result.picture));
  Bytes bytes = refocused_file(options, sources, depth.map, used, result, notes, views);
  auto sidecar = sidecar_place(options.output, options.format);
  const bool has_room = !sidecar || is_free_for_sidecar(*sidecar);
  std::optional<WholeFile> picture_file, sidecar_file;
  if (sidecar && has_room) sidecar_file.emplace(*sidecar).write(sidecar_text(notes, bytes));
  if (options.output == "-") {
    made.picture = std::move(bytes);
  } else {
    picture_file.emplace(options.output).write(bytes);
    picture_file->commit();
  }
  if (sidecar_file) sidecar_file->commit();
  if (!has_room) made.warnings.push_back(busy_sidecar_warning(*sidecar));
  if (loses_alpha) made.warnings.push_back(lost_alpha_warning(options.colour));
  tell(options, sources, depth, used, notes.picture_hash, made);
  return made;
}

Refocused make_refocused(const RefocusOptions& options, Progress& progress, ThreadPool& pool) {
  std::string why = reason_for_whole(options);
  if (why.empty()) {
    if (auto made = refocus_by_rows(options, progress, pool, why)) return std::move(*made);
  }
  return refocus_whole(options, why, progress, pool);
}

int refocus(const RefocusOptions& options) {
  check_outputs(options);
  Progress progress{options.quiet};
  ThreadPool pool{options.pool.threads, options.pool.isa};
  const Refocused made = make_refocused(options, progress, pool);
  if (options.output == "-") write_to_standard_output(made.picture);
  progress.clear();
  if (!options.quiet) tell(made.depth);
  for (const std::string& warning : made.warnings) warn(warning);
  if (options.json) std::cout << made.json;
  if (options.verbose) std::cerr << made.report;
  return kDone;
}

}  // namespace

Command add_refocus_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "refocus", "Give a picture with depth the depth of field of a lens");
  const auto options = std::make_shared<RefocusOptions>();
  add_refocus_options(*parser, *options);
  return {parser, [parser, options] {
            take_circles(*options, *parser);
            const auto files = frame_files(*options);
            complete(*options, *parser);
            if (is_sequence(*options, files)) {
              for (const FrameFiles& file : files) {
                if (file.text() == "-") {
                  throw UsageError(file.what() +
                                   " -: standard input can be read for one picture, "
                                   "not for many; give a file");
                }
              }
              return refocus_frames(*options, *parser, files,
                                    [](const RefocusOptions& frame, FrameRun& run) {
                                      Progress silent{true};
                                      Refocused made = make_refocused(frame, silent, run.pool);
                                      run.picture = std::move(made.picture);
                                      run.note = std::move(made.depth);
                                      run.warnings = std::move(made.warnings);
                                      run.report = std::move(made.report);
                                    });
            }
            check_single_picture(*parser, options->output);
            if (options->sequence.shard) {
              throw UsageError("--shard: it is of many frames; give --frames A..B");
            }
            check_no_keys(options->photo.lens);
            return refocus(*options);
          }};
}

}  // namespace softfocus
