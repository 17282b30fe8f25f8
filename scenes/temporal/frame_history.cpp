#include "scenes/temporal/frame_history.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <utility>

#include "raster/images/texel.h"
#include "raster/passes/fullscreen_pass.h"
#include "raster/temporal/forward_reproject.h"
#include "raster/temporal/refresh.h"
#include "raster/threads/float_environment.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/velocity.h"
#include "scenes/lens_views/lens_camera.h"

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
  const Camera& camera = scene.camera;
  if (from == to) return true;
  if (camera.orbit_degrees_per_frame != 0.0) return false;
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

  void look_back(const ReprojectSettings& settings, const Image& picture, double before,
                 glm::dvec2 offset_px) const {
    find_velocity(frame, before, offset_px);
    reverse_reproject(settings, {history.drawn, history.velocity, picture, history.frames},
                      history.found, profile(), pool);
  }

  void take_drawn() const {
    std::swap(history.picture, history.drawn);
    clear_image(history.frames, glm::vec4{1.0f}, profile());
    history.shaded_share = 1.0;
  }

  /// Pixels of a group's turn, and those that were not found, are drawn; turn -1: no group's.
  void take_found(int groups, int turn) const {
    const std::int64_t shaded = refresh(groups, turn, history.drawn, history.found, history.next,
                                        history.frames, profile(), pool);
    std::swap(history.picture, history.next);
    history.shaded_share = static_cast<double>(shaded) /
                           (static_cast<double>(history.drawn.width) * history.drawn.height);
  }
};

void make(const NextFrame& next, const TemporalAa& settings) {
  FrameHistory& history = next.history;
  const std::vector<glm::dvec2> places = places_in_pixel(settings.places);
  const glm::dvec2 offset_px = places[static_cast<std::size_t>(history.count) % places.size()];
  next.draw(offset_px);
  if (history.count == 0) return next.take_drawn();
  next.look_back(settings.reproject, history.picture, history.frame, offset_px);
  accumulate(settings.average, history.drawn, history.found, history.next, history.frames,
             next.profile(), next.pool);
  std::swap(history.picture, history.next);
  history.shaded_share = 1.0;
}

void make(const NextFrame& next, const Refresh& settings) {
  next.draw({0.0, 0.0});
  const FrameHistory& history = next.history;
  if (history.count == 0) return next.take_drawn();
  next.look_back({settings.depth_tolerance, false, true}, history.picture, history.frame,
                 {0.0, 0.0});
  next.take_found(settings.groups, history.count % settings.groups);
}

void make(const NextFrame& next, const Reproject& settings) {
  FrameHistory& history = next.history;
  const bool is_drawn = history.count % settings.every == 0;
  // Where a surface was is only known of what is drawn; a scattered picture does without.
  if (is_drawn || !settings.forward || settings.holes == UnseenPixels::drawn) next.draw({0.0, 0.0});
  if (is_drawn) {
    next.take_drawn();
    history.key = history.picture;
    history.key_frame = next.frame;
    return;
  }
  if (settings.forward) {
    next.find_velocity(history.key_frame, history.key_frame, {0.0, 0.0});
    forward_reproject(history.key, history.velocity, history.found, next.profile(), next.pool);
  } else {
    clear_image(history.frames, glm::vec4{1.0f}, next.profile());
    next.look_back({settings.depth_tolerance, false, true}, history.key, history.key_frame,
                   {0.0, 0.0});
  }
  if (settings.holes == UnseenPixels::drawn) return next.take_found(1, -1);
  history.shaded_share = 0.0;
  if (!settings.forward) {
    // In alpha there is a count of frames; now it is a depth, or 0.
    fullscreen_pass<Format::rgba16f>(history.next, next.profile(), next.pool, [&](int x, int y) {
      glm::vec4 texel = load_texel<Format::rgba16f>(history.found, x, y);
      if (texel.w > 0.0f) texel.w = load_texel<Format::rgba16f>(history.drawn, x, y).w;
      return texel;
    });
    std::swap(history.found, history.next);
  }
  if (settings.holes == UnseenPixels::filled) {
    fill_holes(history.found, history.next, next.profile(), next.pool);
  } else {
    std::swap(history.found, history.next);
  }
  std::swap(history.picture, history.next);
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

void draw_next(PreparedScene& prepared, const FrameEffect& effect, double frame, int width,
               int height, FrameHistory& history, ThreadPool& pool) {
  const DefaultFloatEnvironment environment;
  make_room(width, height, history);
  const NextFrame next{prepared, frame, history, pool};
  std::visit([&](const auto& settings) { make(next, settings); }, effect);
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
