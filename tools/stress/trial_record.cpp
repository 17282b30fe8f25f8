#include "tools/stress/trial_record.h"

#include <limits>

#include "tools/cli/option_values.h"
#include "tools/golden/hashes.h"
#include "tools/report/report.h"
#include "tools/report/specimen.h"
#include "tools/stress/answers.h"
#include "tools/stress/stress_pictures.h"

namespace softfocus {
namespace {

bool has_hash(const Json* entry, const std::string& hash) {
  if (entry == nullptr || !entry->is_object()) return false;
  const Json* const of = entry->find("hash");
  return of != nullptr && of->is_text() && of->text() == hash;
}

/// What the measures of all cases on these pictures, and the page's pictures, give for a wrong
/// answer: it differs whenever one of them has changed.
std::uint64_t case_measures_hash(const StressCase& of, const StressAnswer& right) {
  std::vector<Image> wrong;
  for (const Image& picture : right.truth) wrong.push_back(with_wrong_pixels(picture));
  const StressAnswer answer{right.trial, right.severity, right.truth, wrong, right.pool};
  Hash hash;
  add_number(hash, of.measure(answer));
  for (const StressCase& other : stress_cases()) {
    if (other.name != of.name && same_trials(of, other)) add_number(hash, other.measure(answer));
  }
  const SpecimenPair pair = specimen_pair();
  const double gain = display_gain(pair.truth);
  add_number(hash, gain);
  add_text(hash, stress_picture(pair.picture, gain));
  add_text(hash, stress_error_picture(pair.truth, pair.picture, gain, right.pool));
  return hash.value;
}

}  // namespace

std::string hashes_of(std::span<const Image> pictures) {
  std::string text;
  for (const Image& picture : pictures) text += hash_text(hash_image(picture));
  return text;
}

std::string trial_key(const StressCase& of, double severity, const StressTrial& trial, int views,
                      ThreadPool& pool) {
  // They change with all of a scene that the sharp picture does not show.
  constexpr int kProbeViews = 16;
  std::string key = "softfocus " SOFTFOCUS_VERSION "; " + std::string{of.name} + " at " +
                    exact_number(severity) + "; views " + std::to_string(views);
  for (const StressFrame& frame : trial.frames) {
    const DofSettings& settings = frame.settings;
    key += "; size " + std::to_string(frame.sharp.height) + ", " +
           hash_text(hash_image(frame.sharp)) + ", at infinity " +
           exact_number(double{settings.coc.radius_at_infinity_px}) + " px, focus " +
           exact_number(double{settings.coc.focus_m}) + " m, max-coc " +
           exact_number(double{settings.max_coc_px}) + " px";
    if (frame.truth.width > 0) key += ", truth " + hash_text(hash_image(frame.truth));
  }
  const std::vector<Image> truth =
      make_stress_truth(trial, views == 0 ? 0 : kProbeViews, pool).pictures;
  if (views > 0) key += "; first views " + hashes_of(truth);
  return key + "; measures " +
         hash_text(case_measures_hash(of, {trial, severity, truth, {}, pool}));
}

TrialRecord::TrialRecord(std::filesystem::path file, const std::string& key)
    : file_(std::move(file)), json_{{"key", key}} {
  auto kept = read_json(file_);
  if (!kept) return;
  const Json* const kept_key = kept->find("key");
  if (kept_key != nullptr && kept_key->is_text() && kept_key->text() == key) {
    json_ = std::move(*kept);
  }
}

const Json* TrialRecord::find(const std::string& entry, const std::string& hash,
                              const std::string& name) const {
  const Json* const found = json_.find(entry);
  return has_hash(found, hash) ? found->find(name) : nullptr;
}

std::optional<double> TrialRecord::number(const std::string& entry, const std::string& hash,
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

std::optional<std::string> TrialRecord::text(const std::string& entry, const std::string& hash,
                                             const std::string& name) const {
  const Json* const found = find(entry, hash, name);
  if (found == nullptr || !found->is_text()) return std::nullopt;
  return found->text();
}

void TrialRecord::keep(const std::string& entry, const std::string& hash, const std::string& name,
                       Json value) {
  Json& of = json_[entry];
  if (!has_hash(&of, hash)) {
    of = Json::object();
    of["hash"] = hash;
  }
  of[name] = std::move(value);
  changed_ = true;
}

void TrialRecord::save() {
  if (!changed_) return;
  write_json(file_, json_);
  changed_ = false;
}

}  // namespace softfocus
