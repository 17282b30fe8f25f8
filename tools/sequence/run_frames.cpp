#include "tools/sequence/run_frames.h"

#include <algorithm>
#include <atomic>
#include <iostream>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <system_error>
#include <thread>

#include "raster/numbers/hash.h"
#include "scenes/files/scene_error.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/progress.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/sequence/journal.h"

namespace softfocus {

void FramesInOrder::write(std::span<const std::byte> picture) {
  if (end_ != Put::written) return;
  try {
    if (!write_(picture)) end_ = Put::reader_gone;
  } catch (...) {
    end_ = Put::failed;
    turn_.notify_all();
    throw;
  }
}

Put FramesInOrder::put(std::size_t place, std::vector<std::byte> picture) {
  std::unique_lock lock(mutex_);
  turn_.wait(lock, [&] { return end_ != Put::written || next_ == place; });
  if (end_ != Put::written) return end_;
  const bool fits =
      !same_length_ || picture.empty() || last_.empty() || picture.size() == last_.size();
  if (!picture.empty() && fits) last_ = std::move(picture);
  if (last_.empty()) {
    ++owed_;
  } else {
    for (; owed_ > 0; --owed_) write(last_);
    write(last_);
  }
  ++next_;
  turn_.notify_all();
  if (end_ != Put::written) return end_;
  return fits ? Put::written : Put::other_length;
}

namespace {

/// A disk that is full stays so: more frames would be made in vain.
constexpr int kMostUnwritten = 3;

/// Warnings that are printed without -v.
constexpr std::size_t kMostWarnings = 3;

struct FailedFrame {
  FrameNumber number = 0;
  std::string file, error;
};

std::uint64_t made_from(const FrameWork& frame) {
  Hash hash;
  add_to_hash(hash, frame.settings);
  add_to_hash(hash, stamp_of(frame.inputs));
  for (const std::filesystem::path& file : frame.outputs) {
    add_to_hash(hash, hash_of(file.string()));
  }
  return hash.value;
}

/// Shared by the threads of a run.
class Run {
 public:
  Run(const std::vector<FrameWork>& frames, const FrameRunOptions& options, const MakeFrame& make)
      : frames_(frames),
        options_(options),
        make_(make),
        in_order_(options.same_length, write_to_standard_output) {
    if (options.output != "-") journal_.emplace(options.output, options.shard);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (options.again || !is_there(frames[i])) todo_.push_back(i);
    }
    left_.plan("frames", static_cast<double>(todo_.size()), 1.0);
  }

  void make_all() {
    const std::size_t there = frames_.size() - todo_.size();
    if (there > 0 && !options_.quiet) {
      tell(std::to_string(there) + " of " + std::to_string(frames_.size()) + " frames are there");
    }
    show_progress();
    const int at_once = std::max(1, std::min(options_.at_once, static_cast<int>(todo_.size())));
    std::vector<std::thread> others;
    try {
      for (int i = 1; i < at_once; ++i) {
        others.emplace_back([this, i, at_once] { work(threads_of(i, at_once)); });
      }
    } catch (const std::system_error&) {
      // The system gives no more threads: those there are make all the frames.
    }
    work(threads_of(0, at_once));
    for (std::thread& other : others) other.join();
    progress_.clear();
  }

  int finish() {
    const std::size_t there = frames_.size() - todo_.size();
    if (warnings_ > kMostWarnings && !options_.verbose) {
      warn(std::to_string(warnings_ - kMostWarnings) + " more; -v lists them");
    }
    std::sort(failed_.begin(), failed_.end(),
              [](const FailedFrame& a, const FailedFrame& b) { return a.number < b.number; });
    std::vector<std::string> numbers;
    Json failures = Json::array();
    for (const FailedFrame& frame : failed_) {
      numbers.push_back(std::to_string(frame.number));
      failures.push_back({{"frame", static_cast<std::int64_t>(frame.number)},
                          {"file", frame.file},
                          {"error", frame.error}});
    }
    const std::size_t left = todo_.size() - made_ - failed_.size();
    std::string text =
        std::to_string(frames_.size()) + " frames: " + std::to_string(made_) + " made";
    if (there > 0) text += ", " + std::to_string(there) + " were there";
    if (!failed_.empty()) {
      text += ", " + std::to_string(failed_.size()) + " failed (" + some_of(numbers) + ")";
    }
    if (left > 0) text += ", " + std::to_string(left) + " left";
    const bool all_made = failed_.empty() && left == 0;
    if (!reader_is_gone_ && !(options_.quiet && all_made)) {
      tell(text);
    }
    if (options_.json) {
      const auto count = [](std::size_t n) { return static_cast<std::int64_t>(n); };
      std::cout << json_text({{"frames", count(frames_.size())},
                              {"made", count(made_)},
                              {"there", count(there)},
                              {"failed", failures},
                              {"left", count(left)}},
                             2)
                << '\n';
    }
    return failed_.empty() && (left == 0 || reader_is_gone_) ? kDone : kFailed;
  }

 private:
  bool is_there(const FrameWork& frame) const {
    std::error_code error;
    return journal_ && std::filesystem::exists(frame.outputs.front(), error) &&
           journal_->has({frame.number, made_from(frame), stamp_of(frame.outputs)});
  }

