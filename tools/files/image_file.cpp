#include "tools/files/image_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "tools/cli/errors.h"

namespace softfocus {
namespace {

bool starts_with(std::span<const std::byte> bytes, std::string_view start) {
  return bytes.size() >= start.size() && std::memcmp(bytes.data(), start.data(), start.size()) == 0;
}

}  // namespace

std::optional<FileFormat> format_by_name(std::string_view name) {
  if (name == "png") return FileFormat::png;
  if (name == "pfm") return FileFormat::pfm;
  if (name == "npy") return FileFormat::npy;
  return std::nullopt;
}

std::optional<FileFormat> format_by_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  if (extension.empty()) return std::nullopt;
  extension.erase(0, 1);
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return format_by_name(extension);
}

Bytes encode(const Image& image, FileFormat format) {
  switch (format) {
    case FileFormat::png: return encode_png(image);
    case FileFormat::pfm: return encode_pfm(image);
    case FileFormat::npy: return encode_npy(image);
  }
  return {};
}

Picture decode(std::span<const std::byte> bytes, FileFormat format) {
  switch (format) {
    case FileFormat::png: return decode_png(bytes);
    case FileFormat::pfm: return decode_pfm(bytes);
    case FileFormat::npy: return decode_npy(bytes);
  }
  return {};
}

Bytes read_picture_bytes(const std::filesystem::path& file) {
  const auto refuse = [&](int error) {
    throw FileError("cannot read '" + file.string() + "': " +
                    std::generic_category().message(error) + "; give a .png, .pfm or .npy file");
  };
  if (std::filesystem::is_directory(file)) refuse(EISDIR);
  std::ifstream stream{file, std::ios::binary};
  if (!stream) refuse(errno);
  Bytes bytes;
  for (;;) {
    constexpr std::size_t kPart = 1 << 20;
    const std::size_t before = bytes.size();
    bytes.resize(before + kPart);
    stream.read(reinterpret_cast<char*>(bytes.data() + before), kPart);
    bytes.resize(before + static_cast<std::size_t>(stream.gcount()));
    if (stream.bad()) refuse(EIO);
    if (!stream) return bytes;
  }
}

Picture decode_picture(std::span<const std::byte> bytes, const std::filesystem::path& file) {
  try {
    if (starts_with(bytes, "\x89PNG")) return decode_png(bytes);
    if (starts_with(bytes, "\x93NUMPY")) return decode_npy(bytes);
    if (starts_with(bytes, "PF") || starts_with(bytes, "Pf")) return decode_pfm(bytes);
    throw FileError("it is neither a PNG, a PFM nor a NumPy file");
  } catch (const FileError& error) {
    throw FileError("cannot read '" + file.string() + "': " + error.what());
  }
}

Picture read_image_file(const std::filesystem::path& file) {
  return decode_picture(read_picture_bytes(file), file);
}

}  // namespace softfocus
