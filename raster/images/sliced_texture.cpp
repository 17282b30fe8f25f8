#include "raster/images/sliced_texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "raster/images/bilinear.h"
#include "raster/images/driver_samplers.h"
#include "raster/images/integer_filter.h"
#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/numbers/lerp.h"

namespace softfocus {

int slice_count(const Texture& texture, std::size_t level) {
  const auto count = static_cast<int>(texture.behind.size()) + 1;
  return texture.shape == TextureShape::volume ? std::max(1, count >> level) : count;
}

Texture make_sliced_texture(TextureShape shape, std::vector<Image> slices) {
  assert(!slices.empty() && (shape != TextureShape::cube || slices.size() == 6));
  Texture texture = make_texture(std::move(slices.front()));
  texture.shape = shape;
  texture.behind.reserve(slices.size() - 1);
  for (std::size_t i = 1; i < slices.size(); ++i) {
    texture.behind.push_back(make_texture(std::move(slices[i])));
  }
  return texture;
}

// --- mip levels ---

namespace {

/// Levels of a volume from the second on.
void generate_volume_mipmaps(Texture& texture, const Profile& profile) {
  texture.levels.resize(1);
  for (Texture& slice : texture.behind) slice.levels.resize(1);
  for (std::size_t level = 1;; ++level) {
    const Image& base = texture.levels.back();
    const int width = base.width, height = base.height, slices = slice_count(texture, level - 1);
    if (width == 1 && height == 1 && slices == 1) return;
    for (int slice = 0; slice < slice_count(texture, level); ++slice) {
      Image coarse = make_image(texture.levels.front().format, std::max(1, width / 2),
                                std::max(1, height / 2));
      const auto sum_of = [&](int z, int x, int y) {
        const Image& fine = slice_level(texture, std::min(z, slices - 1), level - 1);
        const int x0 = std::min(x, width - 1), x1 = std::min(x + 1, width - 1);
        const int y0 = std::min(y, height - 1), y1 = std::min(y + 1, height - 1);
        return (load_texel(fine, x0, y0) + load_texel(fine, x1, y0)) +
               (load_texel(fine, x0, y1) + load_texel(fine, x1, y1));
      };
      for (int y = 0; y < coarse.height; ++y) {
        for (int x = 0; x < coarse.width; ++x) {
          const glm::vec4 sum =
              sum_of(2 * slice, 2 * x, 2 * y) + sum_of(2 * slice + 1, 2 * x, 2 * y);
          store_texel(coarse, x, y, sum * 0.125f, profile);
        }
      }
      Texture& to = slice == 0 ? texture : texture.behind[static_cast<std::size_t>(slice) - 1];
      to.levels.push_back(std::move(coarse));
    }
  }
}

}  // namespace

void generate_sliced_mipmaps(Texture& texture, const Profile& profile) {
  if (texture.shape == TextureShape::volume) return generate_volume_mipmaps(texture, profile);
  Texture first{.levels = std::move(texture.levels)};
  generate_mipmaps(first, profile);
  texture.levels = std::move(first.levels);
  for (Texture& slice : texture.behind) generate_mipmaps(slice, profile);
}

// --- a picture of slices ---

namespace {

Image part_of(const Image& picture, int left, int top, int size) {
  Image part = make_image(picture.format, size, size);
  const std::size_t texel = bytes_per_texel(picture.format);
  for (int y = 0; y < size; ++y) {
    std::memcpy(&part.bytes[static_cast<std::size_t>(y) * part.stride_bytes],
                &picture.bytes[static_cast<std::size_t>(top + y) * picture.stride_bytes +
                               static_cast<std::size_t>(left) * texel],
                static_cast<std::size_t>(size) * texel);
  }
  return part;
}

}  // namespace

std::string why_not_cut(int width, int height, TextureShape shape) {
  const int shorter = std::min(width, height), longer = std::max(width, height);
  const bool is_strip = longer % shorter == 0;
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " texels are ";
  if (shape == TextureShape::cube) {
    const bool is_cross = width % 4 == 0 && height % 3 == 0 && width / 4 == height / 3;
    if ((is_strip && longer / shorter == 6) || is_cross) return {};
    return size +
           "no cube; six squares in a row or column, or a cross of 4 x 3 squares would be right";
  }
  if (is_strip && longer > shorter) return {};
  return size + "no " + (shape == TextureShape::volume ? "volume" : "array") +
         "; square slices in a row or column would be right";
}

Texture cut_texture(const Image& picture, TextureShape shape) {
  assert(why_not_cut(picture.width, picture.height, shape).empty());
  const int shorter = std::min(picture.width, picture.height);
  const int count = std::max(picture.width, picture.height) / shorter;
  std::vector<Image> slices;
  if (shape == TextureShape::cube && count != 6) {
    constexpr int kCross[6][2] = {{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}};
    const int size = picture.width / 4;
    slices.reserve(6);
    for (const auto& [column, row] : kCross) {
      slices.push_back(part_of(picture, column * size, row * size, size));
    }
  } else {
    const bool is_row = picture.width > picture.height;
    slices.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      slices.push_back(
          part_of(picture, is_row ? i * shorter : 0, is_row ? 0 : i * shorter, shorter));
    }
  }
  return make_sliced_texture(shape, std::move(slices));
}

