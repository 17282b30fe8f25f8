#include "tools/chart/record.h"

#include <cmath>
#include <fstream>

#include "tools/chart/key.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/golden/hash_text.h"

namespace softfocus {
namespace {

double number_or(const Json& json, double otherwise) {
  return json.is_null() ? otherwise : json.number();
}

std::string flip_key(Region region) { return "flip_" + std::string{region_name(region)}; }

struct KeptPicture {
  const char* name;
  std::string ChartPictures::*picture;
};
constexpr std::array kPictures{KeptPicture{"picture", &ChartPictures::picture},
                               KeptPicture{"error", &ChartPictures::error},
                               KeptPicture{"worst", &ChartPictures::worst},
                               KeptPicture{"worst_truth", &ChartPictures::worst_truth},
                               KeptPicture{"worst_error", &ChartPictures::worst_error}};

}  // namespace

void write_json(const std::filesystem::path& file, const Json& json) {
  WholeFile whole{file};
  // A file's name need not be UTF-8, but JSON must be.
  whole.write(json_text(json, 1) + "\n");
  whole.commit();
}

std::optional<Json> read_json(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{stream}, {}};
  auto json = parse_json(text);
  if (json && !json->is_object()) json.reset();
  return json;
}

Json errors_json(const ChartErrors& errors) {
  Json json{
      {"psnr_db", number_or_null(errors.psnr_db)}, {"ssim", errors.ssim}, {"flip", errors.flip}};
  for (const Region region : kAllRegions) {
    json[flip_key(region)] =
        number_or_null(errors.flip_by_region[static_cast<std::size_t>(region)]);
  }
  return json;
}

ChartErrors errors_of(const Json& json) {
  ChartErrors errors;
  errors.psnr_db = number_or(json.at("psnr_db"), std::numeric_limits<double>::infinity());
  errors.ssim = json.at("ssim").number();
  errors.flip = json.at("flip").number();
  for (const Region region : kAllRegions) {
    errors.flip_by_region[static_cast<std::size_t>(region)] =
        number_or(json.at(flip_key(region)), std::numeric_limits<double>::quiet_NaN());
  }
  return errors;
}

void save_point(const ChartPoint& point, const std::string& key,
                const std::filesystem::path& file) {
  Json json{{"key", key},
            {"picture_hash", hash_text(point.picture_hash)},
            {"errors", errors_json(point.errors)},
            {"worst", {point.worst.x, point.worst.y, point.worst.side}}};
  for (const KeptPicture& of : kPictures) json["png"][of.name] = point.pictures.*of.picture;
  write_json(file, json);
}

bool load_point(ChartPoint& point, const std::string& key, const std::filesystem::path& file) {
  const auto json = read_json(file);
  if (!json) return false;
  try {
    if (json->at("key").text() != key) return false;
    if (json->at("picture_hash").text() != hash_text(point.picture_hash)) return false;
    ChartPoint filled = point;
    filled.errors = errors_of(json->at("errors"));
    const Json& worst = json->at("worst");
    const auto whole = [&](std::size_t i) { return static_cast<int>(worst.at(i).integer()); };
    filled.worst = {whole(0), whole(1), whole(2)};
    for (const KeptPicture& of : kPictures) {
      filled.pictures.*of.picture = json->at("png").at(of.name).text();
    }
    point = std::move(filled);
    return true;
  } catch (const JsonError&) {
    return false;  // damaged: it is measured again
  }
}

void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file) {
  Json json{{"key", key}, {"times", Json::object()}};
  for (const ChartPoint& point : points) {
    if (point.times.frame_ms.empty()) continue;
    json["times"][entry_id(point.entry)] = {{"picture_hash", hash_text(point.picture_hash)},
                                            {"frame_ms", point.times.frame_ms},
                                            {"filter_ms", point.times.filter_ms}};
  }
  write_json(file, json);
}

void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file) {
  const auto json = read_json(file);
  if (!json) return;
  try {
    if (json->at("key").text() != key) return;
    const Json& kept = json->at("times");
    for (ChartPoint& point : points) {
      const Json* found = kept.find(entry_id(point.entry));
      if (found == nullptr) continue;
      if (found->at("picture_hash").text() != hash_text(point.picture_hash)) continue;
      ChartTimes times{found->at("frame_ms").numbers(), found->at("filter_ms").numbers()};
      point.times = std::move(times);
    }
  } catch (const JsonError&) {
    return;  // damaged: what is missing is timed again
  }
}

}  // namespace softfocus
