#include "scenes/temporal/frame_history.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <utility>
#include <variant>

#include "raster/images/texel.h"
#include "raster/threads/float_environment.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/velocity.h"
#include "scenes/lens_views/accumulation.h"

namespace softfocus {
namespace {

double number_of(const ChosenEffect& chosen, std::string_view name) {
  std::size_t i = 0;
  while (i < chosen.parameters.size() && chosen.effect->parameters[i].name != name) ++i;
  assert(i < chosen.parameters.size());
  return chosen.parameters[i];
}

/// 0.1101 in base 2 of 1011, and likewise in base 3.
double digits_mirrored(int number, int base) {
  double mirrored = 0.0, place = 1.0;
  for (; number > 0; number /= base) {
    place /= base;
    mirrored += place * (number % base);
  }
  return mirrored;
}

/// The middle of its column for each of n numbers, in multiples of 2^-32.
std::vector<double> spread_over_columns(const std::vector<double>& numbers) {
  const std::size_t n = numbers.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return numbers[a] < numbers[b]; });
  std::vector<double> middles(n);
  for (std::size_t column = 0; column < n; ++column) {
    const auto twice = 2 * static_cast<std::int64_t>(column) + 1 - static_cast<std::int64_t>(n);
    // Cut towards 0: as much to the left as to the right.
    const std::int64_t steps = twice * (std::int64_t{1} << 31) / static_cast<std::int64_t>(n);
    middles[order[column]] = static_cast<double>(steps) * 0x1p-32;
  }
  return middles;
}

bool stands_still(const Scene& scene, double from, double to) {
  if (from == to) return true;
  if (moves(scene.camera)) return false;
  return std::all_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    return object_matrix(object, from) == object_matrix(object, to);
  });
}

/// The frame that is made, and what all of its kinds share.
struct NextFrame {
  PreparedScene& prepared;
  double frame;
  FrameHistory& history;
  ThreadPool& pool;

  const Scene& scene() const { return *prepared.scene; }
  const Profile& profile() const { return prepared.pass.profile; }

  Instant instant_at(double at, glm::dvec2 offset_px) const {
    const int width = history.drawn.width, height = history.drawn.height;
    const CameraMatrices centre = camera_matrices(scene().camera, at, width, height);
    return {lens_camera(centre, {0.0, 0.0}, 1.0, offset_px, width, height), at};
  }

  void draw(glm::dvec2 offset_px) const {
    draw_scene(prepared, instant_at(frame, offset_px).camera, frame, history.drawn, pool);
  }

  /// How far what is seen at `shown` moves from `before` to this frame. Both look from the same
  /// place in the pixel, which so is no motion.
  void find_velocity(double shown, double before, glm::dvec2 offset_px) const {
    if (stands_still(scene(), before, frame)) {
      clear_image(history.velocity, glm::vec4{0.0f}, profile());
      return;
    }
    const Instant from = instant_at(before, offset_px), to = instant_at(frame, offset_px);
    draw_velocity(prepared, shown == frame ? to : from, {from, to}, history.velocity, pool);
  }
};

void draw(const NextFrame& next, const TemporalAa& settings) {
  const FrameHistory& history = next.history;
  const std::vector<glm::dvec2> places = places_in_pixel(settings.places);
  const glm::dvec2 offset_px = places[static_cast<std::size_t>(history.count) % places.size()];
  next.draw(offset_px);
  if (history.count > 0) next.find_velocity(next.frame, history.frame, offset_px);
}

void draw(const NextFrame& next, const Refresh&) {
  next.draw({0.0, 0.0});
  const FrameHistory& history = next.history;
  if (history.count > 0) next.find_velocity(next.frame, history.frame, {0.0, 0.0});
}

void draw(const NextFrame& next, const Reproject& settings) {
  FrameHistory& history = next.history;
  const bool is_drawn = is_drawn_whole(settings, history);
  // A surface's earlier place is only known of drawn pixels; a scattered picture does without.
  if (is_drawn || !settings.forward || settings.holes == UnseenPixels::drawn) next.draw({0.0, 0.0});
  if (is_drawn) return;
  clear_image(history.frames, glm::vec4{1.0f}, next.profile());
  next.find_velocity(settings.forward ? history.key_frame : next.frame, history.key_frame,
                     {0.0, 0.0});
}

void take_drawn(const NextFrame& next, const FrameEffect& effect) {
  FrameHistory& history = next.history;
  std::swap(history.picture, history.drawn);
  clear_image(history.frames, glm::vec4{1.0f}, next.profile());
  history.shaded_share = 1.0;
  if (std::holds_alternative<Reproject>(effect)) {
    history.key = history.picture;
    history.key_frame = next.frame;
  }
}

