#include "raster/pipeline/merge.h"

#include <algorithm>
#include <cstddef>

#include "raster/images/texel.h"

namespace softfocus {
namespace {

glm::vec4 factor(BlendFactor kind, glm::vec4 source, glm::vec4 destination) {
  switch (kind) {
    case BlendFactor::zero: return glm::vec4{0.0f};
    case BlendFactor::one: return glm::vec4{1.0f};
    case BlendFactor::source_colour: return source;
    case BlendFactor::one_minus_source_colour: return 1.0f - source;
    case BlendFactor::destination_colour: return destination;
    case BlendFactor::one_minus_destination_colour: return 1.0f - destination;
    case BlendFactor::source_alpha: return glm::vec4{source.w};
    case BlendFactor::one_minus_source_alpha: return glm::vec4{1.0f - source.w};
    case BlendFactor::destination_alpha: return glm::vec4{destination.w};
    case BlendFactor::one_minus_destination_alpha: return glm::vec4{1.0f - destination.w};
  }
  return glm::vec4{0.0f};
}

float combine(BlendOp op, float source, float source_factor, float destination,
              float destination_factor) {
  switch (op) {
    case BlendOp::add: return source * source_factor + destination * destination_factor;
    case BlendOp::subtract: return source * source_factor - destination * destination_factor;
    case BlendOp::reverse_subtract:
      return destination * destination_factor - source * source_factor;
    case BlendOp::minimum: return destination < source ? destination : source;
    case BlendOp::maximum: return source < destination ? destination : source;
  }
  return source;
}

bool is_normalised(Format format) {
  return format == Format::r8 || format == Format::rgba8 || format == Format::srgb8;
}

// NaN becomes 0.
glm::vec4 clamp_to_unit(glm::vec4 v) {
  for (int i = 0; i < 4; ++i) v[i] = v[i] > 0.0f ? std::min(v[i], 1.0f) : 0.0f;
  return v;
}

float& depth_at(const LayerTarget& layer, int x, int y) {
  return row<float>(*layer.depth, y)[static_cast<std::size_t>(x)];
}

// The four halves of a texel.
std::uint16_t* texel_at(const LayerTarget& layer, int x, int y) {
  return row<std::uint16_t>(*layer.colour, y).data() + 4 * x;
}

}  // namespace

std::size_t layer_count(const RenderTargets& targets) {
  std::size_t count = 1;
  while (count < kMaxLayers && targets.behind[count - 1].colour != nullptr) ++count;
  return count;
}

bool can_peel(const RenderTargets& targets, const DrawState& state) {
  for (std::size_t i = 0; i < layer_count(targets); ++i) {
    const LayerTarget layer = layer_target(targets, i);
    if (layer.colour == nullptr || layer.colour->format != Format::rgba16f) return false;
    if (layer.depth == nullptr) return false;
  }
  const bool one_colour = std::all_of(targets.colour.begin() + 1, targets.colour.end(),
                                      [](const Image* image) { return image == nullptr; });
  const ColourState& colour = state.colour[0];
  return one_colour && targets.stencil == nullptr && state.depth &&
         state.depth->test == Compare::less && state.depth->write && !colour.blend &&
         colour.write == std::array{true, true, true, true};
}

bool reaches_layers(const RenderTargets& targets, int x, int y, float depth) {
  return depth < depth_at(layer_target(targets, layer_count(targets) - 1), x, y);
}

void insert_into_layers(const RenderTargets& targets, int x, int y, float depth, glm::vec4 colour,
                        const Profile& profile) {
  std::size_t place = layer_count(targets) - 1;
  LayerTarget layer = layer_target(targets, place);
  for (; place > 0; --place) {
    const LayerTarget before = layer_target(targets, place - 1);
    if (!(depth < depth_at(before, x, y))) break;
    depth_at(layer, x, y) = depth_at(before, x, y);
    std::copy_n(texel_at(before, x, y), 4, texel_at(layer, x, y));
    layer = before;
  }
  depth_at(layer, x, y) = depth;
  store_texel(*layer.colour, x, y, colour, profile);
}

std::uint8_t apply(StencilOp op, const StencilFace& face, std::uint8_t stored) {
  switch (op) {
    case StencilOp::keep: return stored;
    case StencilOp::zero: return 0;
    case StencilOp::replace: return face.reference;
    case StencilOp::increment_clamp:
      return stored == 255 ? stored : static_cast<std::uint8_t>(stored + 1);
    case StencilOp::decrement_clamp:
      return stored == 0 ? stored : static_cast<std::uint8_t>(stored - 1);
    case StencilOp::invert: return static_cast<std::uint8_t>(~stored);
    case StencilOp::increment_wrap: return static_cast<std::uint8_t>(stored + 1);
    case StencilOp::decrement_wrap: return static_cast<std::uint8_t>(stored - 1);
  }
  return stored;
}

bool depth_stencil_test(const DrawState& state, const RenderTargets& targets, int x, int y,
                        float depth, bool front_facing) {
  const bool test_depth = state.depth && targets.depth != nullptr;
  float* stored_depth =
      test_depth ? &row<float>(*targets.depth, y)[static_cast<std::size_t>(x)] : nullptr;
  const auto depth_passes = [&] {
    return !test_depth || compare(state.depth->test, depth, *stored_depth);
  };

  bool passes = true;
  if (state.stencil && targets.stencil != nullptr) {
    const StencilFace& face = front_facing ? state.stencil->front : state.stencil->back;
    std::uint8_t& stored = row<std::uint8_t>(*targets.stencil, y)[static_cast<std::size_t>(x)];
    const bool stencil_passes =
        compare(face.test, static_cast<std::uint8_t>(face.reference & face.read_mask),
                static_cast<std::uint8_t>(stored & face.read_mask));
    passes = stencil_passes && depth_passes();
    const StencilOp op = !stencil_passes ? face.on_fail
                         : !passes       ? face.on_depth_fail
                                         : face.on_pass;
    const std::uint8_t changed = apply(op, face, stored);
    stored = static_cast<std::uint8_t>((stored & ~face.write_mask) | (changed & face.write_mask));
  } else {
    passes = depth_passes();
  }
  if (passes && test_depth && state.depth->write) *stored_depth = depth;
  return passes;
}

glm::vec4 blend(const BlendState& state, glm::vec4 source, glm::vec4 destination) {
  const glm::vec4 source_rgb = factor(state.colour.source, source, destination);
  const glm::vec4 destination_rgb = factor(state.colour.destination, source, destination);
  glm::vec4 result{};
  for (int i = 0; i < 3; ++i) {
    result[i] =
        combine(state.colour.op, source[i], source_rgb[i], destination[i], destination_rgb[i]);
  }
  result.w = combine(state.alpha.op, source.w, factor(state.alpha.source, source, destination).w,
                     destination.w, factor(state.alpha.destination, source, destination).w);
  return result;
}

void write_colour(const ColourState& state, Image& target, int x, int y, glm::vec4 colour,
                  const Profile& profile) {
  if (state.blend) {
    if (is_normalised(target.format)) colour = clamp_to_unit(colour);
    colour = blend(*state.blend, colour, load_texel(target, x, y));
  }
  if (state.write == std::array{true, true, true, true}) {
    store_texel(target, x, y, colour, profile);
    return;
  }
  // Channels that are masked out keep their bits, NaN too.
  const auto channels = static_cast<std::size_t>(channel_count(target.format));
  const std::size_t texel_bytes = bytes_per_texel(target.format);
  const std::size_t channel_bytes = texel_bytes / channels;
  std::byte* texel = target.bytes.data() + static_cast<std::size_t>(y) * target.stride_bytes +
                     static_cast<std::size_t>(x) * texel_bytes;
  std::array<std::byte, 16> before{};
  std::copy_n(texel, texel_bytes, before.begin());
  store_texel(target, x, y, colour, profile);
  for (std::size_t i = 0; i < channels; ++i) {
    const std::size_t at = i * channel_bytes;
    if (!state.write[i]) std::copy_n(before.data() + at, channel_bytes, texel + at);
  }
}

}  // namespace softfocus
