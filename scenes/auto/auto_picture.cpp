#include "scenes/auto/auto_picture.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "dof/measure/flip.h"
#include "scenes/auto/tile_sample.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/lens_views/accumulation.h"
#include "scenes/lens_views/lens_points.h"

namespace softfocus {
namespace {

// A prediction is trusted if this times it is within the limit. On named scenes and random:0 to 63,
// by a fit made without them, 40 such choices had at most 0.69 times the error asked
// (tools/calibrate-auto validate).
constexpr double kDoubt = 1.75;
// The fit has pictures of 512 and 1024 rows. For 256 rows predictions are low, by up to twice.
constexpr int kFewestFittedRows = 512;
// Numbers of those views. A picture made of more is held against twice its own number.
constexpr int kFirstViews = 16, kMostViews = 512;
// The views that a picture is held against follow all that it can be made of. Blocks of a power
// of two are even wherever they begin (lens_points.h).
const int kFirstCheckedView = kSampleCounts.back();
// If nothing is predicted to do, the views of the lens that doubling begins with.
constexpr int kViewsToBeginWith = 64;
// Light above what a screen shows, out of focus: highlights, which may be too small for a sample of
// the picture's points to tell of.
constexpr float kHighlight = 1.0f;
// Filters that are tried before views of the lens are taken.
constexpr int kMostFilters = 4;
// The FLIP of the mean of all views is at most this times that of their two halves. Twelve scenes,
// against 2,048 views, have .31 to .61 for 64 to 256 views.
constexpr double kHalvesToWhole = 0.62;

bool is_accumulation(const AutoMethod& choice) { return choice.method == "accumulation"; }

class Work {
 public:
  Work(const AutoInput& input, ThreadPool& pool)
      : input_(input), views_(with_all_samples(input.views)), pool_(pool) {}

  AutoPicture run() {
    tell(AutoStage::choosing);
    traits_ = scene_traits(views_.pinhole, input_.settings.coc, pool_);
    AutoMethod choice = auto_method(traits_, input_.goal, input_.limits);
    for (;;) {
      AutoPicture result = draw(choice);
      if (!is_checked(choice)) return result;
      if (is_accumulation(choice)) return result;  // doubled until it was enough
      result.measured_error = check(result.picture, result.choice);
      if (result.choice.meets_goal || !step_up(result, choice)) return result;
    }
  }

 private:
  static LensViewInput with_all_samples(LensViewInput views) {
    views.sampling.samples = kFirstCheckedView + 2 * kSampleCounts.back();
    return views;
  }

  void tell(AutoStage stage) const {
    if (input_.on_stage) input_.on_stage(stage);
  }

  bool is_checked(const AutoMethod& choice) const {
    if (input_.goal.max_time_ms || is_sharp(choice, traits_)) return false;
    if (input_.verify == Verify::never) return false;
    return input_.verify == Verify::always || rejected_ > 0 || is_in_doubt(choice, input_.goal);
  }

  // No circle reaches half a pixel: the pinhole is the truth.
  static bool is_sharp(const AutoMethod& choice, const SceneTraits& traits) {
    return softfocus::is_sharp(choice) && largest_px(traits) < 0.5f;
  }

  AutoPicture draw(const AutoMethod& choice) {
    if (is_accumulation(choice)) return draw_views(choice);
    tell(AutoStage::filtering);
    AutoPicture result;
    result.choice = choice;
    result.max_coc_px = choice.radius_px;
    result.picture = picture_of(choice, views_, input_.settings, pool_);
    result.rejected = rejected_;
    return result;
  }

  AccumulationBuffer& buffer() {
    if (!buffer_) buffer_ = make_accumulation_buffer(views_, pool_);
    return *buffer_;
  }

  Image mean_of(const SampleSums& sums) {
    return mean_picture(sums, views_.pinhole, views_.profile, pool_);
  }

  /// Views from `first` on; of the picture only the tiles, if there are any.
  void add_views(SampleSums& sums, int until, int first = 0, std::span<const int> tiles = {}) {
    while (sums.count < until) {
      // As take_samples() has it, for the same bits.
      const int step = sums.count < kLensViewGroup ? kSampleGroup : kLensViewGroup;
      const int end = std::min(sums.count + step, until);
      add_lens_views(buffer(), views_, first + sums.count, first + end, sums, pool_, tiles);
      if (views_.progress && tiles.empty()) views_.progress(sums.count);
    }
  }

  /// The sums of accumulation() with so many samples. `sums` are those of half as many, or none:
  /// a set made for its number has nothing in common with another.
  void take_views(SampleSums& sums, int samples) {
    if (sums.count <= kMostFewLensPoints) clear_sums(sums);
    std::vector<glm::dvec2> sequence =
        std::exchange(buffer().points, lens_points_for(views_.sampling.aperture, samples));
    add_views(sums, samples);
    buffer().points = std::move(sequence);
  }

  AutoMethod with_twice_the_samples(const AutoMethod& choice) const {
    const std::vector<AutoMethod> choices = open_choices(traits_, input_.limits);
    const auto twice = std::find_if(choices.begin(), choices.end(), [&](const AutoMethod& other) {
      return is_accumulation(other) && other.samples == 2 * choice.samples;
    });
    assert(twice != choices.end());  // kSampleCounts doubles
    AutoMethod found = *twice;
    found.reason = choice.reason;
    return found;
  }

