// truth and compare_methods: the picture that the lens itself makes, view by view, and how far
// methods are from it.

#include <algorithm>
#include <bit>
#include <cmath>

#include "dof/measure/flip.h"
#include "dof/measure/heat_map.h"
#include "raster/numbers/exact_math.h"
#include "tools/cli/errors.h"
#include "tools/page/drawing.h"
#include "tools/page/picture.h"
#include "tools/page/requests.h"
#include "tools/page/screen.h"

namespace softfocus {
namespace {

constexpr int kMostTruthViews = 4096;
/// Half-sets of fewer views can agree by chance, as in accumulation.h.
constexpr int kFirstComparison = 16;
/// Half-sets that differ by less look the same: below half a level of 8 bits.
constexpr double kGoodEnough = 0.002;

const ShownFrame& last_frame(const Page& page) {
  if (page.opened && page.opened->picture) throw UsageError(kNoScene);
  if (!page.shown || !page.shown->lens) {
    throw UsageError("there is no frame with a lens yet; the request 'frame' makes one");
  }
  return *page.shown;
}

/// A case that has its answer written down needs no views.
const Image* known_truth(const Drawn& drawn) {
  const StressFrame* frame = drawn.trial_frame;
  return frame != nullptr && frame->truth.width > 0 ? &frame->truth : nullptr;
}

bool is_of(const Truth& truth, const ShownFrame& shown) {
  return truth.drawn == shown.drawn && truth.focus_m == shown.lens->lens.focus_m &&
         truth.aperture_m == shown.lens->aperture_radius_m &&
         truth.aperture == used_aperture(shown.settings);
}

/// A lens of blades that are turned, behind an anamorphic front: as aperture_stamps.cpp has it.
void turn_and_stretch(const Aperture& aperture, std::vector<glm::dvec2>& points) {
  if (aperture.turn_degrees == 0.0f && aperture.stretch == 1.0f) return;
  const double stretch = static_cast<double>(aperture.stretch);
  const glm::dvec2 scale{std::fmin(1.0, 1.0 / stretch), std::fmin(1.0, stretch)};
  const double degrees = static_cast<double>(aperture.turn_degrees);
  const glm::dvec2 turned{exact_math::cos_degrees(degrees), exact_math::sin_degrees(degrees)};
  for (glm::dvec2& p : points) {
    p = scale * glm::dvec2{turned.x * p.x - turned.y * p.y, turned.y * p.x + turned.x * p.y};
  }
}

/// The last frame's shot by as many views of the lens as there may be, its shutter open as the
/// scene's.
Shot shot_of_truth(Page& page, const ShownFrame& shown) {
  FrameSettings settings = shown.settings;
  settings.show = Show::image;
  settings.method = find_method_choice("accumulation");
  settings.sampling = {.samples = kMostTruthViews,
                       .aperture = {used_aperture(shown.settings).blades}};
  return shot_of_drawn(page, *shown.drawn, settings);
}

Truth begin_truth(const ShownFrame& shown, const Shot& shot, ThreadPool& pool) {
  const Drawn& drawn = *shown.drawn;
  Truth truth;
  truth.drawn = shown.drawn;
  truth.focus_m = shown.lens->lens.focus_m;
  truth.aperture_m = shown.lens->aperture_radius_m;
  truth.buffer = make_accumulation_buffer(lens_views_of(shot, drawn.frame, *shown.lens), pool);
  truth.aperture = used_aperture(shown.settings);
  turn_and_stretch(truth.aperture, truth.buffer->points);
  truth.sums = make_sample_sums(drawn.picture().width, drawn.picture().height);
  return truth;
}

/// In the steps of accumulation.h, so that the sums have the bits of `--method accumulation
/// --until`.
void add_views(const Page& page, const LensViewInput& input, Truth& truth, int views) {
  const int wanted = std::min(truth.sums.count + views, kMostTruthViews);
  while (truth.sums.count < wanted) {
    stop_if_cancelled(page);
    const int begin = truth.sums.count;
    const int step = begin < kFirstComparison ? kSampleGroup : kLensViewGroup;
    add_lens_views(*truth.buffer, input, begin, begin + step, truth.sums, *page.pool);
    if (!std::has_single_bit(static_cast<unsigned>(truth.sums.count))) continue;
    if (truth.sums.count >= kFirstComparison) {
      truth.half_set_rms = half_set_rms(truth.first_half, truth.sums, *page.pool);
    }
    truth.first_half = truth.sums;
  }
}

Image mean_of(const Truth& truth, const Shot& shot, ThreadPool& pool) {
  Frame frame{.picture = mean_picture(truth.sums, truth.drawn->picture(), Profile{}, pool)};
  finish_picture(shot, frame, pool);
  return std::move(frame.picture);
}

/// The truth of the last frame as far as it has come. Throws UsageError if there is none yet.
Image found_truth(Page& page, const ShownFrame& shown) {
  if (const Image* known = known_truth(*shown.drawn)) return *known;
  if (!page.truth || !is_of(*page.truth, shown) || page.truth->sums.count == 0) {
    throw UsageError("the truth of this frame has no views yet; give 'views'");
  }
  return mean_of(*page.truth, shot_of_truth(page, shown), *page.pool);
}

/// `numbers`: the map's in place of its colours.
void show_truth(Page& page, const std::string& what, bool numbers, const Image& truth,
                const Image& picture) {
  if (what == "truth") {
    show_on_screen(truth, page.pixels, *page.pool);
  } else if (what == "error") {
    const PixelMap map = flip_map(truth, picture, clamped_tone(), *page.pool);
    if (numbers) {
      put_numbers(
          map.width, map.height,
          [&](int x, int y) {
            return static_cast<float>(row(map, y)[static_cast<std::size_t>(x)]);
          },
          page.pixels);
    } else {
      show_on_screen(heat_picture(map), page.pixels, *page.pool);
    }
  } else {
    throw UsageError("show '" + what + "': there are truth, error");
  }
}

/// FLIP takes as long as a few views: a kept value does until there are a quarter more of them.
double flip_of_shown(ShownFrame& shown, const Image& truth, int samples, bool done,
                     ThreadPool& pool) {
  std::optional<KnownFlip>& known = shown.flip;
  const bool is_new = !known || known->samples > samples || (done && known->samples < samples) ||
                      4 * samples > 5 * known->samples;
  if (is_new) known = {samples, mean_flip(truth, shown.picture, pool)};
  return known->flip;
}

/// Whether the picture of a case holds, by the case's own measure; null where there is none of one
/// frame.
Json verdict_of(const Page& page, const ShownFrame& shown, const Image& truth) {
  const std::optional<StressTrial>& trial = shown.drawn->trial;
  if (!trial || trial->frames.size() != 1 || !page.opened->stress_case) return nullptr;
  const StressCase& of = *page.opened->stress_case;
  const double value = of.measure({*trial, page.opened->severity, std::span{&truth, 1},
                                   std::span{&shown.picture, 1}, *page.pool});
  return {{"value", number_or_null(value)}, {"limit", of.limit},   {"unit", of.unit},
          {"measured", of.measured},        {"why", of.why_limit}, {"holds", value <= of.limit}};
}

}  // namespace

Json answer_truth(Page& page, const Json& request) {
  const ShownFrame& shown = last_frame(page);
  const Drawn& drawn = *shown.drawn;
  const bool is_known = known_truth(drawn) != nullptr;
  if (const Json* views = request.find("views"); views != nullptr && !is_known) {
    const auto count = static_cast<int>(checked_number(*views, "views", 1, kMostTruthViews));
    if (drawn.scene == nullptr) throw UsageError("this case has no scene to look at");
    const Shot shot = shot_of_truth(page, shown);
    if (!page.truth || !is_of(*page.truth, shown)) {
      page.truth = begin_truth(shown, shot, *page.pool);
    }
    add_views(page, lens_views_of(shot, drawn.frame, *shown.lens), *page.truth, count);
  }
  const Image truth = found_truth(page, shown);
  const int samples = is_known ? 0 : page.truth->sums.count;
  const std::optional<double> rms = is_known ? 0.0 : page.truth->half_set_rms;
  const bool done = samples >= kMostTruthViews || (rms && *rms <= kGoodEnough);
  Json reply{{"samples", samples},
             {"half_set_rms", rms ? Json(*rms) : Json(nullptr)},
             {"flip_mean", flip_of_shown(*page.shown, truth, samples, done, *page.pool)},
             {"done", done}};
  if (done) reply["verdict"] = verdict_of(page, *page.shown, truth);
  if (const Json* hash = request.find("hash"); hash != nullptr && hash->boolean()) {
    reply["hash"] = hash_text(hash_image(truth));
  }
  if (const Json* show = request.find("show")) {
    const Json* numbers = given(request, "numbers");
    const bool wants_numbers = numbers != nullptr && numbers->boolean();
    show_truth(page, show->text(), wants_numbers, truth, shown.picture);
    reply["numbers"] = wants_numbers && show->text() == "error";
    reply["width"] = truth.width;
    reply["height"] = truth.height;
  }
  return reply;
}

Json answer_compare_methods(Page& page, const Json& request) {
  const ShownFrame& shown = last_frame(page);
  const Image truth = found_truth(page, shown);
  FrameSettings settings = shown.settings;
  settings.show = Show::image;
  settings.method = find_method_choice("pinhole");
  Shot shot = shot_of_drawn(page, *shown.drawn, settings);
  Json results = Json::array();
  for (const Json& name : request.at("methods").values()) {
    const Method* method = find_method(name.text());
    if (method == nullptr) {
      throw UsageError("method '" + name.text() + "': there are " + names_of(methods()));
    }
    for (const Json& radius : request.at("radii").values()) {
      stop_if_cancelled(page);
      UsedLens lens = *shown.lens;
      if (method->name == kApertureMethod) lens.settings.aperture = used_aperture(shown.settings);
      lens.settings.max_coc_px = static_cast<float>(
          checked_number(radius, "radii", 0.0, static_cast<double>(kLargestMaxCoc)));
      const auto start = std::chrono::steady_clock::now();
      shot.method = {.filter = method};
      FrameMemory memory{.is_last = true};
      const Image picture = made_picture(page, *shown.drawn, shot, lens, memory);
      const double ms = milliseconds_since(start);
      results.push_back({{"method", method->name},
                         {"radius", lens.settings.max_coc_px},
                         {"ms", ms},
                         {"flip_mean", mean_flip(truth, picture, *page.pool)}});
    }
  }
  return {{"results", results}};
}

}  // namespace softfocus
