#pragma once
// Which frames a command makes, and the plan of the run.

#include <optional>
#include <string>
#include <vector>

#include "scenes/lens_views/shard.h"
#include "tools/cli/parser.h"
#include "tools/sequence/run_frames.h"

namespace softfocus {

struct SequenceOptions {
  std::optional<FrameRange> frames;
  std::optional<Shard> shard;  ///< every count-th of the frames, from the number-th on
  bool again = false;
};

/// Adds --frames, --shard and --again. `shard_help` says what is shared out.
void add_sequence_options(CLI::App& parser, SequenceOptions& options,
                          const std::string& shard_help);

/// Throws UsageError if an option is given that a single picture has no use for.
void check_single_picture(const CLI::App& parser, const std::string& output);

/// The frames of --frames, or those that there are of the first of `files` that is many. Throws
/// UsageError if a file is missing, and if neither says which frames.
std::vector<FrameNumber> chosen_frames(const SequenceOptions& options,
                                       const std::vector<FrameFiles>& files);

/// Those of the shard.
std::vector<FrameWork> of_shard(std::vector<FrameWork> frames, const std::optional<Shard>& shard);

/// An output that each frame has one of; "-" is all of them. Throws UsageError if there is no
/// number in it.
class FrameOutput {
 public:
  FrameOutput(const std::string& option, const std::string& text);
  std::string at(FrameNumber frame) const;

 private:
  std::string text_;
  std::optional<NumberedName> numbered_;
};

/// Throws UsageError if a frame's output is one of the files that any frame reads, or that another
/// frame writes, links and hard links followed.
void check_outputs_apart(const std::vector<FrameWork>& frames);

/// The settings that decide the pictures: the program's version, the profile, and all that was
/// given on the command line, but for the frames, the files of a frame, the lens by frames, and
/// options that only change the speed or the words.
std::string given_settings(const CLI::App& parser, const Profile& profile);

/// How the run goes, but for FrameRunOptions::at_once.
FrameRunOptions run_options(const SequenceOptions& options, const std::string& output,
                            FileFormat format, const PoolOptions& pool, bool json, bool verbose);

}  // namespace softfocus
