#pragma once
// The calls that differ between POSIX and Windows, and what the machine is.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace softfocus {

/// Makes a write to a closed pipe or past the file-size limit an error, where it would silently
/// end the program, and makes standard output a stream of bytes. Memory that is freed is kept for
/// the next pictures.
void prepare_process();

/// The running program's number.
int process_number();

/// The machine's name, of letters, digits, '.', '_' and '-'.
std::string machine_name();

/// Whether a process of this machine has that number. True where the system does not tell.
bool is_running(int process);

/// The machine's memory, or nullopt where the system does not tell.
std::optional<std::uint64_t> memory_bytes();

inline constexpr int kStandardOutput = 1;
inline constexpr int kStandardError = 2;

bool is_terminal(int descriptor);

/// The columns to print text in: COLUMNS says it, or the terminal, or it is 80; at most 100, for
/// longer lines are hard to read.
int columns_of(int descriptor);

/// Whether it is a pipe that nobody reads any more. False on Windows.
bool is_reader_gone(int descriptor);

/// A descriptor to write bytes to what is there, or -1 with errno set.
int open_existing(const std::filesystem::path& file);

/// A descriptor to a new file, to write and read, with the permissions of the umask; EEXIST if the
/// name is taken.
int create_file(const std::filesystem::path& file);

/// Tells is_in_use(), until the descriptor is closed, that somebody writes to the file.
void mark_in_use(int descriptor);

/// Whether a process, on this machine or on another, has marked a file; true where the file system
/// does not tell.
bool is_in_use(const std::filesystem::path& file);

/// A descriptor to read what is there, or -1 with errno set.
int open_to_read(const std::filesystem::path& file);

/// Whether an existing file may be written to; if not, errno says why.
bool may_write(const std::filesystem::path& file);

/// Writes some of the bytes, at least one, and returns how many; -1 with errno set.
std::ptrdiff_t write_some(int descriptor, std::span<const std::byte> bytes);

/// write_some() at a place of a regular file, whose end moves there if need be.
std::ptrdiff_t write_some_at(int descriptor, std::uint64_t place, std::span<const std::byte> bytes);

/// Reads some bytes from a place of a regular file on and returns how many, 0 at its end; -1 with
/// errno set.
std::ptrdiff_t read_some_at(int descriptor, std::uint64_t place, std::span<std::byte> bytes);

/// Waits until what was written is on the disk; false with errno set if it is lost. True where
/// the file system knows no such thing.
bool sync_file(int descriptor);

/// Closes a descriptor; false with errno set if what was written is lost.
bool close_file(int descriptor);

/// Runs `program` with these words, and none of their output. Its exit status; nullopt where it
/// cannot be run.
std::optional<int> run_quietly(const std::filesystem::path& program,
                               const std::vector<std::string>& words);

/// The file of the running program, where Linux tells it.
std::optional<std::filesystem::path> own_program();

/// The processor's name, where Linux tells it in /proc/cpuinfo.
std::optional<std::string> cpu_name();

/// The compiler that this program was built with, and its version.
std::string compiler_name();

}  // namespace softfocus
