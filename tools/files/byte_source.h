#pragma once
// The bytes of a file: held in memory, or on the disk and read where they are asked for, so that a
// file may be larger than memory.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace softfocus {

/// A regular file that stays open.
class DiskFile {
 public:
  /// Throws std::system_error.
  explicit DiskFile(const std::filesystem::path& path);
  ~DiskFile();
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;

  int descriptor = -1;
  std::uint64_t size = 0;  ///< when it was opened
};

class ByteSource {
 public:
  /// Bytes that outlive it.
  ByteSource(std::span<const std::byte> bytes)  // NOLINT(google-explicit-constructor)
      : bytes_(bytes), size_(bytes.size()) {}
  ByteSource(const std::vector<std::byte>& bytes)  // NOLINT(google-explicit-constructor)
      : ByteSource(std::span{bytes}) {}
  explicit ByteSource(std::shared_ptr<const DiskFile> disk)
      : disk_(std::move(disk)), descriptor_(disk_->descriptor), size_(disk_->size) {}
  /// A regular file that stays open as long.
  ByteSource(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}

  std::uint64_t size() const { return size_; }

  /// `count` bytes from `place` on; those of a disk lie in `buffer`, until it changes. Throws
  /// FileError, the file itself unnamed, where there are fewer.
  std::span<const std::byte> at(std::uint64_t place, std::size_t count,
                                std::vector<std::byte>& buffer) const;

 private:
  std::shared_ptr<const DiskFile> disk_{};
  int descriptor_ = -1;  // or none: bytes_
  std::span<const std::byte> bytes_{};
  std::uint64_t size_ = 0;
};

}  // namespace softfocus