// --- cubes ---

namespace {

/// The main axis of a face, and the axes that s and t go along, with their signs.
struct FaceAxes {
  int main, s, t;
  int main_sign, s_sign, t_sign;
};
constexpr std::array<FaceAxes, 6> kFaces{{{0, 2, 1, 1, -1, -1},
                                          {0, 2, 1, -1, 1, -1},
                                          {1, 0, 2, 1, 1, 1},
                                          {1, 0, 2, -1, 1, -1},
                                          {2, 0, 1, 1, 1, -1},
                                          {2, 0, 1, -1, -1, -1}}};

int main_axis(glm::vec3 direction) {
  const float x = std::fabs(direction.x), y = std::fabs(direction.y), z = std::fabs(direction.z);
  if (!(z < x || z < y)) return 2;
  return x <= y ? 1 : 0;
}

int face_of(glm::vec3 direction) {
  const int axis = main_axis(direction);
  const float main = direction[axis];
  // A NaN's sign is the processor's.
  return 2 * axis + (std::signbit(main) && main == main ? 1 : 0);
}

float on_face(float value) { return value > 0.0f ? std::min(value, 1.0f) : 0.0f; }

}  // namespace

CubePlace cube_place(glm::vec3 direction) {
  const int face = face_of(direction);
  const FaceAxes& axes = kFaces[static_cast<std::size_t>(face)];
  const float half = 0.5f / std::fabs(direction[axes.main]);
  const float s = static_cast<float>(axes.s_sign) * direction[axes.s];
  const float t = static_cast<float>(axes.t_sign) * direction[axes.t];
  return {face, {on_face(s * half + 0.5f), on_face(t * half + 0.5f)}};
}

CubeTexel cube_texel(const CubeTexel& at, int size) {
  const auto is_inside = [&](int i) { return i >= 0 && i < size; };
  if (is_inside(at.x) && is_inside(at.y)) return at;
  // Centres lie at odd numbers from -(size - 1) to size - 1, faces at `size`. Over the edge, the
  // face's own part falls to that of the first texels there, and the part that left is the face's.
  const FaceAxes& from = kFaces[static_cast<std::size_t>(at.face)];
  std::array<int, 3> place{};
  const auto put = [&](int axis, int value) { place[static_cast<std::size_t>(axis)] = value; };
  const auto centre = [&](int i) { return std::clamp(2 * i + 1 - size, -size, size); };
  put(from.main, from.main_sign * (size - 1));
  put(from.s, from.s_sign * centre(at.x));
  put(from.t, from.t_sign * centre(at.y));
  const int axis = is_inside(at.x) ? from.t : from.s;
  const auto part = [&](int of) { return place[static_cast<std::size_t>(of)]; };
  const int face = 2 * axis + (part(axis) < 0 ? 1 : 0);
  const FaceAxes& to = kFaces[static_cast<std::size_t>(face)];
  const auto index = [&](int value) { return (value + size - 1) / 2; };
  return {face, index(to.s_sign * part(to.s)), index(to.t_sign * part(to.t))};
}

glm::vec4 fetch_cube_texel(const Texture& texture, const CubeTexel& at, std::size_t level,
                           const Profile& profile) {
  const int size = texture.levels[level].width;
  const auto of_face = [&](int x, int y) {
    const CubeTexel found = cube_texel({at.face, x, y}, size);
    return fetch_texel(slice_level(texture, found.face, level), found.x, found.y, profile);
  };
  const auto is_outside = [&](int i) { return i < 0 || i >= size; };
  if (!is_outside(at.x) || !is_outside(at.y)) return of_face(at.x, at.y);
  const int left = std::min(at.x, size - 1), upper = std::min(at.y, size - 1);
  std::array<glm::vec4, 3> others{};
  std::size_t count = 0;
  for (const int y : {upper, upper + 1}) {
    for (const int x : {left, left + 1}) {
      if (x != at.x || y != at.y) others[count++] = of_face(x, y);
    }
  }
  return ((others[0] + others[1]) + others[2]) * (1.0f / 3.0f);
}

