#include "tools/report/kept_results.h"

#include <limits>

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

}  // namespace softfocus