  AutoPicture draw_views(AutoMethod choice) {
    tell(AutoStage::sampling);
    SampleSums sums = make_sample_sums(views_.pinhole.width, views_.pinhole.height);
    AutoPicture result;
    for (;;) {
      take_views(sums, choice.samples);
      if (!is_checked(choice)) break;
      result.measured_error = check(mean_of(sums), choice);
      if (choice.meets_goal || choice.samples >= kSampleCounts.back()) break;
      choice = with_twice_the_samples(choice);
      choice.reason += ", so its samples were doubled";
      ++rejected_;
      tell(AutoStage::sampling);
    }
    result.picture = mean_of(sums);
    result.choice = std::move(choice);
    result.rejected = rejected_;
    return result;
  }

  // Begins the truth of the sampled tiles.
  void take_tiles() {
    // A lens's picture, about: by the most accurate of the filters that cut no circle.
    const AutoMethod discs{.method = "disc-layers",
                           .radius_px = std::min(largest_px(traits_), kLargestMaxCoc),
                           .traits = {}};
    const Image guess = picture_of(discs, views_, input_.settings, pool_);
    sample_ = sample_tiles(views_.pinhole, guess, kCheckedTiles, pool_);
    for (const SampledTile& of : sample_.tiles) tiles_.push_back(of.tile);
    checked_ = make_sample_sums(views_.pinhole.width, views_.pinhole.height);
    add_views(checked_, kFirstViews / 2, kFirstCheckedView, tiles_);
    double_views();
  }

  void double_views() {
    const SampleSums half = checked_;
    add_views(checked_, 2 * half.count, kFirstCheckedView, tiles_);
    const Estimate noise =
        flip_of_tiles(sample_, mean_of(half), mean_of(later_samples(half, checked_)), pool_);
    noise_ = kHalvesToWhole * noise.mean;
    truth_ = mean_of(checked_);
  }

  // The noise of the views adds to what is measured. So what is measured within the limit is
  // within it, and what is beyond it by less than the noise wants more views.
  double check(const Image& picture, AutoMethod& choice) {
    tell(AutoStage::checking);
    if (sample_.tiles.empty()) take_tiles();
    // As many views have their ghosts in about the same places.
    const int enough = std::max(std::min(4 * choice.samples, kMostViews), 2 * choice.samples);
    while (checked_.count < enough) double_views();
    const double limit = input_.goal.max_error;
    Estimate error = flip_of_tiles(sample_, truth_, picture, pool_);
    while (error.mean + error.standard_error > limit && error.mean - noise_ <= limit &&
           checked_.count < kMostViews) {
      double_views();
      error = flip_of_tiles(sample_, truth_, picture, pool_);
    }
    const double measured = error.mean + error.standard_error;
    choice.meets_goal = measured <= limit;
    choice.reason += "; " + std::to_string(sample_.tiles.size()) + " tiles held against " +
                     std::to_string(checked_.count) + " views of the lens show an error of " +
                     number_text(measured);
    return measured;
  }

  // The next dearer choice that should do, if there is one.
  bool step_up(const AutoPicture& result, AutoMethod& choice) {
    ++rejected_;
    const double excess =
        std::clamp(*result.measured_error / result.choice.predicted_error, 1.0, 4.0);
    const AutoMethod* next = nullptr;
    const std::vector<AutoMethod> choices = open_choices(traits_, input_.limits);
    for (const AutoMethod& other : choices) {
      if (other.predicted_ms <= choice.predicted_ms) continue;
      if (!is_accumulation(other) &&
          (rejected_ >= kMostFilters || other.predicted_error >= choice.predicted_error)) {
        continue;
      }
      const double expected = other.predicted_error * (is_accumulation(other) ? 1.0 : excess);
      if (expected > input_.goal.max_error) continue;
      if (next == nullptr || other.predicted_ms < next->predicted_ms) next = &other;
    }
    // No prediction is within the limit: views of the lens get there by doubling.
    for (std::size_t i = choices.size(); next == nullptr && i-- > 0;) {
      if (is_accumulation(choices[i]) && choices[i].samples <= kViewsToBeginWith) {
        next = &choices[i];
      }
    }
    if (next == nullptr) return false;
    const std::string why = result.choice.reason + ", so " + setting_text(*next) + " was taken";
    choice = *next;
    choice.reason = why;
    return true;
  }

  const AutoInput& input_;
  LensViewInput views_;
  ThreadPool& pool_;
  SceneTraits traits_;
  std::optional<AccumulationBuffer> buffer_;
  TileSample sample_;
  std::vector<int> tiles_;
  SampleSums checked_;  // of the sampled tiles alone
  Image truth_;         // their mean
  double noise_ = 0.0;  // how far off that is, as a mean FLIP
  int rejected_ = 0;
};

}  // namespace

bool is_in_doubt(const AutoMethod& choice, const AutoGoal& goal) {
  return !choice.meets_goal || choice.traits.height < kFewestFittedRows ||
         choice.traits.brightest > kHighlight || choice.predicted_error * kDoubt > goal.max_error;
}

Image picture_of(const AutoMethod& choice, const LensViewInput& views, DofSettings settings,
                 ThreadPool& pool) {
  assert(!is_accumulation(choice));
  if (const LensViewMethod* of_scene = find_lens_view_method(choice.method)) {
    LensViewInput of_choice = views;
    of_choice.sampling.samples = std::max(choice.samples, 1);
    of_choice.prepared = nullptr;  // which the first to draw takes, and others may follow
    of_choice.memory = nullptr;
    return of_scene->render(of_choice, pool).picture;
  }
  const Method& filter = *find_method(choice.method);
  settings.max_coc_px = choice.radius_px;
  return filtered_frame(filter, views.scene, views.camera, views.frame, views.pinhole, settings,
                        views.profile, pool, views.stand_ins);
}

AutoPicture auto_picture(const AutoInput& input, ThreadPool& pool) {
  return Work{input, pool}.run();
}

}  // namespace softfocus
