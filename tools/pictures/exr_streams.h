#pragma once
// Between the OpenEXR library and bytes in memory or on a disk.

#include <ImfIO.h>
#include <ImfVersion.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "tools/cli/errors.h"
#include "tools/pictures/picture_rows.h"

namespace softfocus {

class ExrInput : public Imf::IStream {
 public:
  explicit ExrInput(ByteSource source) : IStream("picture"), source_(std::move(source)) {
    check_attributes();
  }

  bool read(char c[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (n < 0 || count > source_.size() - at_) throw FileError("the EXR is cut short");
    // The library reads headers and tables byte by byte.
    if (count > kLookAhead) {
      std::memcpy(c, source_.at(at_, count, buffer_).data(), count);
    } else {
      if (at_ < ahead_at_ || at_ + count > ahead_at_ + ahead_.size()) {
        ahead_at_ = at_;
        ahead_ = source_.at(at_, std::min<std::uint64_t>(kLookAhead, source_.size() - at_), kept_);
      }
      std::memcpy(c, ahead_.data() + (at_ - ahead_at_), count);
    }
    at_ += count;
    return at_ < source_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t place) override {
    if (place > source_.size()) throw FileError("the EXR is cut short");
    at_ = place;
  }
  void clear() override {}

 private:
  static constexpr std::size_t kLookAhead = 65536;
  static constexpr std::size_t kLongestName = 255;  // the library's limit, too

  /// The library makes room for what an attribute claims before it reads it: 2 GB for a file of
  /// 1 kB. A header is (name 0, type 0, size, value)... 0; of parts there are headers... 0. Of
  /// types that it knows the library reads on behind the value, whatever the size: both must agree.
  void check_attributes() {
    const bool is_exr = number() == Imf::MAGIC;  // another the library refuses
    const bool parts = is_exr && Imf::isMultiPart(number());
    for (bool within = false; is_exr;) {
      if (name().empty()) {
        if (!parts || !within) break;
        within = false;
        continue;
      }
      within = true;
      const std::string type = name();
      const int size = claimed(number());
      const std::uint64_t end = at_ + static_cast<std::uint64_t>(size);
      check_value(type, end);
      at_ = end;
    }
    at_ = 0;
  }

  void check_value(std::string_view type, std::uint64_t end) {
    struct Fixed {
      std::string_view type;
      std::uint64_t bytes;
    };
    static constexpr std::array kFixed{
        Fixed{"box2i", 16},   Fixed{"box2f", 16},      Fixed{"chromaticities", 32},
        Fixed{"v2i", 8},      Fixed{"v2f", 8},         Fixed{"v2d", 16},
        Fixed{"v3i", 12},     Fixed{"v3f", 12},        Fixed{"v3d", 24},
        Fixed{"m33f", 36},    Fixed{"m33d", 72},       Fixed{"m44f", 64},
        Fixed{"m44d", 128},   Fixed{"compression", 1}, Fixed{"lineOrder", 1},
        Fixed{"envmap", 1},   Fixed{"tiledesc", 9},    Fixed{"deepImageState", 1},
        Fixed{"int", 4},      Fixed{"float", 4},       Fixed{"double", 8},
        Fixed{"rational", 8}, Fixed{"timecode", 8},    Fixed{"keycode", 28}};
    std::uint64_t is_at = end;
    if (type == "stringvector") {
      while (at_ < end) at_ += static_cast<std::uint64_t>(claimed(number()));
      is_at = at_;
    } else if (type == "chlist") {
      while (!name().empty()) ExrInput::seekg(at_ + 16);
      is_at = at_;
    } else if (type == "preview") {
      const auto width = static_cast<std::uint32_t>(number());
      const auto height = static_cast<std::uint32_t>(number());
      const std::uint64_t left = (source_.size() - at_) / 4;
      is_at = width == 0 || height <= left / width ? at_ + std::uint64_t{4} * width * height
                                                   : source_.size() + 1;
    } else {
      const auto fixed = std::find_if(kFixed.begin(), kFixed.end(),
                                      [&](const Fixed& of) { return of.type == type; });
      if (fixed != kFixed.end()) is_at = at_ + fixed->bytes;
    }
    if (is_at != end) {
      throw FileError("the EXR is damaged: a value of its header, " + std::string{type} +
                      ", has another size than it claims");
    }
  }

  int claimed(int size) const {
    const std::uint64_t left = source_.size() - at_;
    if (size >= 0 && static_cast<std::uint64_t>(size) <= left) return size;
    throw FileError("the EXR is cut short or damaged: its header claims a value of " +
                    std::to_string(size) + " bytes, and " + std::to_string(left) + " are left");
  }

  int number() {
    std::array<char, 4> bytes{};
    ExrInput::read(bytes.data(), 4);
    std::uint32_t value = 0;  // little-endian, on every machine
    for (int i = 3; i >= 0; --i) {
      value = value << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
    }
    return static_cast<int>(value);
  }

  std::string name() {
    std::string text;
    char c = 0;
    while (ExrInput::read(&c, 1), c != 0) {
      if (text.size() == kLongestName) throw FileError("the EXR is damaged: a name has no end");
      text += c;
    }
    return text;
  }

  ByteSource source_;
  std::uint64_t at_ = 0;
  Bytes buffer_{}, kept_{};
  std::span<const std::byte> ahead_{};
  std::uint64_t ahead_at_ = 0;
};

class ExrOutput : public Imf::OStream {
 public:
  explicit ExrOutput(const WriteAt& write) : OStream("picture"), write_(write) {}

  void write(const char c[], int n) override {
    const auto* const bytes = reinterpret_cast<const std::byte*>(c);
    waiting_.insert(waiting_.end(), bytes, bytes + n);
    if (begun_ && waiting_.size() >= kEnough) flush();
  }
  std::uint64_t tellp() override { return at_ + waiting_.size(); }
  void seekp(std::uint64_t place) override {
    flush();
    at_ = place;
  }

  /// The place of a text that is still waiting: until begin(), all that was written.
  std::optional<std::uint64_t> find(std::string_view text) const {
    const std::string_view all{reinterpret_cast<const char*>(waiting_.data()), waiting_.size()};
    const auto place = all.find(text);
    return place == all.npos ? std::nullopt : std::optional{at_ + place};
  }
  void begin() { begun_ = true; }

  /// Throws what a write did, for the library's destructors keep it to themselves.
  void end() {
    flush();
    if (error_) std::rethrow_exception(error_);
  }

 private:
  static constexpr std::size_t kEnough = std::size_t{1} << 20;

  void flush() {
    try {
      if (!error_ && !waiting_.empty()) write_(at_, waiting_);
    } catch (...) {
      error_ = std::current_exception();
    }
    at_ += waiting_.size();
    waiting_.clear();
    if (begun_ && error_) std::rethrow_exception(error_);
  }

  const WriteAt& write_;
  Bytes waiting_{};
  std::uint64_t at_ = 0;  // of what waits
  bool begun_ = false;
  std::exception_ptr error_{};
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
