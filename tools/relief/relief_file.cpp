#include "tools/relief/relief_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <string>

#include "raster/numbers/hash.h"
#include "raster/numbers/vector_math.h"
#include "scenes/files/file_bytes.h"
#include "tools/cli/errors.h"
#include "tools/files/byte_order.h"

namespace softfocus {
namespace {

constexpr std::string_view kReliefMagic = "SFRELIEF";
constexpr std::uint32_t kOrthographicVersion = 1, kPerspectiveVersion = 2;
constexpr std::size_t kMaterialBytes = 6 * 4 + 2 * 4;
constexpr int kMostShininess = 1024;
constexpr std::size_t kReliefHeader = 8 + 5 * 4 + 13 * 8, kReliefEye = 3 * 8, kReliefSum = 8;
constexpr std::size_t kMostReliefBytes = kReliefHeader + kReliefEye +
                                         std::size_t{kMostReliefSize} * kMostReliefSize * 12 + 4 +
                                         kMostReliefMaterials * kMaterialBytes + kReliefSum;

std::uint64_t sum_of(std::span<const std::byte> bytes) {
  Hash hash;
  for (const std::byte byte : bytes) add_to_hash(hash, std::to_integer<std::uint8_t>(byte));
  return hash.value;
}

void append_number(std::vector<std::byte>& bytes, double value) {
  append_little_endian(bytes, std::bit_cast<std::uint64_t>(value));
}

void append_vector(std::vector<std::byte>& bytes, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) append_number(bytes, v[i]);
}

void append_threes(std::vector<std::byte>& bytes, const std::vector<std::uint32_t>& values) {
  for (const std::uint32_t value : values) {
    for (int i = 0; i < 3; ++i) bytes.push_back(static_cast<std::byte>(value >> (8 * i) & 255u));
  }
}

/// The unread bytes, which were measured before.
struct ReliefReader {
  std::span<const std::byte> rest;

  template <class T>
  T take() {
    const T value = little_endian<T>(rest);
    rest = rest.subspan(sizeof(T));
    return value;
  }
  double take_number() { return std::bit_cast<double>(take<std::uint64_t>()); }
  glm::dvec3 take_vector() {
    glm::dvec3 v;
    for (int i = 0; i < 3; ++i) v[i] = take_number();
    return v;
  }
  std::uint32_t take_three() {
    std::uint32_t value = 0;
    for (int i = 0; i < 3; ++i) value |= std::uint32_t{take<std::uint8_t>()} << (8 * i);
    return value;
  }
};

[[noreturn]] void refuse_relief(const std::filesystem::path& file, const std::string& why) {
  throw FileError("'" + file.string() + "': " + why);
}

void append_unlit(std::vector<std::byte>& bytes, const ReliefTexture& relief) {
  append_threes(bytes, relief.unlit);
  for (const std::uint32_t normal : relief.normals) {
    bytes.push_back(static_cast<std::byte>(normal >> 24));
  }
  append_little_endian(bytes, static_cast<std::uint32_t>(relief.materials.size()));
  for (const ReliefMaterial& material : relief.materials) {
    for (const glm::vec3& v : {material.ambient, material.specular}) {
      for (int i = 0; i < 3; ++i) append_little_endian(bytes, std::bit_cast<std::uint32_t>(v[i]));
    }
    append_little_endian(bytes, static_cast<std::uint32_t>(material.shininess));
    append_little_endian(bytes, std::uint32_t{material.lit ? 1u : 0u});
  }
}

/// Reads the part behind the normals of an unlit relief, in a file of the right length.
void read_unlit(ReliefReader& reader, const std::filesystem::path& file, ReliefTexture& relief) {
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  relief.unlit.reserve(relief.depths.size());
  for (const std::uint16_t depth : relief.depths) {
    const std::uint32_t colour = reader.take_three();
    relief.unlit.push_back(depth == empty ? 0 : colour | 0xFF000000u);
  }
  std::uint32_t most = 0;
  for (std::uint32_t& normal : relief.normals) {
    const std::uint32_t number = reader.take<std::uint8_t>();
    most = std::max(most, number);
    normal |= number << 24;
  }
  const auto count = reader.take<std::uint32_t>();
  if (most >= count) {
    refuse_relief(file, "has a texel of material " + std::to_string(most) + " of " +
                            std::to_string(count) + "; the first is 0");
  }
  relief.materials.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    ReliefMaterial& material = relief.materials.emplace_back();
    bool is_right = true;
    for (glm::vec3* v : {&material.ambient, &material.specular}) {
      for (int axis = 0; axis < 3; ++axis) {
        (*v)[axis] = std::bit_cast<float>(reader.take<std::uint32_t>());
        is_right = is_right && std::isfinite((*v)[axis]) && (*v)[axis] >= 0.0f;
      }
    }
    const auto shininess = reader.take<std::uint32_t>(), lit = reader.take<std::uint32_t>();
    if (!is_right || shininess < 1 || shininess > kMostShininess || lit > 1) {
      refuse_relief(file, "has a wrong material " + std::to_string(i) +
                              ": shares must be 0 or more, a shininess from 1 to " +
                              std::to_string(kMostShininess) + ", and lit 0 or 1");
    }
    material.shininess = static_cast<int>(shininess);
    material.lit = lit == 1;
  }
}

