#include "tools/files/whole_file.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <string>
#include <system_error>
#include <utility>

#include "tools/cli/errors.h"
#include "tools/cli/platform.h"

namespace softfocus {
namespace {

const char* remedy(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR: return "; its directory must exist";
    case EISDIR: return "; give the name of a file";
    case EACCES:
    case EPERM:
    case EROFS: return "; give a place that can be written to";
#ifdef EDQUOT  // not on Windows
    case EDQUOT:
#endif
    case ENOSPC: return "; free some space or write elsewhere";
    case EFBIG: return "; allow larger files or make a smaller picture";
    default: return "";
  }
}

[[noreturn]] void refuse(const std::filesystem::path& file, int error) {
  throw WriteError("cannot write '" + file.string() +
                   "': " + std::generic_category().message(error) + remedy(error));
}

/// The status of the file that `file` leads to, links followed; not_found if there is nothing yet.
std::filesystem::file_status status_of(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::none) {
    refuse(file, error.default_error_condition().value());
  }
  return status;
}

/// The end of a chain of links, which need not exist.
std::filesystem::path links_followed(std::filesystem::path file) {
  std::error_code no_link;
  constexpr int kMostLinks = 40;  // as systems follow
  for (int i = 0; i < kMostLinks; ++i) {
    const auto next = std::filesystem::read_symlink(file, no_link);
    if (no_link) return file;
    file = file.parent_path() / next;
  }
  return file;
}

/// Temporary files of this machine are called so, with the process and a number behind it.
std::string temporary_start() { return ".softfocus-" + machine_name() + "-"; }

/// The process in PROCESS-NUMBER.
std::optional<int> process_in(std::string_view text) {
  int process = 0, number = 0;
  const char* const end = text.data() + text.size();
  const auto [dash, no_process] = std::from_chars(text.data(), end, process);
  if (no_process != std::errc{} || process < 1 || dash == end || *dash != '-') return std::nullopt;
  const auto [stop, no_number] = std::from_chars(dash + 1, end, number);
  if (no_number != std::errc{} || stop != end) return std::nullopt;
  return process;
}

/// Removes temporary files of processes that were killed. A number without a process is not
/// enough: containers have numbers of their own. Nor is a missing mark: a new file has none yet.
void remove_leftovers(const std::filesystem::path& folder) {
  const std::string start = temporary_start();
  std::error_code error;
  std::filesystem::directory_iterator entries{folder.empty() ? "." : folder, error};
  for (; !error && entries != std::filesystem::directory_iterator{}; entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (!name.starts_with(start)) continue;
    const auto process = process_in(std::string_view{name}.substr(start.size()));
    std::error_code ignored;
    if (process && !is_running(*process) && !is_in_use(entries->path())) {
      std::filesystem::remove(entries->path(), ignored);
    }
  }
}

void write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::ptrdiff_t written = write_some(descriptor, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw std::system_error(errno, std::generic_category());
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace

WholeFile::WholeFile(const std::filesystem::path& target) : shown_(target), target_(target) {
  const auto status = status_of(target);
  const bool is_there = std::filesystem::exists(status);
  if (is_there && !std::filesystem::is_regular_file(status)) {
    descriptor_ = open_existing(target);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  if (!target.has_filename()) fail(EISDIR);
  // A rename would replace even a file that is protected against writing.
  if (is_there && !may_write(target)) fail(errno);
  target_ = links_followed(target);
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    temporary_ = target_.parent_path() / (temporary_start() + std::to_string(process_number()) +
                                          "-" + std::to_string(attempt));
    int error = 0;
    removed_.emplace(temporary_, [&] {
      descriptor_ = create_file(temporary_);
      error = errno;
      return descriptor_ >= 0;
    });
    if (descriptor_ < 0 && error != EEXIST) {
      temporary_.clear();
      fail(error);
    }
  }
  mark_in_use(descriptor_);
  // Best effort: some file systems know no permissions.
  std::error_code ignored;
  if (is_there) std::filesystem::permissions(temporary_, status.permissions(), ignored);
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) close_file(descriptor_);
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(temporary_, ignored);
  removed_.reset();
}

