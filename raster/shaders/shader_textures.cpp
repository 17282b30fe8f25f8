// Textures as shaders read them, a lane after the other: the oracle of what shader_lanes.cpp reads
// in vectors, and the way of all that is not there.

#include <algorithm>
#include <cmath>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/shaders/one_lane.h"

namespace softfocus {
namespace {

using At = LaneSample::At;

const ShaderTexture* texture_at(const LaneFrame& frame, std::uint32_t number, TextureShape shape) {
  if (number >= frame.textures.size()) return nullptr;
  const ShaderTexture& found = frame.textures[number];
  const bool is_it =
      found.texture != nullptr && !found.texture->levels.empty() && found.texture->shape == shape;
  return is_it ? &found : nullptr;
}

std::int32_t wrapped(std::int32_t i, std::int32_t size, Wrap wrap) {
  switch (wrap) {
    case Wrap::clamp_to_edge: return std::clamp(i, 0, size - 1);
    case Wrap::repeat: return ((i % size) + size) % size;
    case Wrap::mirrored_repeat: {
      const std::int32_t turn = ((i % (2 * size)) + 2 * size) % (2 * size);
      return turn < size ? turn : 2 * size - 1 - turn;
    }
  }
  return 0;
}

float sanitized(float u) { return u - u == 0.0f ? u : 0.0f; }

void fetch(const LaneSample& sample, const Lane& lane, const ShaderTexture& from) {
  const auto sum = [&](std::size_t i) {
    return static_cast<std::int32_t>(lane.bits(sample.at[i]) + lane.bits(sample.offset[i]));
  };
  const std::int32_t x = sum(0);
  const std::int32_t y = sample.sample.dim == SpirvDim::one ? 0 : sum(1);
  const std::int32_t level = lane.whole(sample.more[0]);
  glm::vec4 texel{0.0f};
  if (level >= 0 && level < std::ssize(from.texture->levels)) {
    const Image& image = from.texture->levels[static_cast<std::size_t>(level)];
    if (x >= 0 && y >= 0 && x < image.width && y < image.height) {
      texel = fetch_texel(image, x, y, *lane.frame.profile);
    }
  }
  for (int i = 0; i < 4; ++i) lane.put(sample.to[static_cast<std::size_t>(i)], texel[i]);
}

float level_of(const LaneSample& sample, const Lane& lane, const ShaderTexture& from) {
  const Profile& profile = *lane.frame.profile;
  const bool is_one = sample.sample.dim == SpirvDim::one;
  if (sample.sample.kind == SampleKind::gradient) {
    return level_of_detail(
        *from.texture, {lane.number(sample.more[0]), is_one ? 0.0f : lane.number(sample.more[1])},
        {lane.number(sample.more[3]), is_one ? 0.0f : lane.number(sample.more[4])}, profile);
  }
  if (sample.sample.kind == SampleKind::level) return lane.number(sample.more[0]);
  const int first = lane.lane & ~3;
  const int row = profile.attributes == AttributeSetup::planes_by_quad ? 2 : 0;
  const auto along_x = [&](const At& at) {
    return lane.number_of(at, first + row + 1) - lane.number_of(at, first + row);
  };
  const auto along_y = [&](const At& at) {
    return lane.number_of(at, first + 2) - lane.number_of(at, first);
  };
  if (from.texture->levels.size() == 1 && sample.sample.kind == SampleKind::implicit) return 0.0f;
  const float lod = level_of_detail(*from.texture, {along_x(sample.at[0]), along_x(sample.at[1])},
                                    {along_y(sample.at[0]), along_y(sample.at[1])}, profile);
  return sample.more[0].is_there ? lod + lane.number(sample.more[0]) : lod;
}

glm::vec2 place_of(const LaneSample& sample, const Lane& lane, const ShaderTexture& from) {
  const Image& base = from.texture->levels.front();
  glm::vec2 at{lane.number(sample.at[0]),
               sample.sample.dim == SpirvDim::one ? 0.5f : lane.number(sample.at[1])};
  if (sample.sample.dim == SpirvDim::rectangle) {
    at.x /= static_cast<float>(base.width);
    at.y /= static_cast<float>(base.height);
  }
  // An offset in texels of the first level.
  if (sample.offset[0].is_there) {
    at.x += static_cast<float>(lane.whole(sample.offset[0])) / static_cast<float>(base.width);
  }
  if (sample.offset[1].is_there) {
    at.y += static_cast<float>(lane.whole(sample.offset[1])) / static_cast<float>(base.height);
  }
  return at;
}

void sample_one(const LaneSample& sample, const Lane& lane) {
  const ShaderTexture* from =
      texture_at(lane.frame, lane.bits(sample.texture), sample.sample.shape);
  if (from == nullptr) {
    for (const At& to : sample.to) lane.put(to, 0u);
    return;
  }
  if (sample.sample.shape != TextureShape::flat) return sample_sliced_lane(sample, lane, *from);
  // Results that are not made below.
  for (std::size_t i = 1; i < 4; ++i) {
    if (sample.sample.kind >= SampleKind::size || sample.compared.is_there) {
      lane.put(sample.to[i], 0u);
    }
  }
  switch (sample.sample.kind) {
    case SampleKind::fetch: return fetch(sample, lane, *from);
    case SampleKind::gather:
      return gather_texels(sample, lane, *from, from->texture->levels.front(),
                           place_of(sample, lane, *from));
    case SampleKind::size: {
      const auto last = static_cast<std::int32_t>(from->texture->levels.size()) - 1;
      const Image& image =
          from->texture
              ->levels[static_cast<std::size_t>(std::clamp(lane.whole(sample.more[0]), 0, last))];
      lane.put(sample.to[0], static_cast<std::uint32_t>(image.width));
      lane.put(sample.to[1], static_cast<std::uint32_t>(image.height));
      return;
    }
    case SampleKind::levels:
      lane.put(sample.to[0], static_cast<std::uint32_t>(from->texture->levels.size()));
      return;
    case SampleKind::query_lod: {
      const float lod = level_of(sample, lane, *from);
      const auto last = static_cast<float>(from->texture->levels.size() - 1);
      lane.put(sample.to[0], std::clamp(lod, 0.0f, last));
      lane.put(sample.to[1], lod);
      return;
    }
    default: break;
  }
  const glm::vec4 texel =
      softfocus::sample(*from->texture, from->sampler, place_of(sample, lane, *from),
                        level_of(sample, lane, *from), *lane.frame.profile);
  if (sample.compared.is_there) {
    const bool passes = compare(from->compare, lane.number(sample.compared), texel.x);
    lane.put(sample.to[0], passes ? 1.0f : 0.0f);
    return;
  }
  for (int i = 0; i < 4; ++i) lane.put(sample.to[static_cast<std::size_t>(i)], texel[i]);
}

/// The left or upper texel of the four round a place.
std::int32_t first_gathered(float u, int size) {
  constexpr float kFarthest = 0x1p22f;
  const float texels = sanitized(u) * static_cast<float>(size) - 0.5f;
  return static_cast<std::int32_t>(std::floor(std::clamp(texels, -kFarthest, kFarthest)));
}

/// Four texels, `texel(right, lower)`, in the order of textureGather.
template <class Texel>
void put_gathered(const LaneSample& sample, const Lane& lane, const ShaderTexture& from,
                  const Texel& texel) {
  constexpr int kOrder[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::vec4 found = texel(kOrder[i][0], kOrder[i][1]);
    float value = found[sample.sample.channel];
    if (sample.compared.is_there) {
      value = compare(from.compare, lane.number(sample.compared), found.x) ? 1.0f : 0.0f;
    }
    lane.put(sample.to[i], value);
  }
}

}  // namespace

void gather_texels(const LaneSample& sample, const Lane& lane, const ShaderTexture& from,
                   const Image& image, glm::vec2 at) {
  const Sampler& sampler = from.sampler;
  const std::int32_t x = first_gathered(at.x, image.width), y = first_gathered(at.y, image.height);
  put_gathered(sample, lane, from, [&](int right, int lower) {
    return fetch_texel(image, wrapped(x + right, image.width, sampler.wrap_u),
                       wrapped(y + lower, image.height, sampler.wrap_v), *lane.frame.profile);
  });
}

void gather_cube_texels(const LaneSample& sample, const Lane& lane, const ShaderTexture& from,
                        glm::vec3 direction) {
  const CubePlace place = cube_place(direction);
  const int size = from.texture->levels.front().width;
  const std::int32_t x = first_gathered(place.at.x, size), y = first_gathered(place.at.y, size);
  put_gathered(sample, lane, from, [&](int right, int lower) {
    return fetch_cube_texel(*from.texture, {place.face, x + right, y + lower}, 0,
                            *lane.frame.profile);
  });
}

const ShaderTexture* texture_of(const LaneSample& sample, const LaneFrame& frame) {
  return texture_at(frame, Lane{frame, 4, 0}.bits(sample.texture), sample.sample.shape);
}

void sample_by_lane(const LaneSample& sample, LaneFrame& frame, int unit_lanes) {
  const LaneRange range = range_of(sample.vectors, frame);
  const auto first = static_cast<int>(range.first_bytes / sizeof(float));
  const int end = first + static_cast<int>(range.count) * unit_lanes;
  for (int lane = first; lane < end; ++lane) sample_one(sample, Lane{frame, unit_lanes, lane});
}

}  // namespace softfocus