// --- sampling ---

int nearest_layer(const Texture& texture, float at, const Profile& profile) {
  const int last = slice_count(texture) - 1;
  if (profile.texture_unit == TextureUnit::llvmpipe) return std::clamp(round_to_int(at), 0, last);
  return at > 0.0f ? static_cast<int>(std::nearbyint(std::min(at, static_cast<float>(last)))) : 0;
}

namespace {

// As of flat textures: only drivers flush between the steps.

struct UnfusedMix {
  float operator()(float a, float b, float t) const { return lerp(a, b, t, Contraction::unfused); }
};
struct FusedMix {
  float operator()(float a, float b, float t) const { return lerp(a, b, t, Contraction::fused); }
};
struct DriverMix {
  const Profile& profile;
  float operator()(float a, float b, float t) const { return lerp(a, b, t, profile); }
};

/// One level of a volume or cube, by a profile's unit.
template <class Mix>
class LevelFilter {
 public:
  LevelFilter(const Texture& texture, const Sampler& sampler, const Profile& profile, Mix mix)
      : texture_(texture),
        sampler_(sampler),
        profile_(profile),
        is_llvmpipe_(profile.texture_unit == TextureUnit::llvmpipe),
        mix_(mix) {}

  LevelChoice levels(float lod) const {
    if (is_llvmpipe_) return llvmpipe_levels(lod, texture_.levels.size(), sampler_.filter);
    const auto last = static_cast<float>(texture_.levels.size() - 1);
    const float level = lod > 0.0f ? std::min(lod, last) : 0.0f;
    if (sampler_.filter != Filter::trilinear) return {static_cast<std::size_t>(level + 0.5f), 0.0f};
    const float base = std::floor(level);
    return {static_cast<std::size_t>(base), rounded_weight(level - base)};
  }

  /// llvmpipe's way with bytes of volumes; cubes it filters in floats.
  bool takes_integers() const {
    return is_llvmpipe_ && sampler_.filter != Filter::nearest &&
           sampler_.wrap_w != Wrap::mirrored_repeat &&
           is_filtered_in_integers(texture_.levels.front().format, sampler_);
  }

  glm::vec4 of_volume(glm::vec3 at, std::size_t level) const {
    const Image& base = texture_.levels.front();
    const Image& image = texture_.levels[level];
    const int slices = slice_count(texture_, level), base_slices = slice_count(texture_);
    if (sampler_.filter == Filter::nearest) {
      const int x = nearest(at.x, image.width, base.width, sampler_.wrap_u);
      const int y = nearest(at.y, image.height, base.height, sampler_.wrap_v);
      return texel(nearest(at.z, slices, base_slices, sampler_.wrap_w), level, x, y);
    }
    const Taps u = taps(at.x, image.width, base.width, sampler_.wrap_u);
    const Taps v = taps(at.y, image.height, base.height, sampler_.wrap_v);
    const Taps w = taps(at.z, slices, base_slices, sampler_.wrap_w);
    const auto slice = [&](int z) {
      return filter_bilinear(
          u, v, [&](int x, int y) { return texel(z, level, x, y); }, mix_);
    };
    return mix_components(slice(w.first), slice(w.second), w.weight, mix_);
  }

  glm::vec4 of_cube(const CubePlace& place, std::size_t level) const {
    const int size = texture_.levels[level].width;
    const auto length = static_cast<float>(size);
    if (sampler_.filter == Filter::nearest) {
      const auto index = [&](float s) { return std::min(static_cast<int>(s * length), size - 1); };
      return texel(place.face, level, index(place.at.x), index(place.at.y));
    }
    const auto face_taps = [&](float s) {
      float position = s * length - 0.5f;
      if (profile_.bilinear_weights == BilinearWeights::fixed_8) {
        position = std::nearbyint(position * 256.0f) * (1.0f / 256.0f);
      }
      const float base = std::floor(position);
      const int index = static_cast<int>(base);
      return Taps{index, index + 1, position - base};
    };
    return filter_bilinear(
        face_taps(place.at.x), face_taps(place.at.y),
        [&](int x, int y) {
          return fetch_cube_texel(texture_, {place.face, x, y}, level, profile_);
        },
        mix_);
  }

  glm::vec4 mix_levels(glm::vec4 fine, glm::vec4 coarse, float weight) const {
    return mix_components(fine, coarse, weight, mix_);
  }

