#include "tools/chart/key.h"

#include <algorithm>

#include "scenes/files/file_bytes.h"
#include "scenes/load/load_scene.h"
#include "tools/chart/measure.h"
#include "tools/cli/machine.h"
#include "tools/cli/option_values.h"
#include "tools/golden/hashes.h"
#include "tools/report/specimen.h"

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

}  // namespace softfocus
