#pragma once
// What `chart` keeps in files to go on with later, as JSON.

#include <filesystem>
#include <optional>
#include <string>

#include "tools/chart/point.h"
#include "tools/files/json.h"

namespace softfocus {

/// Writes it whole or not at all. Throws FileError.
void write_json(const std::filesystem::path& file, const Json& json);

/// What a file holds, if it is there and is JSON.
std::optional<Json> read_json(const std::filesystem::path& file);

/// {psnr_db, ssim, flip, flip_silhouette, flip_near, flip_focus, flip_far}. What is no number
/// is null: an infinite PSNR, a region without pixels.
Json errors_json(const ChartErrors& errors);
ChartErrors errors_of(const Json& json);

/// Errors, the worst place and the pictures of a point, under a key. Times are kept apart: they
/// grow with each round.
void save_point(const ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// Fills these in, if they were kept under that key for a picture with the point's hash.
bool load_point(ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// The times of all points that have some, under a key.
void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

/// Fills in the times that were kept for the points' pictures under that key.
void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

}  // namespace softfocus
