#include "tools/cli/platform.h"

#ifdef _WIN32
// As few macros as may be: there are some called min, near and far.
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX  // libstdc++ has it too
#define NOMINMAX
#endif
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>
#include <windows.h>
#else
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace softfocus {
namespace {

#ifdef _WIN32
int terminal_columns(int descriptor) {
  CONSOLE_SCREEN_BUFFER_INFO info{};
  const auto handle = reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor));
  return ::GetConsoleScreenBufferInfo(handle, &info) ? info.dwSize.X : 0;
}
#else
/// 0 if it is no terminal.
int terminal_columns(int descriptor) {
  winsize size{};
  return ::ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
#endif

// Linux moves at most 2^31 - 4096 bytes a call, Windows counts them in 32 bits.
constexpr std::size_t kLargestPart = std::size_t{1} << 30;

}  // namespace

int columns_of(int descriptor) {
  constexpr int kUsualColumns = 80, kMostColumns = 100;
  const char* given = std::getenv("COLUMNS");
  const long said = given != nullptr ? std::strtol(given, nullptr, 10) : 0;
  const long columns = said > 0 ? said : terminal_columns(descriptor);
  return static_cast<int>(std::min<long>(columns > 0 ? columns : kUsualColumns, kMostColumns));
}

#ifdef _WIN32

void prepare_process() { ::_setmode(kStandardOutput, _O_BINARY); }

int process_number() { return ::_getpid(); }

std::optional<std::uint64_t> memory_bytes() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  if (!::GlobalMemoryStatusEx(&status)) return std::nullopt;
  return status.ullTotalPhys;
}

bool is_terminal(int descriptor) { return ::_isatty(descriptor) != 0; }

bool is_reader_gone(int) { return false; }

int open_existing(const std::filesystem::path& file) {
  return ::_wopen(file.c_str(), _O_WRONLY | _O_BINARY | _O_NOINHERIT);
}

int create_file(const std::filesystem::path& file) {
  return ::_wopen(file.c_str(), _O_RDWR | _O_CREAT | _O_EXCL | _O_BINARY | _O_NOINHERIT,
                  _S_IREAD | _S_IWRITE);
}

std::string machine_name() { return "windows"; }

bool is_running(int) { return true; }

void mark_in_use(int) {}

bool is_in_use(const std::filesystem::path&) { return true; }

int open_to_read(const std::filesystem::path& file) {
  return ::_wopen(file.c_str(), _O_RDONLY | _O_BINARY | _O_NOINHERIT);
}

bool may_write(const std::filesystem::path& file) {
  constexpr int kForWriting = 2;
  return ::_waccess(file.c_str(), kForWriting) == 0;
}

std::ptrdiff_t write_some(int descriptor, std::span<const std::byte> bytes) {
  const auto size = static_cast<unsigned>(std::min(bytes.size(), kLargestPart));
  return ::_write(descriptor, bytes.data(), size);
}

std::ptrdiff_t write_some_at(int descriptor, std::uint64_t place,
                             std::span<const std::byte> bytes) {
  if (::_lseeki64(descriptor, static_cast<__int64>(place), SEEK_SET) < 0) return -1;
  return write_some(descriptor, bytes);
}

std::ptrdiff_t read_some_at(int descriptor, std::uint64_t place, std::span<std::byte> bytes) {
  if (::_lseeki64(descriptor, static_cast<__int64>(place), SEEK_SET) < 0) return -1;
  const auto size = static_cast<unsigned>(std::min(bytes.size(), kLargestPart));
  return ::_read(descriptor, bytes.data(), size);
}

bool sync_file(int descriptor) { return ::_commit(descriptor) == 0; }

bool close_file(int descriptor) { return ::_close(descriptor) == 0; }

std::optional<int> run_quietly(const std::filesystem::path&, const std::vector<std::string>&) {
  return std::nullopt;
}

#else

void prepare_process() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  // The first file that is opened would get the number of a closed stream, and what is printed
  // would go there. So a closed stream is replaced by one whose writes fail.
  for (const int stream : {0, kStandardOutput, kStandardError}) {
    if (::fcntl(stream, F_GETFD) == -1) ::open("/dev/null", O_RDONLY);
  }
