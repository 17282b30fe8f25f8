#include "tools/chart/truth.h"

#include <algorithm>
#include <cassert>

#include "tools/chart/record.h"
#include "tools/cli/errors.h"
#include "tools/files/whole_file.h"
#include "tools/pictures/image_file.h"
#include "tools/report/kept_results.h"

namespace softfocus {
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
  // Half of the samples must end a group, or the bits would differ from accumulation()'s with
  // `until`.
  assert(samples % kTruthSampleStep == 0);
  const LensViewInput input = accumulation_input(scene, samples);
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  SampleSums sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  const auto add_until = [&](int last) {
    while (sums.count < last) {
      add_lens_views(buffer, input, sums.count, std::min(sums.count + kLensViewGroup, last), sums,
                     pool);
      on_samples(sums.count);
    }
  };
  add_until(samples / 2);
  const SampleSums first = sums;
  add_until(samples);
  const auto mean = [&](const SampleSums& of) {
    return mean_picture(of, input.pinhole, input.profile, pool);
  };
  const MeasuredPictures halves = measure_pictures(mean(first), mean(later_samples(first, sums)),
                                                   &scene.labels, {.hdr_flip = true}, pool);
  return {mean(sums), chart_errors(halves)};
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

void save_truth_picture(const std::string& picture, const std::string& key,
                        const std::filesystem::path& file) {
  KeptResults kept{file, key};
  kept.keep(kTruthEntry, "", "picture", picture);
  kept.save();
}

std::string load_truth_picture(const std::string& key, const std::filesystem::path& file) {
  return KeptResults{file, key}.text(kTruthEntry, "", "picture").value_or("");
}

}  // namespace softfocus
