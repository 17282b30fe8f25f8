#pragma once
// Which frames of a sequence are there already: a text file beside the output, a line for each
// frame that was made. A line is written once the frame's files have their names, and is believed
// while what the frame is made from and those files are as they were. So after an end at any moment
// the worst is that a frame is made twice.
//
//   frame 12 from 0x0123456789abcdef files 0x0123456789abcdef sum 0x0123456789abcdef
//
// Lines are only added. One that was torn has a wrong sum and is passed over.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "tools/sequence/frame_names.h"

namespace softfocus {

struct JournalLine {
  FrameNumber frame = 0;
  std::uint64_t made_from = 0;  ///< hash of the settings and the files that are read
  std::uint64_t files = 0;      ///< hash of the files that were written
  bool operator==(const JournalLine&) const = default;
};

/// With its line end.
std::string journal_line(const JournalLine& line);

/// Nothing if it is not one that journal_line() gave. `text` has no line end.
std::optional<JournalLine> parse_journal_line(std::string_view text);

/// Hash of a text's letters.
std::uint64_t hash_of(std::string_view text);

/// A hash of names, sizes and times of change; files may be missing.
std::uint64_t stamp_of(std::span<const std::filesystem::path> files);

/// The journal of frames with that output name. Each shard has one of its own, and reads all.
class Journal {
 public:
  /// `shard` is empty or "2-of-8". Throws FileError if the journal could not be written.
  Journal(const std::string& output, const std::string& shard);

  bool has(const JournalLine& line) const { return lines_.contains(journal_line(line)); }
  /// False if it could not be written.
  bool add(const JournalLine& line);
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::set<std::string> lines_;  ///< of all journals
  std::ofstream stream_;
  bool torn_ = false;  ///< the last line may be
};

}  // namespace softfocus