void WholeFile::fail(int error) const { refuse(shown_, error); }

void WholeFile::write(std::span<const std::byte> bytes) {
  try {
    write_all(descriptor_, bytes);
  } catch (const std::system_error& error) {
    fail(error.code().value());
  }
}

void WholeFile::write(std::string_view text) {
  write(std::as_bytes(std::span{text.data(), text.size()}));
}

void WholeFile::write_at(std::uint64_t place, std::span<const std::byte> bytes) {
  end_ = std::max(end_, place + bytes.size());
  while (!bytes.empty()) {
    const std::ptrdiff_t written = write_some_at(descriptor_, place, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    place += static_cast<std::uint64_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void WholeFile::commit() {
  // A file has its name only when its bytes are on the disk: a crash between the two would leave a
  // file that is neither the old nor the new one.
  if (!temporary_.empty() && !sync_file(descriptor_)) fail(errno);
  // Some file systems report a full disk only here.
  if (!close_file(std::exchange(descriptor_, -1))) fail(errno);
  if (temporary_.empty()) return;
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);
  if (error) fail(error.default_error_condition().value());
  temporary_.clear();
  removed_.reset();
}

void check_writable(const std::filesystem::path& target) {
  const auto status = status_of(target);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) {
    remove_leftovers(links_followed(target).parent_path());
    const WholeFile probe{target};
  } else if (std::filesystem::is_directory(status)) {
    refuse(target, EISDIR);
  } else if (!may_write(target)) {
    // Not opened: the reader at a pipe's other end would see it close.
    refuse(target, errno);
  }
}

bool write_to_standard_output(std::span<const std::byte> bytes) {
  try {
    write_all(kStandardOutput, bytes);
  } catch (const std::system_error& error) {
    if (error.code().value() == EPIPE) return false;  // whoever reads it has enough
    refuse("standard output", error.code().value());
  }
  return true;
}

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (a == b) return true;
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error) && !error) return true;
  std::error_code error_a, error_b;
  const auto whole_a =
      std::filesystem::absolute(links_followed(a), error_a);  // an empty name has no place
  const auto whole_b = std::filesystem::absolute(links_followed(b), error_b);
  if (error_a || error_b) return false;
  const auto place_a = std::filesystem::weakly_canonical(whole_a, error_a);
  const auto place_b = std::filesystem::weakly_canonical(whole_b, error_b);
  return !error_a && !error_b && place_a == place_b;
}

void check_not_read(const std::string& option, const std::filesystem::path& output,
                    const std::vector<ReadFile>& inputs) {
  for (const auto& [file, what] : inputs) {
    std::error_code unknown;
    const std::filesystem::path sidecar = file.string() + ".json";
    const bool is_sidecar =
        std::filesystem::exists(sidecar, unknown) && is_same_file(output, sidecar);
    if (!is_sidecar && !is_same_file(output, file)) continue;
    throw UsageError(std::string{option}
                         .append(" '")
                         .append(output.string())
                         .append("' would write over ")
                         .append(what)
                         .append(is_sidecar ? "'s sidecar, '" : ", '")
                         .append((is_sidecar ? sidecar : file).string())
                         .append("'; give another name"));
  }
}

void check_written(const std::vector<WrittenFile>& outputs, const std::vector<ReadFile>& inputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    check_not_read(outputs[i].option, outputs[i].file, inputs);
    for (std::size_t k = 0; k < i; ++k) {
      if (!is_same_file(outputs[i].file, outputs[k].file)) continue;
      throw UsageError(outputs[i].option + " '" + outputs[i].file.string() + "' is where " +
                       outputs[k].option + " writes; give another name");
    }
  }
}

}  // namespace softfocus
