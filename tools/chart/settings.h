#pragma once
// What `chart` measures: for each method a list of settings.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/dof.h"
#include "tools/files/json.h"

namespace softfocus {

/// One contender: a method with its settings. Those that it does not mind are left out.
struct ChartEntry {
  std::string method;
  const Method* filter = nullptr;  ///< null: the accumulation of `samples` pictures, or auto
  std::string profile = "ieee";    ///< a known profile
  std::optional<float> max_coc_px{};
  Arithmetic arithmetic = Arithmetic::floats;  ///< of two-pass
  int samples = 0;
  std::optional<double> max_error{};  ///< of auto, which chooses from the others
  std::string chosen{};               ///< by auto, once it has: "disc-layers, radius 16"
};

/// The names that --methods takes: every filter of dof/dof.h, accumulation and auto.
std::vector<std::string> chart_methods();

/// The settings of one of them for pictures of that height; `quick`: fewer. Integers have radii
/// of up to 64 pixels. A method for which
/// the table has no line of its own gets the table's last one.
std::vector<ChartEntry> chart_entries(const std::string& method, int height_px, bool quick);

/// {"max_coc_px": 16, "profile": "ieee"}, {"max_coc_px": 16, "profile": "ieee", "arithmetic":
/// "fixed-8"}, {"samples": 32} or {"max_error": 0.02, "chosen": "disc-layers, radius 16"}.
Json settings_json(const ChartEntry& entry);

/// "max-coc 16, d3d11", "32 samples", "max-error 0.02: disc-layers, radius 16"; the profile ieee
/// and no settings at all are not told.
std::string settings_text(const ChartEntry& entry);

/// Different for different entries, and fit for a file's name and for an address in a page:
/// "two-pass-r16-d3d11".
std::string entry_id(const ChartEntry& entry);

}  // namespace softfocus
