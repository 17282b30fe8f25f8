#pragma once
// Names that stand for the files of many frames.
//
//   frame_%04d.exr   a number with at least four digits; %d has as many as it needs
//   '*.exr'          a glob (* ? [a-z]): the files there are, each by the number in its name
//   sky.exr          one file for all frames
//
// Numbers and globs stand in the last part of a path, not in a folder's name.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

using FrameNumber = std::int64_t;
inline constexpr FrameNumber kLastFrame = 1'000'000'000;

/// --frames A..B:STEP.
struct FrameRange {
  FrameNumber first = 0;
  FrameNumber last = 0;
  FrameNumber step = 1;
};

/// "1..48", "1..48:2" or "7"; at most a million frames. Throws UsageError.
FrameRange parse_frame_range(std::string_view option, const std::string& text);

/// From the first on, none past the last.
std::vector<FrameNumber> frames_of(const FrameRange& range);

/// A name with a number in it.
struct NumberedName {
  std::string before, behind;
  int digits = 0;  ///< at least so many, zeros in front
};

/// Nothing if there is no %d in `text`; then a % is a % like any other, else %% is one. Throws
/// UsageError, naming `what`, for two numbers, one in a folder's name, and other forms of it.
std::optional<NumberedName> numbered_name(std::string_view what, const std::string& text);

std::string name_at(const NumberedName& name, FrameNumber frame);

/// The frame that has this name, if one has.
std::optional<FrameNumber> frame_named(const NumberedName& name, std::string_view text);

/// Whether a file of that name is not there and `text` has a *, ? or [.
bool is_glob(const std::string& text);

/// Whether a name fits a glob without folders: * stands for any letters, ? for one, [a-c] for one
/// of some, [!a-c] for one of the others. A leading dot fits only a dot.
bool fits_glob(std::string_view glob, std::string_view name);

/// A number for each name: the last one in which they all differ. Numbers have up to 18 digits.
/// Nothing if there is none.
std::optional<std::vector<FrameNumber>> numbers_of(const std::vector<std::string>& names);

/// The files that one argument or option names.
class FrameFiles {
 public:
  /// Lists the files of a glob or a numbered name. `what` is who named them: "COLOUR", "--mask".
  /// Throws UsageError for names that numbered_name() refuses, a folder that cannot be read, and
  /// a glob that no file fits or whose files have no numbers.
  FrameFiles(std::string what, std::string text);

  /// Whether there is a file for each frame; false of a single name, whether there or not.
  bool many() const { return many_; }
  const std::string& what() const { return what_; }
  const std::string& text() const { return text_; }
  /// The frames, of many, that are there, increasing.
  std::vector<FrameNumber> frames() const;
  /// Throws UsageError with the first few of the `wanted`, of many, that are not there.
  void check_there(const std::vector<FrameNumber>& wanted) const;
  /// The file of a frame; of a single name that.
  std::string at(FrameNumber frame) const;

 private:
  std::string what_, text_;
  bool many_ = false;
  std::map<FrameNumber, std::string> files_;
  std::optional<NumberedName> numbered_;  ///< what a missing file would be called
};

/// "3, 7, 9", or "3, 7, 9, 11, 13 and 40 more".
std::string some_of(const std::vector<std::string>& words);

}  // namespace softfocus
