#include "tools/files/same_file.h"

#include "tools/cli/errors.h"

namespace softfocus {

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  if (a == b) return true;
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error) && !error) return true;
  std::error_code error_a, error_b;
  const auto whole_a = std::filesystem::absolute(a, error_a);  // an empty name has no place
  const auto whole_b = std::filesystem::absolute(b, error_b);
  if (error_a || error_b) return false;
  const auto place_a = std::filesystem::weakly_canonical(whole_a, error_a);
  const auto place_b = std::filesystem::weakly_canonical(whole_b, error_b);
  return !error_a && !error_b && place_a == place_b;
}

void check_not_read(const std::string& option, const std::filesystem::path& output,
                    const std::vector<ReadFile>& inputs) {
  for (const auto& [file, what] : inputs) {
    if (!is_same_file(output, file)) continue;
    throw UsageError(std::string{option}
                         .append(" '")
                         .append(output.string())
                         .append("' would write over ")
                         .append(what)
                         .append(", '")
                         .append(file.string())
                         .append("'; give another name"));
  }
}

}  // namespace softfocus
