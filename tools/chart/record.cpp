#include "tools/chart/record.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/chart/key.h"
#include "tools/golden/hash_text.h"
#include "tools/files/whole_file.h"

namespace softfocus {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

double number_or(const ordered_json& json, double otherwise) {
  return json.is_null() ? otherwise : json.get<double>();
}

std::string flip_key(Region region) { return "flip_" + std::string{region_name(region)}; }

struct NamedPicture {
  const char* name;
  std::string ChartPictures::*picture;
};
constexpr std::array kPictures{NamedPicture{"picture", &ChartPictures::picture},
                               NamedPicture{"error", &ChartPictures::error},
                               NamedPicture{"worst", &ChartPictures::worst},
                               NamedPicture{"worst_truth", &ChartPictures::worst_truth},
                               NamedPicture{"worst_error", &ChartPictures::worst_error}};

}  // namespace

void write_json(const std::filesystem::path& file, const ordered_json& json) {
  WholeFile whole{file};
  // A file's name need not be UTF-8, but JSON must be.
  whole.write(json.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n");
  whole.commit();
}

std::optional<ordered_json> read_json(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  ordered_json json = ordered_json::parse(stream, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  return json;
}

ordered_json errors_json(const ChartErrors& errors) {
  ordered_json json{
      {"psnr_db", number(errors.psnr_db)}, {"ssim", errors.ssim}, {"flip", errors.flip}};
  for (const Region region : kAllRegions) {
    json[flip_key(region)] = number(errors.flip_by_region[static_cast<std::size_t>(region)]);
  }
  return json;
}

ChartErrors errors_of(const ordered_json& json) {
  ChartErrors errors;
  errors.psnr_db = number_or(json.at("psnr_db"), std::numeric_limits<double>::infinity());
  errors.ssim = json.at("ssim").get<double>();
  errors.flip = json.at("flip").get<double>();
  for (const Region region : kAllRegions) {
    errors.flip_by_region[static_cast<std::size_t>(region)] =
        number_or(json.at(flip_key(region)), std::numeric_limits<double>::quiet_NaN());
  }
  return errors;
}

void save_point(const ChartPoint& point, const std::string& key,
                const std::filesystem::path& file) {
  ordered_json json{{"key", key},
                    {"picture_hash", hash_text(point.picture_hash)},
                    {"errors", errors_json(point.errors)},
                    {"worst", {point.worst.x, point.worst.y, point.worst.side}}};
  for (const NamedPicture& of : kPictures) json["png"][of.name] = point.pictures.*of.picture;
  write_json(file, json);
}

bool load_point(ChartPoint& point, const std::string& key, const std::filesystem::path& file) {
  const auto json = read_json(file);
  if (!json || json->value("key", "") != key) return false;
  if (json->value("picture_hash", "") != hash_text(point.picture_hash)) return false;
  try {
    ChartPoint filled = point;
    filled.errors = errors_of(json->at("errors"));
    const auto& worst = json->at("worst");
    filled.worst = {worst.at(0).get<int>(), worst.at(1).get<int>(), worst.at(2).get<int>()};
    for (const NamedPicture& of : kPictures) {
      filled.pictures.*of.picture = json->at("png").at(of.name).get<std::string>();
    }
    point = std::move(filled);
    return true;
  } catch (const ordered_json::exception&) {
    return false;  // damaged: it is measured again
  }
}

void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file) {
  ordered_json json{{"key", key}, {"times", ordered_json::object()}};
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
  if (!json || json->value("key", "") != key) return;
  try {
    const auto& kept = json->at("times");
    for (ChartPoint& point : points) {
      const auto found = kept.find(entry_id(point.entry));
      if (found == kept.end()) continue;
      if (found->at("picture_hash") != hash_text(point.picture_hash)) continue;
      ChartTimes times{found->at("frame_ms"), found->at("filter_ms")};
      point.times = std::move(times);
    }
  } catch (const ordered_json::exception&) {
    return;  // damaged: what is missing is timed again
  }
}

}  // namespace softfocus
