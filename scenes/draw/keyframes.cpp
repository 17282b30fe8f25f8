#include "scenes/draw/keyframes.h"

#include <algorithm>

namespace softfocus {
namespace {

double slope(const Keyframe& a, const Keyframe& b) {
  return (b.value - a.value) / (b.frame - a.frame);
}

/// The speed at a key, in values a frame.
double speed_at(std::span<const Keyframe> keys, std::size_t key) {
  if (key == 0 || key + 1 == keys.size()) return 0.0;
  const double before = slope(keys[key - 1], keys[key]);
  const double behind = slope(keys[key], keys[key + 1]);
  if (!(before * behind > 0.0)) return 0.0;
  const double frames_before = keys[key].frame - keys[key - 1].frame;
  const double frames_behind = keys[key + 1].frame - keys[key].frame;
  const double weight_before = 2.0 * frames_behind + frames_before;
  const double weight_behind = frames_behind + 2.0 * frames_before;
  return (weight_before + weight_behind) / (weight_before / before + weight_behind / behind);
}

}  // namespace

double value_at(std::span<const Keyframe> keys, Easing easing, double frame) {
  const auto next =
      std::upper_bound(keys.begin(), keys.end(), frame,
                       [](double sought, const Keyframe& key) { return sought < key.frame; });
  if (next == keys.begin()) return keys.front().value;
  if (next == keys.end()) return keys.back().value;
  const auto right = static_cast<std::size_t>(next - keys.begin());
  const Keyframe& a = keys[right - 1];
  const Keyframe& b = keys[right];
  const double frames = b.frame - a.frame;
  const double t = (frame - a.frame) / frames;
  double way = (b.value - a.value) * t;
  if (easing == Easing::smooth) {
    // Hermite's cubic, less the value at a.
    const double u = 1.0 - t;
    way = (b.value - a.value) * (t * t * (3.0 - 2.0 * t)) +
          frames * (speed_at(keys, right - 1) * (t * u * u) - speed_at(keys, right) * (t * t * u));
  }
  const auto [least, most] = std::minmax(a.value, b.value);
  return std::clamp(a.value + way, least, most);
}

ThinLens lens_at(const SceneLens& lens, double frame) {
  ThinLens at_frame = lens.lens;
  const auto set = [&](double& value, const std::vector<Keyframe>& keys) {
    if (!keys.empty()) value = value_at(keys, lens.easing, frame);
  };
  set(at_frame.focus_m, lens.focus_m_by_frame);
  set(at_frame.f_number, lens.f_number_by_frame);
  return at_frame;
}

}  // namespace softfocus
