#include "tools/files/byte_source.h"

#include <cerrno>
#include <string>
#include <system_error>

#include "tools/cli/errors.h"
#include "tools/cli/platform.h"

namespace softfocus {

DiskFile::DiskFile(const std::filesystem::path& path) : descriptor(open_to_read(path)), size(0) {
  if (descriptor < 0) throw std::system_error(errno, std::generic_category());
  std::error_code error;
  size = std::filesystem::file_size(path, error);
  if (!error) return;
  close_file(descriptor);
  throw std::system_error(error);
}

DiskFile::~DiskFile() { close_file(descriptor); }

std::span<const std::byte> ByteSource::at(std::uint64_t place, std::size_t count,
                                          std::vector<std::byte>& buffer) const {
  const auto refuse = [](std::uint64_t length) {
    throw FileError("it ends after " + std::to_string(length) + " bytes and is cut short");
  };
  if (place > size_ || count > size_ - place) refuse(size_);
  if (descriptor_ < 0) return bytes_.subspan(static_cast<std::size_t>(place), count);
  buffer.resize(count);
  for (std::size_t done = 0; done < count;) {
    const std::ptrdiff_t more =
        read_some_at(descriptor_, place + done, std::span{buffer}.subspan(done));
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) throw FileError(std::generic_category().message(errno));
    if (more == 0) refuse(place + done);
    done += static_cast<std::size_t>(more);
  }
  return buffer;
}

}  // namespace softfocus
