#pragma once
// Runs the program as a user does and keeps what it said. POSIX.

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// How a run ended and what it wrote.
struct ProgramRun {
  int status = -1;  ///< the exit status; -1 if a signal ended it
  /// The most memory that it held, or that this process held when it began.
  long peak_kib = 0;
  std::string out{};
  std::string err{};
};

struct RunSetting {
  std::string in_from{"/dev/null"};  ///< standard input is this file
  std::string out_to{};              ///< standard output goes to this file, not to `out`
  std::string err_to{};              ///< likewise standard error
  /// Stands for a full disk: a file's bytes past it cannot be written.
  std::optional<rlim_t> file_size_limit{};
  std::optional<rlim_t> memory_limit{};  ///< bytes of address space
  /// As this user, where it may be changed.
  std::optional<uid_t> user{};
};

/// Starts it; what it says goes to these descriptors, unless the setting names files.
inline pid_t start_program(const std::vector<std::string>& arguments, const RunSetting& setting,
                           int out, int err) {
  std::vector<std::string> words{SOFTFOCUS_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child");
  if (child == 0) {
    if (std::freopen(setting.in_from.c_str(), "r", stdin) == nullptr) ::_exit(125);
    const auto connect = [](int descriptor, const std::string& name, int pipe) {
      const int to = name.empty() ? pipe : ::open(name.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
      if (::dup2(to, descriptor) < 0) ::_exit(125);
    };
    connect(STDOUT_FILENO, setting.out_to, out);
    connect(STDERR_FILENO, setting.err_to, err);
    const auto limit = [](int resource, const std::optional<rlim_t>& most) {
      if (!most) return;
      const rlimit both{*most, *most};
      ::setrlimit(resource, &both);
    };
    limit(RLIMIT_FSIZE, setting.file_size_limit);
    limit(RLIMIT_AS, setting.memory_limit);
    if (setting.user && ::setuid(*setting.user) != 0) ::_exit(125);
    ::execv(SOFTFOCUS_PROGRAM, argv.data());
    ::_exit(126);
  }
  return child;
}

/// Starts it in silence, sends it a signal once `is_time()`, and returns the signal that ended it;
/// 0 if it ended by itself.
template <class IsTime>
int signal_that_ended(const std::vector<std::string>& arguments, int signal, IsTime is_time,
                      const RunSetting& setting = {}) {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  const pid_t child = start_program(arguments, setting, nowhere, nowhere);
  ::close(nowhere);
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (is_time()) ::kill(child, signal);
    ::usleep(2000);
  }
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

inline ProgramRun run_program(const std::vector<std::string>& arguments,
                              const RunSetting& setting = {}) {
  int out[2], err[2];
  if (::pipe2(out, O_CLOEXEC) != 0 || ::pipe2(err, O_CLOEXEC) != 0) {
    throw std::runtime_error("no pipe");
  }
  const pid_t child = start_program(arguments, setting, out[1], err[1]);
  ::close(out[1]);
  ::close(err[1]);

  const auto read_all = [](int pipe) {
    std::string text;
    char part[65536];
    for (ssize_t count; (count = ::read(pipe, part, sizeof part)) > 0;) {
      text.append(part, static_cast<std::size_t>(count));
    }
    ::close(pipe);
    return text;
  };
  auto said = std::async(std::launch::async, read_all, err[0]);  // both, or one would fill up
  ProgramRun run{.out = read_all(out[0]), .err = said.get()};
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  run.peak_kib = usage.ru_maxrss;
  if (WIFEXITED(status)) run.status = WEXITSTATUS(status);
  return run;
}

/// A directory of a test's own, gone with it.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "softfocus-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

  /// The names in it, sorted.
  std::vector<std::string> listing() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator{path_}) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

inline std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span{text});
  return {bytes.begin(), bytes.end()};
}

inline std::string read_file(const std::string& name) {
  std::ifstream file{name, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

inline void write_file(const std::string& name, std::string_view text) {
  std::ofstream{name, std::ios::binary}.write(text.data(),
                                              static_cast<std::streamsize>(text.size()));
}

inline void write_file(const std::string& name, std::span<const std::byte> bytes) {
  write_file(name, text_of(bytes));
}

inline bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != text.npos;
}

/// Exactly one line, ours.
inline bool is_one_line(std::string_view text) {
  return text.starts_with("softfocus: ") && text.ends_with('\n') &&
         std::count(text.begin(), text.end(), '\n') == 1;
}

/// The one line that every refocus has to say without -q, and no other.
inline bool tells_depth_alone(std::string_view text) {
  return is_one_line(text) && text.starts_with("softfocus: the depth is ");
}

}  // namespace softfocus
