#pragma once
// Pictures of a video in their order, whoever makes them.

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace softfocus {

enum class Put { written, other_length, reader_gone, failed };

/// Takes each place of a list once, from any thread.
class FramesInOrder {
 public:
  /// Writes a picture; false if the reader is gone. Throws if it cannot.
  using Write = std::function<bool(std::span<const std::byte> picture)>;

  /// `same_length`: a picture of another length than the first's is not written.
  FramesInOrder(bool same_length, Write write)
      : same_length_(same_length), write_(std::move(write)) {}

  /// Waits until all places before have been put, and writes. For an empty picture, and for one
  /// of another length, the picture before is written again; before the first, the first is.
  /// `reader_gone` from then on; `failed` once a picture could not be written: the first to see
  /// that gets the exception.
  Put put(std::size_t place, std::vector<std::byte> picture);

 private:
  void write(std::span<const std::byte> picture);

  const bool same_length_;
  const Write write_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::size_t next_ = 0;
  std::size_t owed_ = 0;  ///< places before the first picture
  std::vector<std::byte> last_;
  Put end_ = Put::written;  ///< or why nothing is written any more
};

}  // namespace softfocus
