#include "tools/pictures/sums_file.h"

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "raster/numbers/hash.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"
#include "tools/files/hash_text.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/pictures/picture_file.h"

namespace softfocus {
namespace {

constexpr std::string_view kSumsMagic{"softfocus sums\n\0", 16};
constexpr int kSumsForm = 1;
constexpr std::size_t kBeforeHeader = kSumsMagic.size() + sizeof(std::uint32_t);
constexpr std::size_t kMostHeaderBytes = 65536;
constexpr std::size_t kColours = 3;

// The only member of the header that differs from shard to shard.
constexpr const char* kShard = "shard";
constexpr const char* kPicture = "picture";

std::uint64_t bytes_after_header(int width, int height) {
  constexpr std::uint64_t kPixel = sizeof(std::uint16_t) + kColours * sizeof(double);
  return kPixel * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) +
         sizeof(std::uint64_t);
}

void add_bytes(Hash& hash, std::span<const std::byte> bytes) {
  for (const std::byte byte : bytes) add_to_hash(hash, std::to_integer<std::uint8_t>(byte));
}

Json header_json(const Shard& shard, const SumsOrigin& origin) {
  return {{"softfocus_sums", kSumsForm},
          {kShard, shard.number},
          {"shards", shard.count},
          {"samples", origin.samples},
          {"scene_files_hash", hash_text(origin.scene_files_hash)},
          {"profile_hash", hash_text(origin.profile_hash)},
          {"pinhole_hash", hash_text(origin.pinhole_hash)},
          {"half_store", static_cast<int>(origin.half_store)},
          {kPicture, notes_json(origin.picture)}};
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw FileError("cannot join '" + path.string() + "': " + why);
}

[[noreturn]] void refuse_damaged(const SumsFile& file, const std::string& why) {
  refuse(file.path, why + "; make shard " + std::to_string(file.shard.number) + "/" +
                        std::to_string(file.shard.count) + " again");
}

std::ifstream opened(const std::filesystem::path& path) {
  const auto cannot = [&](int error) { refuse(path, std::generic_category().message(error)); };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::is_directory(status)) cannot(EISDIR);
  // A pipe or a device could be read once, or without end.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    refuse(path, "it is no regular file");
  }
  errno = 0;
  std::ifstream stream{path, std::ios::binary};
  if (!stream) cannot(errno != 0 ? errno : ENOENT);
  return stream;
}

bool read_bytes(std::ifstream& stream, std::span<std::byte> bytes) {
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return static_cast<std::size_t>(stream.gcount()) == bytes.size();
}

std::uint64_t hash_at(const Json& header, std::string_view name) {
  return std::stoull(header.at(name).text(), nullptr, 16);
}

// Throws JsonError, or std::logic_error for a hash that is no number, if the header is none of
// ours.
void read_header(const Json& header, SumsFile& file) {
  const auto whole = [](const Json& json, std::int64_t least, std::int64_t most) {
    const std::int64_t value = json.integer();
    if (value < least || value > most) throw JsonError("a number is out of range");
    return static_cast<int>(value);
  };
  const Json& picture = header.at(kPicture);
  whole(header.at("softfocus_sums"), kSumsForm, kSumsForm);
  whole(picture.at("width"), 1, kMaxImageSize);
  whole(picture.at("height"), 1, kMaxImageSize);
  const std::optional<PictureNotes> notes = parse_notes(json_text(picture));
  if (!notes) throw JsonError("there are no notes");
  SumsOrigin& origin = file.origin;
  origin.picture = *notes;
  origin.samples = whole(header.at("samples"), 1, kMostSamples);
  origin.half_store = static_cast<HalfRounding>(
      whole(header.at("half_store"), 0, static_cast<int>(HalfRounding::swiftshader)));
  origin.scene_files_hash = hash_at(header, "scene_files_hash");
  origin.profile_hash = hash_at(header, "profile_hash");
  origin.pinhole_hash = hash_at(header, "pinhole_hash");
  file.shard.count = whole(header.at("shards"), 1, most_shards(origin.samples));
  file.shard.number = whole(header.at(kShard), 1, file.shard.count);
}

// The file's bytes in order, behind the header, with the checksum of what has passed.
class SumsBytes {
 public:
  explicit SumsBytes(const SumsFile& file) : file_(file), stream_(opened(file.path)) {
    std::vector<std::byte> before(kBeforeHeader + file.header.size());
    read(before);
  }

  void read(std::span<std::byte> bytes) {
    if (!read_bytes(stream_, bytes)) refuse_damaged(file_, "it is cut short");
    add_bytes(hash_, bytes);
  }

  void check() {
    const std::uint64_t expected = hash_.value;
    std::array<std::byte, sizeof expected> last;
    read(last);
    if (little_endian<std::uint64_t>(last) != expected) {
      refuse_damaged(file_, "it is damaged: its checksum is another");
    }
  }

 private:
  const SumsFile& file_;
  std::ifstream stream_;
  Hash hash_;
};

// Calls depth_row(y, bytes) and totals_row(y, bytes) for every row, and checks the sum.
template <class DepthRow, class TotalsRow>
void read_rows(const SumsFile& file, const DepthRow& depth_row, const TotalsRow& totals_row) {
  const auto width = static_cast<std::size_t>(file.origin.picture.width);
  const int height = file.origin.picture.height;
  SumsBytes bytes{file};
  std::vector<std::byte> row_bytes(width * sizeof(std::uint16_t));
  for (int y = 0; y < height; ++y) {
    bytes.read(row_bytes);
    depth_row(y, row_bytes);
  }
  row_bytes.resize(width * kColours * sizeof(double));
  for (int y = 0; y < height; ++y) {
    bytes.read(row_bytes);
    totals_row(y, row_bytes);
  }
  bytes.check();
}

}  // namespace

