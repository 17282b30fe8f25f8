#include "scenes/models/gltf_animations.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "scenes/files/scene_error.h"

namespace softfocus {
namespace {

constexpr double kFramesPerSecond = 60.0;  // as of shaders' `seconds`

using Track = std::shared_ptr<const NodeTrack>;

Track standing_at(glm::dvec4 value) {
  return std::make_shared<NodeTrack>(NodeTrack{KeyForm::step, {0.0}, {value}});
}

// Times are binary32: a sixtieth of a second, and its multiples, are whole frames.
double frame_of(double seconds) {
  const double frame = seconds * kFramesPerSecond, whole = std::round(frame);
  return std::fabs(frame - whole) <= 0x1p-23 * whole && whole < 0x1p20 ? whole : frame;
}

// A vector of the file's, or what it is without.
template <int kLength>
glm::dvec4 vector_of(const std::vector<double>& numbers, glm::dvec4 without) {
  if (numbers.size() != kLength) return without;
  glm::dvec4 made{0.0};
  for (int i = 0; i < kLength; ++i) made[i] = numbers[static_cast<std::size_t>(i)];
  return made;
}

struct Sampled {
  const GltfFile& file;
  std::string name;  // of the sampler

  [[noreturn]] void fail(const std::string& reason) const {
    fail_gltf(file, name + " of an animation " + reason);
  }
};

std::vector<double> read_times(const Sampled& sampled, const GltfNumbers& times) {
  if (times.width != 1) sampled.fail("has times of more than one number");
  std::vector<double> frames;
  for (const double seconds : times.values) {
    const double frame = frame_of(seconds);
    if (!(frame >= 0.0 && frame <= 1e9)) sampled.fail("has a time that is negative, or none");
    if (!frames.empty() && !(frame > frames.back())) {
      sampled.fail("has times that do not increase");
    }
    frames.push_back(frame);
  }
  return frames;
}

NodeTrack read_track(GltfFile& file, const tinygltf::Animation& animation, int number,
                     bool is_turn) {
  const tinygltf::AnimationSampler& from =
      item_of(file, animation.samplers, number, "sampler of an animation");
  const Sampled sampled{file, numbered("sampler", static_cast<std::size_t>(number))};
  NodeTrack track;
  if (from.interpolation == "LINEAR") {
    track.form = KeyForm::linear;
  } else if (from.interpolation == "CUBICSPLINE") {
    track.form = KeyForm::cubic;
  } else if (from.interpolation != "STEP") {
    sampled.fail("goes from key to key by " + shortened(from.interpolation) +
                 "; LINEAR, STEP or CUBICSPLINE would be right");
  }
  track.frames = read_times(sampled, read_accessor(file, from.input));
  const GltfNumbers numbers = read_accessor(file, from.output);
  const std::size_t width = is_turn ? 4 : 3;
  const std::size_t of_key = track.form == KeyForm::cubic ? 3 : 1;
  constexpr std::size_t kMostKeys = std::size_t{1} << 24;
  if (file.animation_keys += numbers.count(); file.animation_keys > kMostKeys) {
    sampled.fail("is one too many: all have more than " + std::to_string(kMostKeys) + " values");
  }
  if (numbers.width != width || numbers.count() != of_key * track.frames.size()) {
    sampled.fail("has " + std::to_string(numbers.count()) + " values of " +
                 std::to_string(numbers.width) + " numbers where " +
                 std::to_string(of_key * track.frames.size()) + " of " + std::to_string(width) +
                 " would be right");
  }
  for (std::size_t i = 0; i < numbers.count(); ++i) {
    glm::dvec4 value{0.0};
    for (std::size_t k = 0; k < width; ++k) {
      const double component = numbers[i][k];
      if (!(std::fabs(component) <= kLargestCoordinate)) {
        sampled.fail("has a value that is no number, or beyond 1e9");
      }
      value[static_cast<int>(k)] = component;
    }
    const bool is_speed = of_key == 3 && i % 3 != 1;
    if (is_speed) value = value / kFramesPerSecond;
    track.values.push_back(is_turn && !is_speed ? unit_quaternion(value) : value);
  }
  return track;
}

// One key in place of many that are the same.
Track folded(NodeTrack track) {
  const std::size_t of_key = track.form == KeyForm::cubic ? 3 : 1;
  const glm::dvec4 first = track.values[of_key / 2];
  for (std::size_t i = 0; i < track.values.size(); ++i) {
    const bool is_speed = of_key == 3 && i % 3 != 1;
    if (track.values[i] != (is_speed ? glm::dvec4{0.0} : first)) {
      return std::make_shared<NodeTrack>(std::move(track));
    }
  }
  return standing_at(first);
}

Track* track_named(NodeMotion& motion, const std::string& path) {
  if (path == "translation") return &motion.translation;
  if (path == "rotation") return &motion.rotation;
  return path == "scale" ? &motion.scale : nullptr;
}

}  // namespace

NodeMotion standing(const tinygltf::Node& node) {
  return {nullptr, glm::dmat4{1.0}, standing_at(vector_of<3>(node.translation, glm::dvec4{0.0})),
          standing_at(unit_quaternion(vector_of<4>(node.rotation, {0.0, 0.0, 0.0, 1.0}))),
          standing_at(vector_of<3>(node.scale, {1.0, 1.0, 1.0, 0.0}))};
}

namespace {

// The tracks of one animation, of samplers that may have several channels each.
class Tracks {
 public:
  Tracks(GltfFile& file, const tinygltf::Animation& animation)
      : file_(file), animation_(animation) {}

