#include "tools/refocus/refocus_frames.h"

#include <algorithm>

#include "tools/cli/platform.h"
#include "tools/sequence/journal.h"

namespace softfocus {
namespace {

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

}  // namespace

std::vector<FrameFiles> frame_files(const RefocusOptions& options) {
  std::vector<FrameFiles> files{{"COLOUR", options.colour}};
  if (!options.depth.empty()) files.emplace_back("DEPTH", options.depth);
  if (options.reading.mask) files.emplace_back("--mask", *options.reading.mask);
  return files;
}

bool is_sequence(const RefocusOptions& options, const std::vector<FrameFiles>& files) {
  return options.sequence.frames ||
         std::any_of(files.begin(), files.end(), [](const FrameFiles& f) { return f.many(); });
}

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

}  // namespace softfocus
