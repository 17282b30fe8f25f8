#include "scenes/models/gltf_animations.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softfocus {
namespace {

constexpr double kFramesPerSecond = 60.0;  // as of shaders' `seconds`

NodeTrack standing_at(glm::dvec4 value) { return {KeyForm::step, {0.0}, {value}}; }

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
    const double frame = seconds * kFramesPerSecond;
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
void fold(NodeTrack& track) {
  const std::size_t of_key = track.form == KeyForm::cubic ? 3 : 1;
  const glm::dvec4 first = track.values[of_key / 2];
  for (std::size_t i = 0; i < track.values.size(); ++i) {
    const bool is_speed = of_key == 3 && i % 3 != 1;
    if (track.values[i] != (is_speed ? glm::dvec4{0.0} : first)) return;
  }
  track = standing_at(first);
}

NodeTrack* track_named(NodeMotion& motion, const std::string& path) {
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

std::map<int, NodeMotion> read_animations(GltfFile& file) {
  std::map<int, NodeMotion> of_node;
  for (const tinygltf::Animation& animation : file.gltf.animations) {
    std::map<int, NodeMotion> by_this;
    for (const tinygltf::AnimationChannel& channel : animation.channels) {
      if (channel.target_node < 0) {
        if (channel.target_path == "pointer") {
          warn_gltf(file, "an animation of what is no node is left out");
        }
        continue;
      }
      const tinygltf::Node& node =
          item_of(file, file.gltf.nodes, channel.target_node, "node of an animation");
      if (of_node.contains(channel.target_node)) {
        warn_gltf(file, "of several animations of a node the first is there");
        continue;
      }
      NodeMotion found = standing(node);
      NodeTrack* const named = track_named(found, channel.target_path);
      if (named == nullptr) {
        warn_gltf(file, "an animation of " + shortened(channel.target_path) + " is left out");
        continue;
      }
      *named = read_track(file, animation, channel.sampler, channel.target_path == "rotation");
      fold(*named);
      const auto [entry, is_new] = by_this.try_emplace(channel.target_node, found);
      if (!is_new) *track_named(entry->second, channel.target_path) = std::move(*named);
    }
    of_node.merge(by_this);
  }
  return of_node;
}

bool moves(const NodeMotion& motion) {
  return motion.translation.frames.size() > 1 || motion.rotation.frames.size() > 1 ||
         motion.scale.frames.size() > 1;
}

}  // namespace softfocus
