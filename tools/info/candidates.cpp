#include "tools/info/candidates.h"

#include <algorithm>
#include <array>
#include <string>

#include "scenes/files/file_bytes.h"
#include "tools/cli/errors.h"
#include "tools/files/json.h"

namespace softfocus {
namespace {

constexpr std::size_t kLargestTable = 1 << 20;
constexpr std::array kCoefficients{
    &ErrorModel::always,     &ErrorModel::fine,      &ErrorModel::blurred, &ErrorModel::lost,
    &ErrorModel::near_edges, &ErrorModel::far_edges, &ErrorModel::ghosts};

ErrorModel model_of(const Json& json, const std::string& where) {
  ErrorModel model;
  std::vector<double> numbers;
  try {
    numbers = json.numbers();
  } catch (const JsonError&) {
    numbers.clear();
  }
  const bool are_fine = numbers.size() == kCoefficients.size() &&
                        std::all_of(numbers.begin(), numbers.end(),
                                    [](double number) { return number >= 0.0 && number < 1e9; });
  if (!are_fine) throw UsageError(where + ": give seven numbers of 0 or more");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    model.*kCoefficients[i] = static_cast<float>(numbers[i]);
  }
  return model;
}

}  // namespace

std::string candidate_id(const Candidate& candidate) {
  std::string id{candidate.method};
  if (candidate.radius >= 0) {
    const float radius_px = kFilterRadiiPx[static_cast<std::size_t>(candidate.radius)];
    id += ':' + std::to_string(static_cast<int>(radius_px));
  }
  if (candidate.samples >= 0) {
    id += ':' + std::to_string(kSampleCounts[static_cast<std::size_t>(candidate.samples)]);
  }
  return id;
}

std::vector<Candidate> read_candidate_table(const std::filesystem::path& file) {
  const std::string name = "--table " + file.string();
  const std::optional<Json> json = parse_json(read_file_bytes(file, kLargestTable));
  if (!json || !json->is_object()) {
    throw UsageError(name + ": this is no JSON object; give {\"two-pass:8\": [...], ...}");
  }
  std::vector<Candidate> table(candidates().begin(), candidates().end());
  for (std::size_t i = 0; i < json->names().size(); ++i) {
    const std::string& id = json->names()[i];
    const auto line = std::find_if(table.begin(), table.end(), [&](const Candidate& candidate) {
      return candidate_id(candidate) == id;
    });
    if (line == table.end()) {
      throw UsageError(std::string{name}
                           .append(": auto's table has no '")
                           .append(id)
                           .append("'; `softfocus candidates SCENE --json` lists its lines"));
    }
    line->error =
        model_of(json->values()[i], std::string{name}.append(": '").append(id).append("'"));
  }
  return table;
}

}  // namespace softfocus
