#pragma once
// What a check of goldens found: a page, JSON and JUnit's XML.

#include <string>
#include <vector>

#include "tools/files/json.h"
#include "tools/goldens/check.h"

namespace softfocus {

struct GoldensChecked {
  std::string folder;  ///< as the user named it
  std::string accept;  ///< the command that takes new pictures, but for their names
  std::vector<Golden> goldens;
  std::vector<GoldenResult> results;  ///< of each
  double seconds = 0.0;
};

/// folder, accept, passes, fails, new, breaks (counts), seconds, goldens [{name, made_by, verdict,
/// why, hash, expected_hash, was, ms}]; for the page also got, expected, difference (PNG in base64)
/// of the first 200 that do not pass.
Json goldens_json(const GoldensChecked& checked, bool with_pictures);

/// One page that needs no other file.
std::string goldens_page(const GoldensChecked& checked);

/// As CI systems read it: what fails or is new is a failure, what breaks an error.
std::string junit_xml(const GoldensChecked& checked);

}  // namespace softfocus
