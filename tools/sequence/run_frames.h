#pragma once
// Makes many frames: several at once, each with its share of the threads, and goes on where an
// earlier run ended.

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "raster/threads/parallel.h"
#include "tools/options/run_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {

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
