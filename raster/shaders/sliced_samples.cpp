// Arrays, volumes and cubes as shaders read them, a lane after the other.

#include <algorithm>
#include <array>

#include "raster/images/sliced_texture.h"
#include "raster/images/texel.h"
#include "raster/shaders/one_lane.h"

namespace softfocus {
namespace {

using At = LaneSample::At;

void fetch_of_slice(const LaneSample& sample, const Lane& lane, const Texture& texture) {
  std::array<std::int32_t, 3> at{};
  for (std::size_t i = 0; i < 3; ++i) {
    at[i] = static_cast<std::int32_t>(lane.bits(sample.at[i]) + lane.bits(sample.offset[i]));
  }
  const std::int32_t level = lane.whole(sample.more[0]);
  glm::vec4 texel{0.0f};
  if (level >= 0 && level < std::ssize(texture.levels)) {
    const auto number = static_cast<std::size_t>(level);
    if (at[2] >= 0 && at[2] < slice_count(texture, number)) {
      const Image& image = slice_level(texture, at[2], number);
      if (at[0] >= 0 && at[1] >= 0 && at[0] < image.width && at[1] < image.height) {
        texel = fetch_texel(image, at[0], at[1], *lane.frame.profile);
      }
    }
  }
  for (int i = 0; i < 4; ++i) lane.put(sample.to[static_cast<std::size_t>(i)], texel[i]);
}

glm::vec3 place_of_slice(const LaneSample& sample, const Lane& lane, const Texture& texture) {
  glm::vec3 at{lane.number(sample.at[0]), lane.number(sample.at[1]), lane.number(sample.at[2])};
  const Image& base = texture.levels.front();
  const std::array<int, 3> size{base.width, base.height, slice_count(texture)};
  for (int i = 0; i < 3; ++i) {
    const At& offset = sample.offset[static_cast<std::size_t>(i)];
    if (!offset.is_there) continue;
    at[i] += static_cast<float>(lane.whole(offset)) /
             static_cast<float>(size[static_cast<std::size_t>(i)]);
  }
  return at;
}

float level_of_slice(const LaneSample& sample, const Lane& lane, const Texture& texture) {
  const Profile& profile = *lane.frame.profile;
  if (sample.sample.kind == SampleKind::level) return lane.number(sample.more[0]);
  const auto vector = [&](const auto& number) {
    return glm::vec3{number(std::size_t{0}), number(std::size_t{1}), number(std::size_t{2})};
  };
  if (sample.sample.kind == SampleKind::gradient) {
    const glm::vec3 at = vector([&](std::size_t i) { return lane.number(sample.at[i]); });
    return sliced_level_of_detail(
        texture, at, vector([&](std::size_t i) { return lane.number(sample.more[i]); }),
        vector([&](std::size_t i) { return lane.number(sample.more[3 + i]); }), profile);
  }
  if (texture.levels.size() == 1 && sample.sample.kind == SampleKind::implicit) return 0.0f;
  // llvmpipe's is a pixel's own, of its face, row and column.
  const bool is_own =
      texture.shape == TextureShape::cube && profile.texture_unit == TextureUnit::llvmpipe;
  const int first = lane.lane & ~3;
  const int row = profile.attributes == AttributeSetup::planes_by_quad ? 2 : 0;
  const int left = is_own ? lane.lane & ~1 : first + row, top = is_own ? lane.lane & ~2 : first;
  const auto difference = [&](int to, int from) {
    return vector([&](std::size_t i) {
      return lane.number_of(sample.at[i], to) - lane.number_of(sample.at[i], from);
    });
  };
  const int pixel = is_own ? lane.lane : first;
  const glm::vec3 at = vector([&](std::size_t i) { return lane.number_of(sample.at[i], pixel); });
  const float lod = sliced_level_of_detail(texture, at, difference(left + 1, left),
                                           difference(top + 2, top), profile);
  return sample.more[0].is_there ? lod + lane.number(sample.more[0]) : lod;
}

void size_of_slices(const LaneSample& sample, const Lane& lane, const Texture& texture) {
  const auto last = static_cast<std::int32_t>(texture.levels.size()) - 1;
  const auto level = static_cast<std::size_t>(std::clamp(lane.whole(sample.more[0]), 0, last));
  const Image& image = texture.levels[level];
  lane.put(sample.to[0], static_cast<std::uint32_t>(image.width));
  lane.put(sample.to[1], static_cast<std::uint32_t>(image.height));
  lane.put(sample.to[2], static_cast<std::uint32_t>(slice_count(texture, level)));
}

}  // namespace

void sample_sliced_lane(const LaneSample& sample, const Lane& lane, const ShaderTexture& from) {
  const Texture& texture = *from.texture;
  switch (sample.sample.kind) {
    case SampleKind::fetch: return fetch_of_slice(sample, lane, texture);
    case SampleKind::gather: {
      const glm::vec3 at = place_of_slice(sample, lane, texture);
      if (texture.shape == TextureShape::cube) return gather_cube_texels(sample, lane, from, at);
      const Image& layer =
          slice_level(texture, nearest_layer(texture, at.z, *lane.frame.profile), 0);
      return gather_texels(sample, lane, from, layer, {at.x, at.y});
    }
    case SampleKind::size: return size_of_slices(sample, lane, texture);
    case SampleKind::levels:
      return lane.put(sample.to[0], static_cast<std::uint32_t>(texture.levels.size()));
    case SampleKind::query_lod: {
      const float lod = level_of_slice(sample, lane, texture);
      const auto last = static_cast<float>(texture.levels.size() - 1);
      lane.put(sample.to[0], std::clamp(lod, 0.0f, last));
      return lane.put(sample.to[1], lod);
    }
    default: break;
  }
  const glm::vec4 texel =
      sample_sliced(texture, from.sampler, place_of_slice(sample, lane, texture),
                    level_of_slice(sample, lane, texture), *lane.frame.profile);
  if (sample.compared.is_there) {
    const bool passes = compare(from.compare, lane.number(sample.compared), texel.x);
    return lane.put(sample.to[0], passes ? 1.0f : 0.0f);
  }
  for (int i = 0; i < 4; ++i) lane.put(sample.to[static_cast<std::size_t>(i)], texel[i]);
}

}  // namespace softfocus
