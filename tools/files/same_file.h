#pragma once
// Whether two names lead to one file, so that no command writes over what it reads.

#include <filesystem>
#include <string>
#include <vector>

namespace softfocus {

/// Whether two names lead to one place: the same path once links are followed, there already or
/// not, or two names (hard links) of one file.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A file that a command reads, and what it is: "the scene".
struct ReadFile {
  std::filesystem::path file;
  std::string what;
};

/// Throws UsageError if the file that an option asks to write is one of those that are read.
void check_not_read(const std::string& option, const std::filesystem::path& output,
                    const std::vector<ReadFile>& inputs);

}  // namespace softfocus
