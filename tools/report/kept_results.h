#pragma once
// Results that an experiment keeps to go on with later: one file of JSON, under a key.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "raster/images/image.h"
#include "raster/numbers/hash.h"
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

// A small fixed pair of pictures to try measures on: what they give for it goes into the key of
// what is kept, so that a changed measure is noticed.

/// RGBA16F, depth in alpha, of one size.
struct SpecimenPair {
  Image truth;
  Image picture;  ///< with_wrong_pixels() of it
};

/// Stripes, lights of up to 8 and three depths. Whole numbers and their quotients alone: no
/// function that a library computes in its own way.
SpecimenPair specimen_pair();

/// RGBA16F: every fifth pixel's light is changed, and a corner is wrong.
Image with_wrong_pixels(const Image& picture);

/// Adds a measure's number.
void add_number(Hash& hash, double number);
void add_text(Hash& hash, std::string_view text);

}  // namespace softfocus
