// What C programs hand over to shaders, checked.

#include "dof/c/shader_arguments.h"

#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <numeric>
#include <string>
#include <utility>

#include "raster/images/sliced_texture.h"
#include "raster/shaders/link_shaders.h"

namespace softfocus {
namespace {

Format texel_format(const std::string& name, std::int32_t format) {
  switch (format) {
    case SOFTFOCUS_FORMAT_R8: return Format::r8;
    case SOFTFOCUS_FORMAT_RGBA8: return Format::rgba8;
    case SOFTFOCUS_FORMAT_SRGB8: return Format::srgb8;
    case SOFTFOCUS_FORMAT_RGBA16F: return Format::rgba16f;
    case SOFTFOCUS_FORMAT_R32F: return Format::r32f;
    case SOFTFOCUS_FORMAT_RGBA32F: return Format::rgba32f;
    case SOFTFOCUS_FORMAT_RGBA32I:
    case SOFTFOCUS_FORMAT_RGBA32UI: return Format::rgba32f;
    default: refuse(name + ".format", std::to_string(format) + " is no softfocus_format");
  }
}

/// Texels of a caller's, checked.
struct CheckedTexels {
  ImageView view{};
  MemoryRange range{};
};

CheckedTexels checked_texels(const std::string& name, const softfocus_texels& texels,
                             bool is_written) {
  const auto is_side = [](std::int32_t side) { return side >= 1 && side <= kMaxImageSize; };
  if (!is_side(texels.width) || !is_side(texels.height)) {
    refuse(name, "its width and height are " + std::to_string(texels.width) + " and " +
                     std::to_string(texels.height) + ", not from 1 to " +
                     std::to_string(kMaxImageSize));
  }
  const Format format = texel_format(name, texels.format);
  const ImageView view =
      view_of(format, texels.first, texels.width, texels.height, texels.row_bytes);
  const auto texel = static_cast<std::ptrdiff_t>(bytes_per_texel(format));
  const std::ptrdiff_t channel = texel / channel_count(format);
  const PixelPlane plane{name + ".first", texels.first, texel, view.stride_bytes, texel};
  const MemoryRange range = range_of(plane, texels.width, texels.height);
  if (is_written) check_apart(plane, texels.width, texels.height);
  if (range.begin % static_cast<std::uintptr_t>(channel) != 0 || view.stride_bytes % channel != 0) {
    refuse(plane.name, "it or row_bytes is not aligned to " + std::to_string(channel) + " bytes");
  }
  return {view, range};
}

/// The value of a number of an enum; 0 is `preset`.
template <class Value>
Value one_of(const std::string& name, std::int32_t given_value, Value preset,
             std::initializer_list<std::pair<int, Value>> values, const char* words) {
  if (given_value == 0) return preset;
  for (const auto& [number, value] : values) {
    if (number == given_value) return value;
  }
  refuse(name, std::to_string(given_value) + " is none; there are " + words);
}

std::vector<std::uint32_t> read_indices(const softfocus_vertices& vertices) {
  const auto count = static_cast<std::uint32_t>(vertices.vertex_count);
  std::vector<std::uint32_t> indices;
  if (vertices.indices != nullptr) {
    indices.assign(vertices.indices, vertices.indices + vertices.index_count);
  } else {
    indices.resize(count);
    std::iota(indices.begin(), indices.end(), 0u);
  }
  if (indices.size() % 3 != 0) {
    refuse("vertices.index_count", std::to_string(indices.size()) + "; a triangle has three");
  }
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] >= count) {
      refuse("vertices.indices[" + std::to_string(i) + "]",
             std::to_string(indices[i]) + "; there are " + std::to_string(count) + " vertices");
    }
  }
  return indices;
}