#ifdef __GLIBC__
  // Pictures come and go. Memory that the system takes back comes again as pages of zeros, which
  // can take as long as the work on it.
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

int process_number() { return ::getpid(); }

std::optional<std::uint64_t> memory_bytes() {
  const long pages = ::sysconf(_SC_PHYS_PAGES);
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_bytes <= 0) return std::nullopt;
  const auto there = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page_bytes);
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return there;
  return std::min(there, static_cast<std::uint64_t>(limit.rlim_cur));
}

bool is_terminal(int descriptor) { return ::isatty(descriptor) != 0; }

bool is_reader_gone(int descriptor) {
  pollfd end{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return ::poll(&end, 1, 0) == 1 && (end.revents & (POLLERR | POLLHUP)) != 0;
}

int open_existing(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
}

int create_file(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

int open_to_read(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
}

std::string machine_name() {
  char name[256] = {};
  if (::gethostname(name, sizeof name - 1) != 0) return "unknown";
  std::string text = name;
  for (char& c : text) {
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                          (c >= 'A' && c <= 'Z') || c == '.' || c == '_' || c == '-';
    if (!is_plain) c = '_';
  }
  return text;
}

bool is_running(int process) { return ::kill(process, 0) == 0 || errno != ESRCH; }

void mark_in_use(int descriptor) { ::flock(descriptor, LOCK_EX | LOCK_NB); }

bool is_in_use(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return true;
  const bool is_free = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  ::close(descriptor);
  return !is_free;
}

bool may_write(const std::filesystem::path& file) { return ::access(file.c_str(), W_OK) == 0; }

std::ptrdiff_t write_some(int descriptor, std::span<const std::byte> bytes) {
  return ::write(descriptor, bytes.data(), std::min(bytes.size(), kLargestPart));
}

std::ptrdiff_t write_some_at(int descriptor, std::uint64_t place,
                             std::span<const std::byte> bytes) {
  return ::pwrite(descriptor, bytes.data(), std::min(bytes.size(), kLargestPart),
                  static_cast<off_t>(place));
}

std::ptrdiff_t read_some_at(int descriptor, std::uint64_t place, std::span<std::byte> bytes) {
  return ::pread(descriptor, bytes.data(), std::min(bytes.size(), kLargestPart),
                 static_cast<off_t>(place));
}

bool sync_file(int descriptor) {
  return ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS;
}

bool close_file(int descriptor) { return ::close(descriptor) == 0; }

std::optional<int> run_quietly(const std::filesystem::path& program,
                               const std::vector<std::string>& words) {
  std::string name = program.string();
  std::vector<std::string> texts = words;
  std::vector<char*> arguments{name.data()};
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  if (::posix_spawn_file_actions_init(&actions) != 0) return std::nullopt;
  for (const int descriptor : {kStandardOutput, kStandardError}) {
    ::posix_spawn_file_actions_addopen(&actions, descriptor, "/dev/null", O_WRONLY, 0);
  }
  pid_t process = 0;
  const bool begun =
      ::posix_spawn(&process, name.c_str(), &actions, nullptr, arguments.data(), ::environ) == 0;
  ::posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  if (!begun) return std::nullopt;
  while (::waitpid(process, &status, 0) < 0) {
    if (errno != EINTR) return std::nullopt;
  }
  return WIFEXITED(status) ? std::optional{WEXITSTATUS(status)} : std::nullopt;
}

#endif

std::optional<std::filesystem::path> own_program() {
  std::error_code unknown;
  const std::filesystem::path file = std::filesystem::read_symlink("/proc/self/exe", unknown);
  return unknown ? std::nullopt : std::optional{file};
}

std::optional<std::string> cpu_name() {
  std::ifstream file{"/proc/cpuinfo"};
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t begin = line.find_first_not_of(": \t", line.find(':'));
    if (begin != line.npos) return line.substr(begin);
  }
  return std::nullopt;
}

std::string compiler_name() {
#ifdef __clang__
  return __VERSION__;  // with its name
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace softfocus
