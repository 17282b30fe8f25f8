#pragma once
// Runs the program as a user does and keeps what it said. POSIX.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// How a run ended and what it wrote.
struct ProgramRun {
  int status = -1;  ///< the exit status; -1 if a signal ended it
  std::string out;
  std::string err;
};

struct RunSetting {
  std::string out_to;                     ///< standard output goes to this file, not to `out`
  std::optional<rlim_t> file_size_limit;  ///< stands for a full disk: writes past it fail
};

inline ProgramRun run_program(const std::vector<std::string>& arguments,
                              const RunSetting& setting = {}) {
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  const File out{std::tmpfile(), std::fclose};
  const File err{std::tmpfile(), std::fclose};
  if (!out || !err) throw std::runtime_error("no temporary file");
  std::vector<std::string> words{SOFTFOCUS_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t child = ::fork();
  if (child == 0) {
    if (std::freopen("/dev/null", "r", stdin) == nullptr) ::_exit(125);
    if (setting.out_to.empty()) {
      ::dup2(::fileno(out.get()), STDOUT_FILENO);
    } else if (std::freopen(setting.out_to.c_str(), "w", stdout) == nullptr) {
      ::_exit(125);
    }
    ::dup2(::fileno(err.get()), STDERR_FILENO);
    if (setting.file_size_limit) {
      const rlimit limit{*setting.file_size_limit, *setting.file_size_limit};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ::execv(SOFTFOCUS_PROGRAM, argv.data());
    ::_exit(126);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child) throw std::runtime_error("no child");

  const auto contents = [](std::FILE* file) {
    std::string text;
    std::rewind(file);
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
      text.push_back(static_cast<char>(c));
    }
    return text;
  };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out.get()), contents(err.get())};
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

inline std::string read_file(const std::string& name) {
  std::ifstream file{name, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, {}};
}

inline void write_file(const std::string& name, std::string_view text) {
  std::ofstream{name, std::ios::binary}.write(text.data(),
                                              static_cast<std::streamsize>(text.size()));
}

inline bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != text.npos;
}

/// Exactly one line, ours.
inline bool is_one_line(std::string_view text) {
  return text.starts_with("softfocus: ") && text.ends_with('\n') &&
         std::count(text.begin(), text.end(), '\n') == 1;
}

}  // namespace softfocus
