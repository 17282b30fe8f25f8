#include "tools/chart/record.h"

#include <algorithm>
#include <cmath>

#include "scenes/files/file_bytes.h"
#include "scenes/load/load_scene.h"
#include "tools/chart/measure.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/files/whole_file.h"
#include "tools/golden/hashes.h"
#include "tools/pictures/image_file.h"
#include "tools/report/laboratory.h"
#include "tools/report/worst_crop.h"

namespace softfocus {
namespace {

/// Enough to show every edge from several sides, and done at once.
constexpr int kProbeSamples = 8;

constexpr std::size_t kLargestSceneFile = std::size_t{1} << 30;

std::uint64_t hash_bytes(std::string_view bytes) {
  Hash hash;
  add_text(hash, bytes);
  return hash.value;
}

/// The part of an entry that is kept under a hash, if `read` can read it.
template <class Read>
bool read_kept(const KeptResults& kept, const char* entry, const ChartPoint& point,
               const char* name, const Read& read) {
  const Json* const json = kept.find(entry, hash_text(point.picture_hash), name);
  try {
    if (json != nullptr) read(*json);
    return json != nullptr;
  } catch (const JsonError&) {
    return false;  // damaged: it is measured again
  }
}

}  // namespace

std::string truth_key(const ChartScene& scene, const std::string& file_bytes, int samples,
                      std::uint64_t measures, ThreadPool& pool) {
  const Image probe = accumulation(accumulation_input(scene, kProbeSamples), pool).picture;
  const ThinLens& lens = scene.lens;
  return "softfocus " SOFTFOCUS_VERSION "; of " + std::string{scene.subject->name} + "; scene " +
         scene.scene.name + "; file " + hash_text(hash_bytes(file_bytes)) + "; size " +
         size_text({scene.pinhole.width, scene.pinhole.height}) + "; frame " +
         exact_number(scene.frame) + "; focus " + exact_number(lens.focus_m) + " m; focal length " +
         exact_number(lens.focal_length_mm) + " mm; f/" + exact_number(lens.f_number) +
         "; aperture " + exact_number(scene.aperture_m) + " m; jitter " +
         std::to_string(scene.sampling.jitter) + "; shutter " +
         exact_number(scene.sampling.shutter_frames) + "; samples " + std::to_string(samples) +
         "; pinhole " + hash_text(hash_image(scene.pinhole)) + "; first samples " +
         hash_text(hash_image(probe)) + "; measures " + hash_text(measures);
}

std::string point_key(const std::string& truth_key, const Image& truth) {
  return truth_key + "; truth " + hash_text(hash_image(truth)) + "; pictures of " +
         std::to_string(kPagePicturePx);
}

std::string machine_key(const PoolOptions& pool) {
  return cpu_name().value_or("a CPU without a name") + "; " + compiler_name() + "; threads " +
         std::to_string(pool.threads) + "; " + std::string{isa_name(pool.isa)};
}

std::string scene_file_bytes(const std::string& scene,
                             const std::vector<std::filesystem::path>& from_user) {
  if (is_random_scene(scene)) return scene;
  const auto listings = list_scenes(scene_search_path(from_user));
  const auto found = std::find_if(listings.begin(), listings.end(),
                                  [&](const SceneListing& of) { return of.name == scene; });
  const std::filesystem::path file =
      found == listings.end() ? std::filesystem::path{scene} : found->file;
  return read_file_bytes(file, kLargestSceneFile);
}

Json errors_json(const ChartErrors& errors) {
  Json json = Json::object();
  for (const ChartMeasure& measure : chart_measures()) {
    const double value = measure.value(errors);
    if (!measure.is_own || !std::isnan(value)) json[measure.key] = number_or_null(value);
  }
  return json;
}

ChartErrors errors_of(const Json& json) {
  ChartErrors errors;
  for (const ChartMeasure& measure : chart_measures()) {
    const Json* const value = measure.is_own ? json.find(measure.key) : &json.at(measure.key);
    if (value == nullptr) continue;
    double& error = measure.of(errors);
    const bool is_psnr = &error == &errors.psnr_db;  // infinite of equal pictures
    error = !value->is_null() ? value->number()
            : is_psnr         ? std::numeric_limits<double>::infinity()
                              : std::numeric_limits<double>::quiet_NaN();
  }
  return errors;
}

Json pictures_json(const ChartPoint& point) {
  Json json = Json::object();
  json["place"] = {point.worst.x, point.worst.y, point.worst.side};
  for (const KeptPicture& of : kKeptPictures) json[of.name] = point.pictures.*of.picture;
  return json;
}

void take_pictures(const Json& json, ChartPoint& point) {
  const Json& place = json.at("place");
  const auto whole = [&](std::size_t i) { return static_cast<int>(place.at(i).integer()); };
  const Crop crop{whole(0), whole(1), whole(2)};
  ChartPictures pictures;
  for (const KeptPicture& of : kKeptPictures) pictures.*of.picture = json.at(of.name).text();
  point.worst = crop;
  point.pictures = std::move(pictures);
}

void save_times(const std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file) {
  KeptResults kept{file, key};
  for (const ChartPoint& point : points) {
    if (point.times.frame_ms.empty()) continue;
    const std::string id = entry_id(point.entry), hash = hash_text(point.picture_hash);
    kept.keep(id, hash, "frame_ms", point.times.frame_ms);
    kept.keep(id, hash, "filter_ms", point.times.filter_ms);
  }
  kept.save();
}

void load_times(std::vector<ChartPoint>& points, const std::string& key,
                const std::filesystem::path& file) {
  const KeptResults kept{file, key};
  for (ChartPoint& point : points) {
    const std::string id = entry_id(point.entry);
    ChartTimes times;
    const auto read = [&](const char* name, std::vector<double>& ms) {
      return read_kept(kept, id.c_str(), point, name,
                       [&](const Json& json) { ms = json.numbers(); });
    };
    if (read("frame_ms", times.frame_ms) && read("filter_ms", times.filter_ms)) {
      point.times = std::move(times);
    }
  }
}

namespace {

constexpr const char* kTruthEntry = "truth";

std::filesystem::path with_ending(const std::filesystem::path& file, const char* ending) {
  return file.string() + ending;
}

}  // namespace

ChartTruth make_truth(const ChartScene& scene, int samples,
                      const std::function<void(int)>& on_samples, ThreadPool& pool) {
  if (scene.subject->truth_of != nullptr) {
    return {scene.subject->truth_of(scene, pool), {}};
  }
  const HalvedViews views =
      halved_views(accumulation_input(scene, samples), 0, samples, on_samples, pool);
  const MeasuredPictures halves = measure_pictures(views.first_half, views.second_half,
                                                   &scene.labels, {.hdr_flip = true}, pool);
  return {views.all, chart_errors(halves)};
}

void save_truth(const ChartTruth& truth, const std::string& key,
                const std::filesystem::path& file) {
  WholeFile picture{with_ending(file, ".npy")};
  picture.write(encode_npy(truth.picture));
  picture.commit();
  KeptResults kept{with_ending(file, ".json"), key};
  kept.keep(kTruthEntry, hashes_of({&truth.picture, 1}), "noise_floor",
            errors_json(truth.noise_floor));
  kept.save();
}

std::optional<ChartTruth> load_truth(const std::string& key, const std::filesystem::path& file) {
  try {
    ChartTruth truth{read_image_file(with_ending(file, ".npy")).image, {}};
    const KeptResults kept{with_ending(file, ".json"), key};
    const Json* const noise = kept.find(kTruthEntry, hashes_of({&truth.picture, 1}), "noise_floor");
    if (noise == nullptr) return std::nullopt;
    truth.noise_floor = errors_of(*noise);
    return truth;
  } catch (const FileError&) {
  } catch (const JsonError&) {
  }
  return std::nullopt;  // damaged: it is made again
}

}  // namespace softfocus