std::vector<VertexAttribute> read_attributes(const softfocus_vertices& vertices,
                                             const SpirvModule& shader) {
  if (vertices.attribute_count < 0 ||
      (vertices.attribute_count > 0 && vertices.attributes == nullptr)) {
    refuse("vertices.attributes", "a null pointer, or attribute_count is negative");
  }
  const std::vector<ShaderPort> inputs = inputs_of(shader);
  std::vector<VertexAttribute> read;
  for (std::int32_t i = 0; i < vertices.attribute_count; ++i) {
    const std::string argument = "vertices.attributes[" + std::to_string(i) + "]";
    const auto attribute = read_struct(argument, vertices.attributes[i]);
    if (attribute.name == nullptr) refuse(argument + ".name", "a null pointer");
    if (attribute.first == nullptr) refuse(argument + ".first", "a null pointer");
    const auto input = std::find_if(inputs.begin(), inputs.end(), [&](const ShaderPort& port) {
      return port.name == attribute.name;
    });
    if (input == inputs.end()) {
      std::string all;
      for (const ShaderPort& port : inputs) {
        if (!all.empty()) all += ", ";
        all += port.name;
      }
      refuse(argument + ".name", "the vertex shader has no input '" + std::string{attribute.name} +
                                     "'; there " + (all.empty() ? "is none" : "are " + all));
    }
    const auto most = static_cast<std::int32_t>(input->numbers.size());
    const bool is_vector = input->locations == 1;
    if (attribute.numbers < 1 || attribute.numbers > most ||
        (!is_vector && attribute.numbers != most)) {
      refuse(argument + ".numbers", std::to_string(attribute.numbers) + "; '" + input->name +
                                        "' has " + std::to_string(most));
    }
    const std::int32_t each = attribute.numbers / input->locations;
    const std::size_t stride = attribute.vertex_bytes != 0
                                   ? attribute.vertex_bytes
                                   : std::size_t{4} * static_cast<unsigned>(attribute.numbers);
    for (int part = 0; part < input->locations; ++part) {
      read.push_back({.location = input->location + part,
                      .components = each,
                      .first = static_cast<const std::byte*>(attribute.first) +
                               std::ptrdiff_t{4} * part * each,
                      .stride = stride});
    }
  }
  return read;
}

Wrap wrap_of(const std::string& name, std::int32_t wrap) {
  return one_of<Wrap>(name, wrap, Wrap::repeat,
                      {{SOFTFOCUS_REPEAT, Wrap::repeat},
                       {SOFTFOCUS_MIRROR, Wrap::mirrored_repeat},
                       {SOFTFOCUS_CLAMP, Wrap::clamp_to_edge}},
                      "SOFTFOCUS_REPEAT, MIRROR and CLAMP");
}

}  // namespace

std::vector<ImageView> read_slices(const std::string& name, const softfocus_texels* from,
                                   const ShaderUniform& sampler) {
  auto texels = read_struct(name, from);
  const std::int32_t count = texels.slices == 0 ? 1 : texels.slices;
  const std::string reader =
      "; '" + sampler.name + "' is a " + std::string{sampler_name(sampler.shape)};
  const auto refuse_slices = [&](const std::string& right) {
    refuse(name + ".slices", std::to_string(texels.slices) + reader + right);
  };
  if (sampler.shape == TextureShape::flat && count != 1) refuse_slices(", and reads one");
  if (sampler.shape == TextureShape::cube && count != 6) refuse_slices(", and reads six faces");
  if (count < 1 || count > kMaxImageSize) {
    refuse_slices(", and reads 1 to " + std::to_string(kMaxImageSize));
  }
  if (sampler.shape == TextureShape::cube && texels.width != texels.height) {
    refuse(name, "its width and height are " + std::to_string(texels.width) + " and " +
                     std::to_string(texels.height) + reader + ", of square faces");
  }
  std::vector<ImageView> slices{checked_texels(name, texels, false).view};
  std::ptrdiff_t next = texels.slice_bytes;
  if (next == 0) next = slices[0].stride_bytes * texels.height;
  const auto texel = static_cast<std::ptrdiff_t>(bytes_per_texel(slices[0].format));
  const std::string stride = name + ".slice_bytes";
  range_of({stride, texels.first, texel, next, texel}, 1, count);
  const std::ptrdiff_t channel = texel / channel_count(slices[0].format);
  assert(channel > 0);
  if (next % channel != 0) {
    refuse(stride, std::to_string(next) + " is no multiple of a channel's bytes");
  }
  slices.reserve(static_cast<std::size_t>(count));
  for (std::int32_t i = 1; i < count; ++i) {
    texels.first = static_cast<std::byte*>(texels.first) + next;
    slices.push_back(checked_texels(name, texels, false).view);
  }
  return slices;
}