  int threads_of(int worker, int workers) const {
    const int all = options_.pool.threads;
    return std::max(1, all / workers + (worker < all % workers ? 1 : 0));
  }

  void show_progress() {
    if (todo_.empty()) return;
    const std::size_t done = frames_.size() - todo_.size() + made_ + failed_.size();
    const double seconds = left_.seconds();
    progress_.show(std::to_string(done) + " of " + std::to_string(frames_.size()) + " frames" +
                   (seconds > 0.0 ? ", " + time_left_text(seconds) : ""));
  }

  void work(int threads) {
    ThreadPool pool{threads, options_.pool.isa};
    while (!stopped_) {
      const std::size_t place = next_.fetch_add(1);
      if (place >= todo_.size()) return;
      make(place, pool);
    }
  }

  void make(std::size_t place, ThreadPool& pool) {
    const FrameWork& frame = frames_[todo_[place]];
    FrameRun run{.pool = pool};
    std::optional<std::string> error;
    bool unwritten = false;
    // Before the files are read: what changes meanwhile is made again.
    const std::uint64_t from = made_from(frame);
    try {
      make_(todo_[place], run);
    } catch (const WriteError& failure) {
      error = failure.what();
      unwritten = true;
    } catch (const std::bad_alloc&) {
      error = "out of memory; --threads 1 makes one frame at a time";
    } catch (const std::exception& failure) {
      error = failure.what();
    }
    if (options_.output == "-" && !put(place, run, error)) return;
    const std::lock_guard lock(mutex_);
    if (!error && journal_) {
      const bool noted = journal_->add({frame.number, from, stamp_of(frame.outputs)});
      if (!noted && !journal_failed_) {
        journal_failed_ = true;
        run.warnings.push_back("'" + journal_->file().string() +
                               "' cannot be written: another run will make frames again");
      }
    }
    progress_.clear();
    if (error) {
      fail(frame, *error, unwritten);
    } else {
      ++made_;
      unwritten_ = 0;
    }
    say(frame, run);
    left_.done("frames", 1.0);
    if (!stopped_) show_progress();
  }

  /// False if nothing more is to be said of the frame.
  bool put(std::size_t place, FrameRun& run, std::optional<std::string>& error) {
    try {
      const Put done =
          in_order_.put(place, error ? std::vector<std::byte>{} : std::move(run.picture));
      if (done == Put::other_length) error = "has another size than the first; a video has one";
      if (done == Put::written || done == Put::other_length) return true;
      if (done == Put::reader_gone) reader_is_gone_ = true;
    } catch (const FileError& failure) {
      const std::lock_guard lock(mutex_);
      progress_.clear();
      tell(failure.what());
    }
    stopped_ = true;
    return false;
  }

  void fail(const FrameWork& frame, const std::string& error, bool unwritten) {
    failed_.push_back({frame.number, frame.file, error});
    std::string who = "frame " + std::to_string(frame.number);
    if (error.find('\'' + frame.file + '\'') == error.npos) who += ", '" + frame.file + "'";
    tell(who + ": " + error);
    unwritten_ = unwritten ? unwritten_ + 1 : 0;
    if (unwritten_ < kMostUnwritten || stopped_) return;
    stopped_ = true;
    tell("stopped, for " + std::to_string(kMostUnwritten) +
         " frames in a row could not be written");
  }

  void say(const FrameWork& frame, const FrameRun& run) {
    if (!has_note_ && !run.note.empty() && !options_.quiet) {
      has_note_ = true;
      tell("frame " + std::to_string(frame.number) + ": " + run.note);
    }
    for (const std::string& warning : run.warnings) {
      if (++warnings_ > kMostWarnings && !options_.verbose) continue;
      warn("frame " + std::to_string(frame.number) + ": " + warning);
    }
    if (options_.verbose && !run.report.empty()) {
      std::cerr << "frame " << frame.number << '\n' << run.report;
    }
  }

  const std::vector<FrameWork>& frames_;
  const FrameRunOptions& options_;
  const MakeFrame& make_;
  std::optional<Journal> journal_;
  std::vector<std::size_t> todo_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stopped_{false};
  std::atomic<bool> reader_is_gone_{false};
  FramesInOrder in_order_;

  std::mutex mutex_;  // what follows
  Progress progress_{options_.quiet};
  TimeLeft left_;
  std::size_t made_ = 0;
  std::vector<FailedFrame> failed_;
  std::size_t warnings_ = 0;
  bool has_note_ = false;
  int unwritten_ = 0;
  bool journal_failed_ = false;
};

}  // namespace

int frames_at_once(std::size_t frames, int threads, std::uint64_t bytes_each,
                   std::uint64_t memory) {
  auto most = std::min(static_cast<std::uint64_t>(threads), static_cast<std::uint64_t>(frames));
  if (memory > 0 && bytes_each > 0) most = std::min(most, memory / 4 / bytes_each);
  return std::max(1, static_cast<int>(most));
}

int run_frames(const std::vector<FrameWork>& frames, const FrameRunOptions& options,
               const MakeFrame& make) {
  Run run{frames, options, make};
  run.make_all();
  return run.finish();
}

}  // namespace softfocus
