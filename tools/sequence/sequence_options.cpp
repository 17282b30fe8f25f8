#include "tools/sequence/sequence_options.h"

#include <array>
#include <set>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

/// The place that a name leads to, links followed, even to a file that is not there yet.
std::string place_of(std::filesystem::path file) {
  std::error_code error;
  constexpr int kMostLinks = 40;  // or they run in a circle
  for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(file, error); ++i) {
    file = file.parent_path() / std::filesystem::read_symlink(file, error);
  }
  const auto place = std::filesystem::weakly_canonical(std::filesystem::absolute(file), error);
  return (error ? file : place).string();
}

bool has_other_names(const std::filesystem::path& file) {
  std::error_code error;
  const auto names = std::filesystem::hard_link_count(file, error);
  return !error && names > 1 && std::filesystem::is_regular_file(file, error);
}

}  // namespace

void add_sequence_options(CLI::App& parser, SequenceOptions& options,
                          const std::string& shard_help) {
  begin_group(parser, "Many pictures");
  add_value(parser, "--frames", "A..B[:STEP]",
            "Make these frames; file names then have a number, such as frame_%04d.exr",
            [&options](const std::string& text) {
              options.frames = parse_frame_range("--frames", text);
            });
  add_shard_option(parser, options.shard, shard_help);
  add_flag(parser, "--again", "Make frames too that an earlier run has made from the same",
           options.again);
}

void check_single_picture(const CLI::App& parser, const std::string& output) {
  if (is_given(parser, "--again")) {
    throw UsageError("--again: it is of many frames; give --frames A..B");
  }
  if (!numbered_name("-o", output)) return;
  throw UsageError("-o '" + output + "' is a name for many frames; give --frames A..B");
}

std::vector<FrameNumber> chosen_frames(const SequenceOptions& options,
                                       const std::vector<FrameFiles>& files) {
  std::vector<FrameNumber> frames;
  if (options.frames) {
    frames = frames_of(*options.frames);
  } else {
    for (const FrameFiles& file : files) {
      if (!file.many()) continue;
      frames = file.frames();
      if (frames.empty()) {
        throw UsageError(file.what() + " '" + file.text() +
                         "': there is no such file with any number; give --frames or other names");
      }
      break;
    }
  }
  for (const FrameFiles& file : files) file.check_there(frames);
  return frames;
}

std::vector<FrameWork> of_shard(std::vector<FrameWork> frames, const std::optional<Shard>& shard) {
  if (!shard) return frames;
  std::vector<FrameWork> some;
  for (auto i = static_cast<std::size_t>(shard->number - 1); i < frames.size();
       i += static_cast<std::size_t>(shard->count)) {
    some.push_back(std::move(frames[i]));
  }
  return some;
}

FrameOutput::FrameOutput(const std::string& option, const std::string& text) : text_(text) {
  if (text == "-") return;
  numbered_ = numbered_name(option, text);
  if (numbered_) return;
  throw UsageError(option + " '" + text +
                   "': all frames would be one file; give a name with a number, such as "
                   "frame_%04d.exr");
}

std::string FrameOutput::at(FrameNumber frame) const {
  return numbered_ ? name_at(*numbered_, frame) : text_;
}

void check_outputs_apart(const std::vector<FrameWork>& frames) {
  const auto refuse_input = [](const std::filesystem::path& output) {
    throw UsageError("'" + output.string() +
                     "' would be written over a file that is read; give another name");
  };
  std::set<std::filesystem::path> inputs;
  for (const FrameWork& frame : frames) inputs.insert(frame.inputs.begin(), frame.inputs.end());
  std::set<std::string> read, written;
  for (const std::filesystem::path& input : inputs) read.insert(place_of(input));
  for (const FrameWork& frame : frames) {
    for (const std::filesystem::path& output : frame.outputs) {
      const std::string place = place_of(output);
      if (read.contains(place)) refuse_input(output);
      if (!written.insert(place).second) {
        throw UsageError("two frames, or two outputs of one, would be written to '" +
                         output.string() + "'; give other names");
      }
      if (!has_other_names(output)) continue;
      for (const std::filesystem::path& input : inputs) {
        std::error_code error;
        if (std::filesystem::equivalent(output, input, error)) refuse_input(output);
      }
    }
  }
}

std::string given_settings(const CLI::App& parser, const Profile& profile) {
  // -o, --mask and the like name files of each frame, which count by themselves.
  static constexpr std::array<std::string_view, 18> kOthers{
      "COLOUR",      "DEPTH",     "--output", "--mask",  "--depth-output", "--report",
      "--frame",     "--frames",  "--shard",  "--again", "--focus",        "--f-number",
      "--keyframes", "--threads", "--isa",    "--json",  "--verbose",      "--quiet"};
  return SOFTFOCUS_VERSION "\n" + profile_text({"", "", profile}, "") + given_text(parser, kOthers);
}

FrameRunOptions run_options(const SequenceOptions& options, const std::string& output,
                            FileFormat format, const PoolOptions& pool, bool json, bool verbose) {
  FrameRunOptions run{.output = output, .shard = {}, .pool = pool};
  if (options.shard) {
    if (output == "-") {
      throw UsageError("--shard and -o - exclude each other: a part of a video is none");
    }
    run.shard =
        std::to_string(options.shard->number) + "-of-" + std::to_string(options.shard->count);
  }
  run.same_length = is_raw_video(format);
  run.again = options.again;
  run.json = json;
  run.verbose = verbose;
  return run;
}

}  // namespace softfocus