void write_sums_file(const std::filesystem::path& path, const Shard& shard,
                     const SumsOrigin& origin, const SampleSums& sums, const Image& pinhole) {
  WholeFile file{path};
  Hash hash;
  Bytes bytes;
  const auto write = [&] {
    add_bytes(hash, bytes);
    file.write(bytes);
    bytes.clear();
  };
  const std::string header = json_text(header_json(shard, origin));
  const auto append_text = [&](std::string_view text) {
    const auto more = std::as_bytes(std::span{text.data(), text.size()});
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  append_text(kSumsMagic);
  append_little_endian(bytes, static_cast<std::uint32_t>(header.size()));
  append_text(header);
  write();
  for (int y = 0; y < sums.height; ++y) {
    const auto halves = row<std::uint16_t>(pinhole, y);
    for (std::size_t i = 3; i < halves.size(); i += kTexelHalves) {
      append_little_endian(bytes, halves[i]);
    }
    write();
  }
  for (int y = 0; y < sums.height; ++y) {
    for (int x = 0; x < sums.width; ++x) {
      const double* totals = sums_at(sums, x, y);
      for (std::size_t c = 0; c < kColours; ++c) {
        append_little_endian(bytes, std::bit_cast<std::uint64_t>(totals[c]));
      }
    }
    write();
  }
  append_little_endian(bytes, hash.value);
  file.write(bytes);
  file.commit();
}

SumsFile open_sums_file(const std::filesystem::path& path) {
  std::ifstream stream = opened(path);
  std::array<std::byte, kBeforeHeader> begin;
  if (!read_bytes(stream, begin) ||
      std::memcmp(begin.data(), kSumsMagic.data(), kSumsMagic.size()) != 0) {
    refuse(path, "it holds no sums; give what softfocus render --shard wrote");
  }
  const auto header_bytes =
      little_endian<std::uint32_t>(std::span{begin}.subspan(kSumsMagic.size()));
  if (header_bytes > kMostHeaderBytes) refuse(path, "its header is damaged; make it again");
  std::string text(header_bytes, '\0');
  if (!read_bytes(stream, std::as_writable_bytes(std::span{text.data(), text.size()}))) {
    refuse(path, "it is cut short; make it again");
  }
  SumsFile file{.path = path, .shard = {}, .origin = {}, .header = std::move(text)};
  try {
    const std::optional<Json> header = parse_json(file.header);
    if (!header) throw JsonError("the header is no JSON");
    const std::string& version = header->at(kPicture).at("softfocus").text();
    if (version != SOFTFOCUS_VERSION) {
      refuse(path, "softfocus " + version +
                       " wrote it, and this is " SOFTFOCUS_VERSION
                       "; join it with the version that wrote it");
    }
    read_header(*header, file);
  } catch (const JsonError&) {
    refuse(path, "its header is damaged; make it again");
  } catch (const std::logic_error&) {
    refuse(path, "its header is damaged; make it again");
  }
  const PictureNotes& picture = file.origin.picture;
  const std::uint64_t wanted =
      kBeforeHeader + header_bytes + bytes_after_header(picture.width, picture.height);
  std::error_code error;
  const std::uint64_t there = std::filesystem::file_size(path, error);
  if (error) refuse(path, error.message());
  if (there != wanted) {
    refuse_damaged(file, std::string{there < wanted ? "it is cut short: " : "it is too long: "} +
                             std::to_string(there) + " bytes, not " + std::to_string(wanted));
  }
  return file;
}

std::string difference(const SumsFile& file, const SumsFile& first) {
  const auto text_of = [](const Json* value) { return value ? json_text(*value) : "missing"; };
  const auto of_member = [&](const Json& members, const Json& others, const std::string& name) {
    const std::string value = text_of(members.find(name)), other = text_of(others.find(name));
    return value == other ? std::string{} : name + " is " + value + ", not " + other;
  };
  const auto of_members = [&](const Json& members, const Json& others) {
    for (const std::string& name : members.names()) {
      if (name == kShard || name == kPicture) continue;
      std::string found = of_member(members, others, name);
      if (!found.empty()) return found;
    }
    return std::string{};
  };
  const Json header = *parse_json(file.header), first_header = *parse_json(first.header);
  const std::string found = of_members(header.at(kPicture), first_header.at(kPicture));
  return !found.empty() ? found : of_members(header, first_header);
}

void check_sums_file(const SumsFile& file) {
  const auto ignore = [](int, std::span<const std::byte>) {};
  read_rows(file, ignore, ignore);
}

void add_sums_file(const SumsFile& file, SampleSums& sums, Image& depth) {
  const auto add_depth = [&](int y, std::span<const std::byte> bytes) {
    const auto halves = row<std::uint16_t>(depth, y);
    for (std::size_t i = 3; i < halves.size(); i += kTexelHalves) {
      halves[i] = little_endian<std::uint16_t>(bytes);
      bytes = bytes.subspan(sizeof(std::uint16_t));
    }
  };
  const auto add_totals = [&](int y, std::span<const std::byte> bytes) {
    for (int x = 0; x < sums.width; ++x) {
      double* totals = sums_at(sums, x, y);
      for (std::size_t c = 0; c < kColours; ++c) {
        totals[c] += std::bit_cast<double>(little_endian<std::uint64_t>(bytes));
        bytes = bytes.subspan(sizeof(std::uint64_t));
      }
    }
  };
  read_rows(file, add_depth, add_totals);
  const SampleRange range = samples_of(file.shard, file.origin.samples);
  sums.count += range.end - range.begin;
}

}  // namespace softfocus
