#pragma once
// A file that appears whole or not at all: the bytes go into a temporary file beside
// it, .softfocus-MACHINE-PROCESS-NUMBER, which takes its name at the end. An interrupt removes it.
// Whether two names lead to one file, so that no command writes over what it reads.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/interrupts.h"
#include "tools/files/byte_source.h"

namespace softfocus {

/// Bytes on their way to a file. Every call throws WriteError, which names the file.
class WholeFile {
 public:
  /// Opens the temporary file. A symbolic link is followed; what exists and is no
  /// regular file (a device, a pipe) cannot be replaced and is written to directly.
  explicit WholeFile(const std::filesystem::path& target);
  /// Without a commit() before, nothing remains.
  ~WholeFile();
  WholeFile(const WholeFile&) = delete;
  WholeFile& operator=(const WholeFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text);

  /// Writes at a place of what is no device or pipe. A file is written so, or by write() alone.
  void write_at(std::uint64_t place, std::span<const std::byte> bytes);
  /// The bytes that write_at() wrote, until commit().
  ByteSource written() const { return {descriptor_, end_}; }

  /// Gives the file its name, in place of one that has it. A new file has the
  /// permissions of the umask, a replaced one those it had.
  void commit();

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path shown_;      // as the user named it
  std::filesystem::path target_;     // with links followed
  std::filesystem::path temporary_;  // empty: written to directly, or committed
  std::optional<RemovedByInterrupt> removed_;
  int descriptor_ = -1;
  std::uint64_t end_ = 0;  // of what write_at() wrote
};

/// Throws FileError if `target` could not be written now, so that a long work need
/// not be done in vain. Removes temporary files beside it of processes that were killed on this
/// machine, and leaves all else as it was.
void check_writable(const std::filesystem::path& target);

/// Writes to standard output. False if it is a pipe that nobody reads any more. Throws FileError.
bool write_to_standard_output(std::span<const std::byte> bytes);

/// Whether two names lead to one place: the same path once links are followed, there already or
/// not, or two names (hard links) of one file.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A file that a command reads, and what it is: "the scene".
struct ReadFile {
  std::filesystem::path file;
  std::string what;
};

/// Throws UsageError if the file that an option asks to write is one of those that are read, or the
/// sidecar of one.
void check_not_read(const std::string& option, const std::filesystem::path& output,
                    const std::vector<ReadFile>& inputs);

/// A file that is to be written, and what asks for it: "--report".
struct WrittenFile {
  std::string option;
  std::filesystem::path file;
};

/// check_not_read() of each, and UsageError if two are one file.
void check_written(const std::vector<WrittenFile>& outputs, const std::vector<ReadFile>& inputs);

}  // namespace softfocus
