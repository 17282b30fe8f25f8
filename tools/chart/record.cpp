#include "tools/chart/record.h"

#include <array>
#include <cmath>
#include <optional>

#include "tools/golden/hashes.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

double number_or(const Json& json, double otherwise) {
  return json.is_null() ? otherwise : json.number();
}

/// One FLIP of the whole and by region, in JSON under `name`.
struct FlipMembers {
  std::string name;
  double ChartErrors::*whole;
  std::array<double, kRegions> ChartErrors::*by_region;
};
const std::array<FlipMembers, 2>& flips() {
  static const std::array<FlipMembers, 2> members{
      FlipMembers{"flip", &ChartErrors::flip, &ChartErrors::flip_by_region},
      FlipMembers{"hdr_flip", &ChartErrors::hdr_flip, &ChartErrors::hdr_flip_by_region}};
  return members;
}

/// Errors that only some subjects have.
struct OwnError {
  const char* key;
  double ChartErrors::*value;
};
constexpr std::array kOwnErrors{OwnError{"wrong_pixels", &ChartErrors::wrong_pixels},
                                OwnError{"outline_px", &ChartErrors::outline_px},
                                OwnError{"renewals", &ChartErrors::renewals},
                                OwnError{"megabytes", &ChartErrors::megabytes}};

std::string region_key(const FlipMembers& of, Region region) {
  return of.name + "_" + std::string{region_name(region)};
}

/// What a file keeps under that key for the picture of that point; nullopt for another.
std::optional<Json> kept_for(const ChartPoint& point, const std::string& key,
                             const std::filesystem::path& file) {
  auto json = read_json(file);
  if (!json || json->at("key").text() != key) return std::nullopt;
  if (json->at("picture_hash").text() != hash_text(point.picture_hash)) return std::nullopt;
  return json;
}

}  // namespace

Json errors_json(const ChartErrors& errors) {
  Json json{{"psnr_db", number_or_null(errors.psnr_db)}, {"ssim", errors.ssim}};
  for (const FlipMembers& of : flips()) {
    json[of.name] = errors.*of.whole;
    for (const Region region : kAllRegions) {
      json[region_key(of, region)] =
          number_or_null((errors.*of.by_region)[static_cast<std::size_t>(region)]);
    }
  }
  for (const OwnError& of : kOwnErrors) {
    if (!std::isnan(errors.*of.value)) json[of.key] = errors.*of.value;
  }
  return json;
}

ChartErrors errors_of(const Json& json) {
  ChartErrors errors;
  errors.psnr_db = number_or(json.at("psnr_db"), std::numeric_limits<double>::infinity());
  errors.ssim = json.at("ssim").number();
  for (const FlipMembers& of : flips()) {
    errors.*of.whole = json.at(of.name).number();
    for (const Region region : kAllRegions) {
      (errors.*of.by_region)[static_cast<std::size_t>(region)] =
          number_or(json.at(region_key(of, region)), std::numeric_limits<double>::quiet_NaN());
    }
  }
  for (const OwnError& of : kOwnErrors) {
    if (const Json* own = json.find(of.key)) errors.*of.value = own->number();
  }
  return errors;
}

void save_errors(const ChartPoint& point, const std::string& key,
                 const std::filesystem::path& file) {
  write_json(file, {{"key", key},
                    {"picture_hash", hash_text(point.picture_hash)},
                    {"errors", errors_json(point.errors)}});
}

bool load_errors(ChartPoint& point, const std::string& key, const std::filesystem::path& file) {
  try {
    const auto json = kept_for(point, key, file);
    if (json) point.errors = errors_of(json->at("errors"));
    return json.has_value();
  } catch (const JsonError&) {
    return false;  // damaged: it is measured again
  }
}

void save_pictures(const ChartPoint& point, const std::string& key,
                   const std::filesystem::path& file) {
  Json json{{"key", key},
            {"picture_hash", hash_text(point.picture_hash)},
            {"worst", {point.worst.x, point.worst.y, point.worst.side}}};
  for (const KeptPicture& of : kKeptPictures) json["png"][of.name] = point.pictures.*of.picture;
  write_json(file, json);
}

bool load_pictures(ChartPoint& point, const std::string& key, const std::filesystem::path& file) {
  try {
    const auto json = kept_for(point, key, file);
    if (!json) return false;
    const Json& worst = json->at("worst");
    const auto whole = [&](std::size_t i) { return static_cast<int>(worst.at(i).integer()); };
    ChartPictures pictures;
    for (const KeptPicture& of : kKeptPictures) {
      pictures.*of.picture = json->at("png").at(of.name).text();
    }
    point.worst = {whole(0), whole(1), whole(2)};
    point.pictures = std::move(pictures);
    return true;
  } catch (const JsonError&) {
    return false;  // damaged: they are made again
  }
}

void save_truth_picture(const std::string& picture, const std::string& key,
                        const std::filesystem::path& file) {
  write_json(file, {{"key", key}, {"picture", picture}});
}

std::string load_truth_picture(const std::string& key, const std::filesystem::path& file) {
  const auto json = read_json(file);
  try {
    return json && json->at("key").text() == key ? json->at("picture").text() : "";
  } catch (const JsonError&) {
    return "";  // damaged: it is made again
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
