#pragma once
// The two ways for a command to end badly. Each message is one line that names the
// option or the file and says what would be right.

#include <stdexcept>
#include <string_view>

namespace softfocus {

/// The command line cannot be right.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file could not be read or written.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// It is the writing that failed.
struct WriteError : FileError {
  using FileError::FileError;
};

// One line on standard error, whatever the text holds (printable()).

/// "softfocus: TEXT"
void tell(std::string_view text);

/// "softfocus: warning: TEXT"
void warn(std::string_view text);

}  // namespace softfocus
