#pragma once
// Pictures to standard output in their order, whoever makes them.

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <span>
#include <vector>

namespace softfocus {

enum class Put { written, other_length, reader_gone, failed };

/// Takes each place of a list once, from any thread.
class FramesInOrder {
 public:
  /// `same_length`: a picture of another length than the first's is not written.
  explicit FramesInOrder(bool same_length) : same_length_(same_length) {}

  /// Waits until all places before have been put, and writes. For an empty picture, and for one
  /// of another length, the picture before is written again; before the first, the first is.
  /// `reader_gone` from then on; `failed` once standard output could not be written, for which the
  /// first to see it gets a FileError.
  Put put(std::size_t place, std::vector<std::byte> picture);

 private:
  void write(std::span<const std::byte> picture);

  const bool same_length_;
  std::mutex mutex_;
  std::condition_variable turn_;
  std::size_t next_ = 0;
  std::size_t owed_ = 0;  ///< places before the first picture
  std::vector<std::byte> last_;
  Put end_ = Put::written;  ///< or why nothing is written any more
};

}  // namespace softfocus
