#include "tools/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "tools/errors.h"

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
    case ENOSPC:
    case EDQUOT: return "; free some space or write elsewhere";
    case EFBIG: return "; allow larger files or make a smaller picture";
    default: return "";
  }
}

[[noreturn]] void refuse(const std::filesystem::path& file, int error) {
  throw FileError("cannot write '" + file.string() +
                  "': " + std::generic_category().message(error) + remedy(error));
}

/// What `file` leads to, links followed, or nullopt if there is nothing yet.
std::optional<struct stat> status_of(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) == 0) return status;
  if (errno == ENOENT) return std::nullopt;
  refuse(file, errno);
}

/// The end of a chain of links, which need not exist.
std::filesystem::path links_followed(std::filesystem::path file) {
  std::error_code no_link;
  // The chain ends: status_of() has refused a circle (ELOOP).
  for (;;) {
    const auto next = std::filesystem::read_symlink(file, no_link);
    if (no_link) return file;
    file = file.parent_path() / next;
  }
}

void write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    // Linux writes at most 2^31 - 4096 bytes a call; ask for less everywhere.
    const std::size_t part = std::min(bytes.size(), std::size_t{1} << 30);
    const ssize_t written = ::write(descriptor, bytes.data(), part);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw std::system_error(errno, std::generic_category());
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

}  // namespace

WholeFile::WholeFile(const std::filesystem::path& target) : shown_(target), target_(target) {
  const auto status = status_of(target);
  if (status && !S_ISREG(status->st_mode)) {
    descriptor_ = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  if (!target.has_filename()) fail(EISDIR);
  // A rename would replace even a file that is protected against writing.
  if (status && ::access(target.c_str(), W_OK) != 0) fail(errno);
  target_ = links_followed(target);
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    temporary_ = target_.parent_path() /
                 (".softfocus-" + std::to_string(::getpid()) + "-" + std::to_string(attempt));
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) {
      const int error = errno;
      temporary_.clear();
      fail(error);
    }
  }
  // Best effort: some file systems know no permissions.
  if (status) (void)!::fchmod(descriptor_, status->st_mode & 07777);
}

WholeFile::~WholeFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void WholeFile::fail(int error) const { refuse(shown_, error); }

void WholeFile::write(std::span<const std::byte> bytes) {
  try {
    write_all(descriptor_, bytes);
  } catch (const std::system_error& error) {
    fail(error.code().value());
  }
}

void WholeFile::write(std::string_view text) { write(std::as_bytes(std::span{text})); }

void WholeFile::commit() {
  // Some file systems report a full disk only here.
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void check_writable(const std::filesystem::path& target) {
  const auto status = status_of(target);
  if (!status || S_ISREG(status->st_mode)) {
    const WholeFile probe{target};
  } else if (S_ISDIR(status->st_mode)) {
    refuse(target, EISDIR);
  } else if (::access(target.c_str(), W_OK) != 0) {
    // Not opened: the reader at a pipe's other end would see it close.
    refuse(target, errno);
  }
}

void write_to_standard_output(std::span<const std::byte> bytes) {
  try {
    write_all(STDOUT_FILENO, bytes);
  } catch (const std::system_error& error) {
    refuse("standard output", error.code().value());
  }
}

}  // namespace softfocus
