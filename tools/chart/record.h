#pragma once
// What `chart` keeps in files to go on with later, as JSON.

#include <filesystem>
#include <string>

#include "tools/chart/point.h"
#include "tools/files/json.h"

namespace softfocus {

/// {psnr_db, ssim, flip, flip_silhouette, flip_near, flip_focus, flip_far, hdr_flip,
/// hdr_flip_silhouette, hdr_flip_near, hdr_flip_focus, hdr_flip_far}. An infinite PSNR and a
/// region without pixels are null.
Json errors_json(const ChartErrors& errors);
ChartErrors errors_of(const Json& json);

/// A point's errors, under a key. Pictures are kept apart, for most points have none, and times,
/// which grow with each round.
void save_errors(const ChartPoint& point, const std::string& key,
                 const std::filesystem::path& file);

/// Fills in what save_errors() kept under that key, if the picture's hash is the point's.
bool load_errors(ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// Likewise the pictures and the worst place.
void save_pictures(const ChartPoint& point, const std::string& key,
                   const std::filesystem::path& file);
bool load_pictures(ChartPoint& point, const std::string& key, const std::filesystem::path& file);

/// The truth reduced for the page, under the key of its scene's points; empty if none is kept.
void save_truth_picture(const std::string& picture, const std::string& key,
                        const std::filesystem::path& file);
std::string load_truth_picture(const std::string& key, const std::filesystem::path& file);

/// The times of all points that have some, under a key.
void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

/// Fills in the times kept under that key, for points whose pictures have the same hash.
void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file);

}  // namespace softfocus
