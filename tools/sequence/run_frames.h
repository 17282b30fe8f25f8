#pragma once
// Makes many frames: several at once, each with its share of the threads, and goes on where an
// earlier run ended.

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "raster/threads/parallel.h"
#include "tools/options/run_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {

// Pictures of a video in their order, whoever makes them.

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

/// A frame before it is made.
struct FrameWork {
  FrameNumber number = 0;
  std::string file{};          ///< by which complaints name it
  std::uint64_t settings = 0;  ///< hash_of() all that decides its files, but the inputs
  std::vector<std::filesystem::path> inputs{};
  std::vector<std::filesystem::path> outputs{};  ///< the first is the picture
};

/// Input and result of a frame's work.
struct FrameRun {
  ThreadPool& pool;
  std::vector<std::byte> picture{};  ///< what would go to standard output
  std::vector<std::string> warnings{};
  std::string note{};    ///< one line, told of the first frame alone
  std::string report{};  ///< for -v
};

/// Makes the frame of that place in the list. Throws if it cannot.
using MakeFrame = std::function<void(std::size_t frame, FrameRun& run)>;

struct FrameRunOptions {
  std::string output;  ///< the name with the number; "-" for standard output, in order
  std::string shard;   ///< empty, or "2-of-8"
  PoolOptions pool;
  int at_once = 1;           ///< frames_at_once()
  bool same_length = false;  ///< to standard output: frames of another length than the first fail
  bool again = false;
  bool json = false;
  bool verbose = false;
  bool quiet = false;  ///< no summary, unless a frame failed
};

/// How many frames are made at once: one for each thread, but no more than there are, and than fit
/// into a quarter of `memory` bytes (0: unknown) together. So small frames get a thread each, and
/// large ones share the threads out between few.
int frames_at_once(std::size_t frames, int threads, std::uint64_t bytes_each, std::uint64_t memory);

/// Makes all frames that are not there, and says on standard error what became of them: a line for
/// each that failed, and a summary. Those that failed do not end it; but full disks do (three in a
/// row that could not be written), and standard output that takes no more. To standard output goes
/// the picture before in place of one that failed. Returns the exit status: 1 if any failed.
int run_frames(const std::vector<FrameWork>& frames, const FrameRunOptions& options,
               const MakeFrame& make);

}  // namespace softfocus
