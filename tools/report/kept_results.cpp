#include "tools/report/kept_results.h"

#include <bit>
#include <limits>

#include "raster/images/texel.h"
#include "tools/golden/hashes.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

bool has_hash(const Json* entry, const std::string& hash) {
  if (entry == nullptr || !entry->is_object()) return false;
  const Json* const of = entry->find("hash");
  return of != nullptr && of->is_text() && of->text() == hash;
}

}  // namespace

std::string hashes_of(std::span<const Image> pictures) {
  std::string text;
  for (const Image& picture : pictures) text += hash_text(hash_image(picture));
  return text;
}

KeptResults::KeptResults(std::filesystem::path file, const std::string& key)
    : file_(std::move(file)), json_{{"key", key}} {
  auto kept = read_json(file_);
  if (!kept) return;
  const Json* const kept_key = kept->find("key");
  if (kept_key != nullptr && kept_key->is_text() && kept_key->text() == key) {
    json_ = std::move(*kept);
  }
}

const Json* KeptResults::find(const std::string& entry, const std::string& hash,
                              const std::string& name) const {
  const Json* const found = json_.find(entry);
  return has_hash(found, hash) ? found->find(name) : nullptr;
}

std::optional<double> KeptResults::number(const std::string& entry, const std::string& hash,
                                          const std::string& name) const {
  const Json* const found = find(entry, hash, name);
  if (found == nullptr) return std::nullopt;
  if (found->is_null()) return std::numeric_limits<double>::infinity();
  try {
    return found->number();
  } catch (const JsonError&) {
    return std::nullopt;  // damaged: it is measured again
  }
}

std::optional<std::string> KeptResults::text(const std::string& entry, const std::string& hash,
                                             const std::string& name) const {
  const Json* const found = find(entry, hash, name);
  if (found == nullptr || !found->is_text()) return std::nullopt;
  return found->text();
}

void KeptResults::keep(const std::string& entry, const std::string& hash, const std::string& name,
                       Json value) {
  Json& of = json_[entry];
  if (!has_hash(&of, hash)) {
    of = Json::object();
    of["hash"] = hash;
  }
  of[name] = std::move(value);
  changed_ = true;
}

void KeptResults::save() {
  if (!changed_) return;
  write_json(file_, json_);
  changed_ = false;
}

SpecimenPair specimen_pair() {
  constexpr int kWidth = 56, kHeight = 40;
  Image truth = make_image(Format::rgba16f, kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float depth_m = x < 18 ? 1.0f : x < 36 ? 2.0f : 6.0f;
      const bool is_lamp = x % 13 == 5 && y % 11 == 4;
      const auto light = is_lamp ? 8.0f : static_cast<float>((3 * x + 5 * y) % 17) / 16.0f;
      const glm::vec4 texel{light, light / 2.0f, 1.0f - light / 8.0f, depth_m};
      store_texel<Format::rgba16f>(truth, x, y, texel, {});
    }
  }
  Image picture = with_wrong_pixels(truth);
  return {std::move(truth), std::move(picture)};
}

Image with_wrong_pixels(const Image& picture) {
  Image changed = picture;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const bool is_corner = 5 * x > 4 * picture.width && 4 * y < picture.height;
      const float factor = (x + 3 * y) % 5 == 0 ? 0.75f : is_corner ? 0.25f : 1.0f;
      const glm::vec4 texel = load_texel<Format::rgba16f>(picture, x, y);
      store_texel<Format::rgba16f>(changed, x, y, texel * glm::vec4{factor, factor, factor, 1.0f},
                                   {});
    }
  }
  return changed;
}

void add_number(Hash& hash, double number) {
  add_to_hash(hash, std::bit_cast<std::uint64_t>(number));
}

void add_text(Hash& hash, std::string_view text) {
  for (const char byte : text) add_to_hash(hash, static_cast<std::uint8_t>(byte));
}

}  // namespace softfocus