 private:
  const Texture& texture_;
  const Sampler& sampler_;
  const Profile& profile_;
  bool is_llvmpipe_;
  Mix mix_;

  float rounded_weight(float weight) const {
    return profile_.bilinear_weights == BilinearWeights::fixed_8
               ? std::nearbyint(weight * 256.0f) * (1.0f / 256.0f)
               : weight;
  }
  Taps taps(float at, int size, int base_size, Wrap wrap) const {
    return is_llvmpipe_ ? llvmpipe_taps(at, size, base_size, wrap)
                        : standard_taps(at, size, wrap, profile_.bilinear_weights);
  }
  int nearest(float at, int size, int base_size, Wrap wrap) const {
    return is_llvmpipe_ ? llvmpipe_nearest(at, size, base_size, wrap)
                        : standard_nearest(at, size, wrap);
  }
  glm::vec4 texel(int slice, std::size_t level, int x, int y) const {
    return fetch_texel(slice_level(texture_, slice, level), x, y, profile_);
  }
};

template <class Mix>
glm::vec4 filter_levels(const LevelFilter<Mix>& filter, const Texture& texture,
                        const Sampler& sampler, glm::vec3 at, float lod) {
  const bool is_cube = texture.shape == TextureShape::cube;
  const CubePlace place = is_cube ? cube_place(at) : CubePlace{};
  const auto level = [&](std::size_t number) {
    return is_cube ? filter.of_cube(place, number) : filter.of_volume(at, number);
  };
  const LevelChoice levels = filter.levels(lod);
  if (!is_cube && filter.takes_integers()) {
    return sample_slices_unorm8(texture, sampler, at, levels.first, levels.next_weight);
  }
  const Format format = texture.levels.front().format;
  const glm::vec4 fine = level(levels.first);
  if (!(levels.next_weight > 0.0f)) return with_missing_channels(fine, format);
  return with_missing_channels(filter.mix_levels(fine, level(levels.first + 1), levels.next_weight),
                               format);
}

}  // namespace

glm::vec4 sample_sliced(const Texture& texture, const Sampler& sampler, glm::vec3 at, float lod,
                        const Profile& profile) {
  if (texture.shape == TextureShape::array) {
    const int layer = nearest_layer(texture, at.z, profile);
    const Texture& flat =
        layer == 0 ? texture : texture.behind[static_cast<std::size_t>(layer) - 1];
    return sample(flat, sampler, {at.x, at.y}, lod, profile);
  }
  const auto filtered = [&](auto mix) {
    const LevelFilter filter{texture, sampler, profile, mix};
    return filter_levels(filter, texture, sampler, at, lod);
  };
  if (profile.texture_unit == TextureUnit::standard) {
    return profile.lerp == Contraction::fused ? filtered(FusedMix{}) : filtered(UnfusedMix{});
  }
  for (int i = 0; i < 3; ++i) at[i] = flush_denormal(at[i], profile.denormals);
  lod = flush_denormal(lod, profile.denormals);
  return filtered(DriverMix{profile});
}

float sliced_level_of_detail(const Texture& texture, glm::vec3 at, glm::vec3 per_x, glm::vec3 per_y,
                             const Profile& profile) {
  if (texture.shape == TextureShape::array) {
    return level_of_detail(texture, {per_x.x, per_x.y}, {per_y.x, per_y.y}, profile);
  }
  if (texture.shape == TextureShape::cube) {
    const FaceAxes& axes = kFaces[static_cast<std::size_t>(face_of(at))];
    const float inverse = 1.0f / at[axes.main], half = 0.5f * inverse;
    const auto slope = [&](glm::vec3 change) {
      const float main = change[axes.main] * inverse;
      return glm::vec2{(change[axes.s] - main * at[axes.s]) * half,
                       (change[axes.t] - main * at[axes.t]) * half};
    };
    return level_of_detail(texture, slope(per_x), slope(per_y), profile);
  }
  const Image& base = texture.levels.front();
  const glm::vec3 size{static_cast<float>(base.width), static_cast<float>(base.height),
                       static_cast<float>(slice_count(texture))};
  const auto square = [&](glm::vec3 change) {
    const glm::vec3 texels = change * size;
    return (texels.x * texels.x + texels.y * texels.y) + texels.z * texels.z;
  };
  const float across = square(per_x), down = square(per_y);
  const float larger = across > down ? across : down;
  return profile.texture_unit == TextureUnit::swiftshader ? log2_of_root_by_bits(larger)
                                                          : 0.5f * log2_linear(larger);
}

}  // namespace softfocus
