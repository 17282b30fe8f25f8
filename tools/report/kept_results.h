#pragma once
// Results that an experiment keeps to go on with later: one file of JSON, under a key.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "raster/images/image.h"
#include "tools/files/json.h"

namespace softfocus {

/// Hashes of some pictures, one after the other.
std::string hashes_of(std::span<const Image> pictures);

/// Entries by name, each kept under a hash of its own: that of the pictures it was measured on. A
/// damaged value counts as none.
class KeptResults {
 public:
  /// Reads the file. If it is damaged or has another key, nothing is kept.
  KeptResults(std::filesystem::path file, const std::string& key);

  /// A value, or null where none is kept under that hash.
  const Json* find(const std::string& entry, const std::string& hash,
                   const std::string& name) const;
  std::optional<double> number(const std::string& entry, const std::string& hash,
                               const std::string& name) const;
  std::optional<std::string> text(const std::string& entry, const std::string& hash,
                                  const std::string& name) const;
  /// Another hash takes the place of all that was kept of the entry. Numbers that are not finite
  /// come back as infinity.
  void keep(const std::string& entry, const std::string& hash, const std::string& name, Json value);

  /// Writes the file if something was kept since. Throws FileError.
  void save();

 private:
  std::filesystem::path file_;
  Json json_;
  bool changed_ = false;
};

}  // namespace softfocus