/// In metres: with these, all constants of a warp are numbers of binary32.
constexpr double kLeastReliefSize = 1e-9, kMostReliefPlace = 1e9;

bool is_place(const glm::dvec3& place) {
  return std::fabs(place.x) <= kMostReliefPlace && std::fabs(place.y) <= kMostReliefPlace &&
         std::fabs(place.z) <= kMostReliefPlace;
}

bool is_size(double size_m) { return size_m >= kLeastReliefSize && size_m <= kMostReliefPlace; }

bool is_camera(const ReliefCamera& camera) {
  const double a = std::sqrt(dot(camera.a, camera.a)), b = std::sqrt(dot(camera.b, camera.b));
  const double f = std::sqrt(dot(camera.f, camera.f));
  constexpr double kSquare = 1e-6;
  return is_place(camera.origin) && is_size(a) && is_size(b) && is_size(camera.depth_m) &&
         std::fabs(f - 1.0) < kSquare && std::fabs(dot(camera.a, camera.b)) < kSquare * a * b &&
         std::fabs(dot(camera.a, camera.f)) < kSquare * a &&
         std::fabs(dot(camera.b, camera.f)) < kSquare * b;
}

/// Whether a perspective camera's eye sees the last depth at a finite distance, and would see the
/// code that is empty.
bool is_eye_before(const ReliefCamera& camera) {
  return is_place(*camera.eye) && camera.depth_m * (255.0 / 254.0) < source_distance(camera);
}

}  // namespace

void check_relief_size(const ReliefTexture& relief, const std::string& of) {
  if (is_camera(relief.camera) && (!relief.camera.eye || is_eye_before(relief.camera))) return;
  throw UsageError(
      "'" + of +
      "': its relief has texels or a depth below 1e-9 m or above 1e9 m, or lies farther "
      "away; what is larger or smaller would be right");
}

std::vector<std::byte> encode_relief(const ReliefTexture& relief) {
  std::vector<std::byte> bytes;
  for (const char letter : kReliefMagic) bytes.push_back(static_cast<std::byte>(letter));
  append_little_endian(bytes, relief.camera.eye ? kPerspectiveVersion : kOrthographicVersion);
  append_little_endian(bytes, static_cast<std::uint32_t>(relief.width));
  append_little_endian(bytes, static_cast<std::uint32_t>(relief.height));
  append_little_endian(bytes, static_cast<std::uint32_t>(relief.depth_bits));
  append_little_endian(bytes, std::uint32_t{!relief.unlit.empty()     ? 2u
                                            : !relief.normals.empty() ? 1u
                                                                      : 0u});
  const ReliefCamera& camera = relief.camera;
  for (const glm::dvec3& v : {camera.origin, camera.a, camera.b, camera.f}) append_vector(bytes, v);
  append_number(bytes, camera.depth_m);
  if (camera.eye) append_vector(bytes, *camera.eye);
  for (const std::uint16_t code : relief.depths) {
    if (relief.depth_bits == 8) {
      bytes.push_back(static_cast<std::byte>(code));
    } else {
      append_little_endian(bytes, code);
    }
  }
  append_threes(bytes, relief.colours);
  append_threes(bytes, relief.normals);
  if (!relief.unlit.empty()) append_unlit(bytes, relief);
  append_little_endian(bytes, sum_of(bytes));
  return bytes;
}