  // Null, with a warning, if it cannot be.
  Track read(int sampler, bool is_turn) {
    const auto [entry, is_new] = read_.try_emplace({sampler, is_turn});
    if (!is_new) return entry->second;
    try {
      entry->second = folded(read_track(file_, animation_, sampler, is_turn));
    } catch (const SceneError& error) {
      const std::string said = error.what(), before = printable(file_.path.string()) + ": ";
      warn_gltf(file_, "an animation is left out: " +
                           said.substr(said.starts_with(before) ? before.size() : 0));
    }
    return entry->second;
  }

 private:
  GltfFile& file_;
  const tinygltf::Animation& animation_;
  std::map<std::pair<int, bool>, Track> read_{};
};

}  // namespace

std::map<int, NodeMotion> read_animations(GltfFile& file) {
  std::map<int, NodeMotion> of_node;
  for (const tinygltf::Animation& animation : file.gltf.animations) {
    std::map<int, NodeMotion> by_this;
    Tracks tracks(file, animation);
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
      const int number = channel.target_node;
      if (number < 0) {
        if (channel.target_path == "pointer") {
          warn_gltf(file, "an animation of what is no node is left out");
        }
        continue;
      }
      const tinygltf::Node& node = item_of(file, file.gltf.nodes, number, "node of an animation");
      if (of_node.contains(number)) {
        warn_gltf(file, "of several animations of a node the first is there");
        continue;
      }
      NodeMotion none;
      if (track_named(none, channel.target_path) == nullptr) {
        warn_gltf(file, "an animation of " + shortened(channel.target_path) + " is left out");
        continue;
      }
      const Track track = tracks.read(channel.sampler, channel.target_path == "rotation");
      if (track == nullptr) continue;
      const auto [entry, is_new] = by_this.try_emplace(number);
      if (is_new) entry->second = standing(node);
      *track_named(entry->second, channel.target_path) = track;
    }
    of_node.merge(by_this);
  }
  return of_node;
}

bool moves(const NodeMotion& motion) {
  return motion.translation->frames.size() > 1 || motion.rotation->frames.size() > 1 ||
         motion.scale->frames.size() > 1;
}

}  // namespace softfocus