void take_made(const NextFrame& next, const FrameEffect& effect) {
  FrameHistory& history = next.history;
  const std::int64_t shaded =
      make_frame(effect, sources_of(effect, history), {history.next, history.frames, history.found},
                 next.profile(), next.pool);
  std::swap(history.picture, history.next);
  history.shaded_share = static_cast<double>(shaded) /
                         (static_cast<double>(history.drawn.width) * history.drawn.height);
}

void make_room(int width, int height, FrameHistory& history) {
  if (history.drawn.width == width && history.drawn.height == height) return;
  history = {};
  for (Image* image : {&history.picture, &history.drawn, &history.found, &history.next}) {
    *image = make_image(Format::rgba16f, width, height);
  }
  history.velocity = make_image(Format::rg16f, width, height);
  history.frames = make_image(Format::r32f, width, height);
}

}  // namespace

FrameEffect frame_effect(const ChosenEffect& chosen) {
  const auto number = [&](std::string_view name) { return number_of(chosen, name); };
  const auto whole = [&](std::string_view name) { return static_cast<int>(number(name)); };
  const auto depth_tolerance = static_cast<float>(number("depth"));
  if (chosen.effect->name == "temporal-aa") {
    return TemporalAa{{static_cast<float>(number("new")), static_cast<HistoryBox>(whole("box")),
                       static_cast<float>(number("deviations"))},
                      whole("places"),
                      {depth_tolerance, true, number("cubic") >= 0.5}};
  }
  if (chosen.effect->name == "refresh") return Refresh{whole("groups"), depth_tolerance};
  assert(chosen.effect->name == "reproject");
  return Reproject{whole("every"), number("forward") >= 0.5,
                   static_cast<UnseenPixels>(whole("holes")), depth_tolerance};
}

int warm_up_frames(const ChosenEffect& chosen) {
  return static_cast<int>(number_of(chosen, "warm-up"));
}

void draw_up_to(PreparedScene& prepared, const ChosenEffect& effect, double frame, int width,
                int height, FrameSequence& sequence, ThreadPool& pool) {
  const int warm_up = warm_up_frames(effect);
  const int wanted =
      warm_up + static_cast<int>(std::lround((frame - sequence.first) / sequence.step));
  FrameHistory& history = sequence.history;
  if (history.count > wanted) history.count = 0;
  const FrameEffect made = frame_effect(effect);
  while (history.count <= wanted) {
    draw_next(prepared, made, sequence.first + (history.count - warm_up) * sequence.step, width,
              height, history, pool);
  }
}

bool is_drawn_whole(const FrameEffect& effect, const FrameHistory& history) {
  const auto* reproject = std::get_if<Reproject>(&effect);
  return history.count == 0 || (reproject != nullptr && history.count % reproject->every == 0);
}

void draw_sources(PreparedScene& prepared, const FrameEffect& effect, double frame, int width,
                  int height, FrameHistory& history, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  make_room(width, height, history);
  const NextFrame next{prepared, frame, history, pool};
  std::visit([&](const auto& settings) { draw(next, settings); }, effect);
}

FrameSources sources_of(const FrameEffect& effect, const FrameHistory& history) {
  const auto* of_groups = std::get_if<Refresh>(&effect);
  return {history.drawn, history.velocity,
          std::holds_alternative<Reproject>(effect) ? history.key : history.picture, history.frames,
          of_groups == nullptr ? 0 : history.count % of_groups->groups};
}

void draw_next(PreparedScene& prepared, const FrameEffect& effect, double frame, int width,
               int height, FrameHistory& history, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  draw_sources(prepared, effect, frame, width, height, history, pool);
  const NextFrame next{prepared, frame, history, pool};
  if (is_drawn_whole(effect, history)) {
    take_drawn(next, effect);
  } else {
    take_made(next, effect);
  }
  history.frame = frame;
  ++history.count;
}

std::vector<glm::dvec2> places_in_pixel(int count) {
  std::vector<double> x, y;
  // From 1 on: the first place is near the centre.
  for (int i = 1; i <= count; ++i) {
    x.push_back(digits_mirrored(i, 2));
    y.push_back(digits_mirrored(i, 3));
  }
  x = spread_over_columns(x);
  y = spread_over_columns(y);
  std::vector<glm::dvec2> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.emplace_back(x[i], y[i]);
  return places;
}

Image temporal_picture(PreparedScene& prepared, const TemporalAa& settings, double frame,
                       int frames, int width, int height, ThreadPool& pool) {
  FrameHistory history;
  for (int i = 0; i < frames; ++i) {
    draw_next(prepared, settings, frame, width, height, history, pool);
  }
  return std::move(history.picture);
}

}  // namespace softfocus