ReliefTexture decode_relief(std::string_view text, const std::filesystem::path& file) {
  const std::span<const std::byte> bytes{reinterpret_cast<const std::byte*>(text.data()),
                                         text.size()};
  if (!text.starts_with(kReliefMagic)) {
    refuse_relief(file, "is no relief texture; softfocus relief make writes one");
  }
  if (bytes.size() < kReliefHeader + kReliefSum) {
    refuse_relief(file, "is cut short, in its first " + std::to_string(kReliefHeader) + " bytes");
  }
  ReliefReader reader{bytes.subspan(kReliefMagic.size())};
  const auto version = reader.take<std::uint32_t>();
  const auto width = reader.take<std::uint32_t>(), height = reader.take<std::uint32_t>();
  const auto bits = reader.take<std::uint32_t>(), maps = reader.take<std::uint32_t>();
  if (version != kOrthographicVersion && version != kPerspectiveVersion) {
    refuse_relief(file, "has version " + std::to_string(version) + "; 1 or 2 would be right");
  }
  if (width < 1 || width > kMostReliefSize || height < 1 || height > kMostReliefSize) {
    refuse_relief(file, "claims " + std::to_string(width) + "x" + std::to_string(height) +
                            " texels; each side has 1 to " + std::to_string(kMostReliefSize));
  }
  if ((bits != 8 && bits != 16) || maps > 2) {
    refuse_relief(file, "claims " + std::to_string(bits) + " bits of depth and " +
                            std::to_string(maps) +
                            " for its maps; 8 or 16, and 0, 1 or 2 would be right");
  }
  const std::size_t texels = std::size_t{width} * height;
  const std::size_t with_normals = maps > 0 ? 1 : 0, is_unlit = maps == 2 ? 1 : 0;
  std::size_t wanted = kReliefHeader + (version == kPerspectiveVersion ? kReliefEye : 0) +
                       texels * (bits / 8 + 3 + 3 * with_normals + 4 * is_unlit) + kReliefSum;
  if (maps == 2) {
    wanted += 4;
    if (bytes.size() >= wanted) {
      const auto count = little_endian<std::uint32_t>(bytes.subspan(wanted - kReliefSum - 4));
      if (count < 1 || count > kMostReliefMaterials) {
        refuse_relief(file, "claims " + std::to_string(count) + " materials; 1 to " +
                                std::to_string(kMostReliefMaterials) + " would be right");
      }
      wanted += count * kMaterialBytes;
    }
  }
  if (bytes.size() != wanted) {
    refuse_relief(file, "has " + std::to_string(bytes.size()) + " bytes; " + std::to_string(width) +
                            "x" + std::to_string(height) + " texels take " +
                            std::to_string(wanted));
  }
  if (little_endian<std::uint64_t>(bytes.last(kReliefSum)) !=
      sum_of(bytes.first(bytes.size() - kReliefSum))) {
    refuse_relief(file, "was changed since it was written: its sum is wrong; make it anew");
  }
  ReliefTexture relief;
  relief.width = static_cast<int>(width);
  relief.height = static_cast<int>(height);
  relief.depth_bits = static_cast<int>(bits);
  ReliefCamera& camera = relief.camera;
  for (glm::dvec3* v : {&camera.origin, &camera.a, &camera.b, &camera.f}) *v = reader.take_vector();
  camera.depth_m = reader.take_number();
  if (!is_camera(camera)) {
    refuse_relief(file,
                  "has no camera: a, b and f must be at right angles, f of length 1, the depth "
                  "above 0, sizes from 1e-9 to 1e9 m, and places within 1e9 m");
  }
  if (version == kPerspectiveVersion) {
    camera.eye = reader.take_vector();
    if (!is_eye_before(camera)) {
      refuse_relief(file,
                    "has no camera: its eye must be before the plane, by more than the last depth");
    }
  }
  relief.depths.reserve(texels);
  for (std::size_t i = 0; i < texels; ++i) {
    relief.depths.push_back(bits == 8 ? reader.take<std::uint8_t>() : reader.take<std::uint16_t>());
  }
  const std::uint16_t empty = empty_depth(relief.depth_bits);
  for (std::size_t i = 0; i < texels; ++i) {
    const std::uint32_t colour = reader.take_three();
    relief.colours.push_back(relief.depths[i] == empty ? 0 : colour | 0xFF000000u);
  }
  for (std::size_t i = 0; i < texels * with_normals; ++i) {
    relief.normals.push_back(reader.take_three());
  }
  if (maps == 2) read_unlit(reader, file, relief);
  if (!relief_extent(relief)) {
    refuse_relief(
        file, "shows nothing: all its depths are " + std::to_string(empty) + ", which is empty");
  }
  return relief;
}

ReliefTexture read_relief_file(const std::filesystem::path& file) {
  return decode_relief(read_file_bytes(file, kMostReliefBytes), file);
}

}  // namespace softfocus
