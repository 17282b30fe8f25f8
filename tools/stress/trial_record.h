#pragma once
// What `stress` keeps of a trial to go on with later: one file of JSON, under a key.

#include <filesystem>
#include <optional>
#include <string>

#include "tools/files/json.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// A line that differs whenever a value could, but for the methods' own pictures: version, case,
/// severity, views; of each frame its size, settings and hash, that of its calculated truth and of
/// its first views; and a hash of what the measures give for a wrong answer.
std::string trial_key(const StressCase& of, double severity, const StressTrial& trial, int views,
                      ThreadPool& pool);

/// Hashes of some pictures, one after the other.
std::string hashes_of(std::span<const Image> pictures);

/// Entries by name, each kept under a hash of its own: that of the pictures it was measured on.
class TrialRecord {
 public:
  /// Reads the file. If it is damaged or has another key, the record is empty.
  TrialRecord(std::filesystem::path file, const std::string& key);

  std::optional<double> number(const std::string& entry, const std::string& hash,
                               const std::string& name) const;
  std::optional<std::string> text(const std::string& entry, const std::string& hash,
                                  const std::string& name) const;
  /// Numbers that are not finite come back as infinity.
  void keep(const std::string& entry, const std::string& hash, const std::string& name, Json value);

  /// Writes the file if something was kept since. Throws FileError.
  void save();

 private:
  const Json* find(const std::string& entry, const std::string& hash,
                   const std::string& name) const;

  std::filesystem::path file_;
  Json json_;
  bool changed_ = false;
};

}  // namespace softfocus