ShaderTexture read_sampler(const softfocus_sampler* from) {
  ShaderTexture read;
  if (from == nullptr) return read;
  const auto sampler = read_struct("sampler", from);
  read.sampler.filter = one_of<Filter>("sampler.filter", sampler.filter, Filter::bilinear,
                                       {{SOFTFOCUS_NEAREST, Filter::nearest},
                                        {SOFTFOCUS_BILINEAR, Filter::bilinear},
                                        {SOFTFOCUS_TRILINEAR, Filter::trilinear}},
                                       "SOFTFOCUS_NEAREST, BILINEAR and TRILINEAR");
  read.sampler.wrap_u = wrap_of("sampler.wrap_u", sampler.wrap_u);
  read.sampler.wrap_v = wrap_of("sampler.wrap_v", sampler.wrap_v);
  read.sampler.wrap_w = wrap_of("sampler.wrap_w", sampler.wrap_w);
  read.compare = one_of<Compare>("sampler.compare", sampler.compare, Compare::less_equal,
                                 {{SOFTFOCUS_NEVER, Compare::never},
                                  {SOFTFOCUS_LESS, Compare::less},
                                  {SOFTFOCUS_EQUAL, Compare::equal},
                                  {SOFTFOCUS_LESS_EQUAL, Compare::less_equal},
                                  {SOFTFOCUS_GREATER, Compare::greater},
                                  {SOFTFOCUS_NOT_EQUAL, Compare::not_equal},
                                  {SOFTFOCUS_GREATER_EQUAL, Compare::greater_equal},
                                  {SOFTFOCUS_ALWAYS, Compare::always}},
                                 "SOFTFOCUS_NEVER to SOFTFOCUS_ALWAYS");
  return read;
}

ReadVertices read_vertices(const softfocus_vertices* from, const SpirvModule& shader) {
  const auto vertices = read_struct("vertices", from);
  if (vertices.vertex_count < 0) refuse("vertices.vertex_count", "it is negative");
  return {read_attributes(vertices, shader), read_indices(vertices),
          static_cast<std::uint32_t>(vertices.vertex_count)};
}

ReadPass read_pass(const softfocus_pass* from) {
  const auto pass = read_struct("pass", from);
  if (pass.target_count < 1 || pass.target_count > SOFTFOCUS_MOST_TARGETS) {
    refuse("pass.target_count", std::to_string(pass.target_count) + " is not from 1 to " +
                                    std::to_string(SOFTFOCUS_MOST_TARGETS));
  }
  if (pass.targets == nullptr) refuse("pass.targets", "a null pointer");
  ReadPass read;
  if (pass.profile != nullptr) read.profile = profile_of("pass.profile", pass.profile);
  if (pass.budget != 0) read.budget = pass.budget;
  std::vector<MemoryRange> ranges;
  for (std::int32_t i = 0; i < pass.target_count; ++i) {
    read.targets.emplace_back();
    if (pass.targets[i] == nullptr) continue;
    const std::string name = "pass.targets[" + std::to_string(i) + "]";
    const auto target = read_struct(name, pass.targets[i]);
    if (target.slices > 1) refuse(name + ".slices", "a target has one");
    const CheckedTexels texels = checked_texels(name, target, true);
    for (const ImageView& other : read.targets) {
      if (other.texels != nullptr &&
          (other.width != texels.view.width || other.height != texels.view.height)) {
        refuse(name, "it has not the size of the others");
      }
    }
    for (const MemoryRange& other : ranges) {
      if (overlap(other, texels.range)) refuse(name, "it lies over another target");
    }
    ranges.push_back(texels.range);
    read.targets.back() = texels.view;
  }
  if (ranges.empty()) refuse("pass.targets", "all are null");
  return read;
}

}  // namespace softfocus
