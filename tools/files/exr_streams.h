#pragma once
// Between the OpenEXR library and bytes in memory.

#include <ImfIO.h>

#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <string>

#include "tools/cli/errors.h"
#include "tools/files/image_file.h"

namespace softfocus {

class ExrInput : public Imf::IStream {
 public:
  explicit ExrInput(std::span<const std::byte> bytes) : IStream("picture"), bytes_(bytes) {}

  bool read(char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (n < 0 || count > bytes_.size() - at_) throw FileError("the EXR is cut short");
    std::memcpy(c, bytes_.data() + at_, count);
    at_ += count;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t place) override {
    if (place > bytes_.size()) throw FileError("the EXR is cut short");
    at_ = static_cast<std::size_t>(place);
  }
  void clear() override {}

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

class ExrOutput : public Imf::OStream {
 public:
  explicit ExrOutput(Bytes& bytes) : OStream("picture"), bytes_(bytes) {}

  void write(const char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (bytes_.size() < at_ + count) bytes_.resize(at_ + count);
    std::memcpy(bytes_.data() + at_, c, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t place) override { at_ = static_cast<std::size_t>(place); }

 private:
  Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Does what may throw the library's exceptions, as FileError.
template <class Work>
auto guarded_exr(Work work) {
  try {
    return work();
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw FileError(std::string{"the EXR is damaged: "} + error.what());
  }
}

}  // namespace softfocus
