#include "raster/shaders/draw_shaders.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string>

#include "raster/pipeline/draw.h"
#include "raster/shaders/run_vertices.h"
#include "raster/shaders/shader_batches.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

constexpr std::size_t kGroup = kMaxVaryings;
using GroupKinds = std::array<Interpolation, kGroup>;
using Corners = std::array<Varyings<kGroup>, 3>;

// Varyings that are interpolated go through the pipeline in groups of kGroup. Clipping cuts all
// groups alike, as it looks at positions alone. Flat ones, which may be whole numbers, are looked
// up by their vertex.
struct ShaderChunk {
  draw_detail::Chunk<kGroup> first{};    ///< triangles with the first group, and bins
  std::vector<Corners> more{};           ///< of each triangle the other groups
  std::vector<std::uint32_t> numbers{};  ///< of each triangle its place among the draw's
};

// Where an input of the fragment shader comes from.
struct FragmentInput {
  enum class From : std::uint8_t { pipeline, vertex, builtin } from{};
  std::size_t number = 0;  ///< among those that are interpolated; of a vertex's values
  SpirvBuiltin builtin{};
  int part = 0;  ///< of the built-in
};

// Fragments that wait to be shaded together.
struct Waiting {
  int x = 0, y = 0;
  float depth = 0.0f;
  std::array<float, kMaxSamples> depths{};
  bool front_facing = true;
  draw_detail::Samples covered = 0;  ///< none: only there for its neighbours' differences
};

struct FragmentMemory {
  BatchMemory registers{};
  std::vector<Waiting> fragments{};
  std::vector<std::uint32_t> inputs{};  ///< input by input, of each lane
  std::vector<float> w{};               ///< clip w of each lane
};

constexpr std::size_t kPositionVarying = 0;  ///< clip w, if a texel wants it

struct ShadersRecorded {
  RenderTargets targets;
  Profile profile;
  DrawState state;
  Rectangle clip, viewport;
  int width, height;
  std::span<const std::uint32_t> indices;
  ShaderDraw draw;
  ShaderBatches vertex_batches, fragment_batches;

  std::vector<ShaderVarying> varyings{};    ///< of each vertex's values
  std::vector<std::size_t> interpolated{};  ///< of the values, those that are; ~0: clip w
  std::vector<GroupKinds> kinds{};          ///< a group each
  std::vector<FragmentInput> inputs{};      ///< of the fragment program, without uniforms
  std::array<std::array<ShaderRegister, 4>, kMaxColourTargets> outputs{};
  std::array<bool, kMaxColourTargets> has_output{};
  ShaderRegister depth_output{};
  bool tests_come_last = false;

  std::vector<glm::vec4> positions;
  std::vector<std::uint32_t> values{};
  std::vector<ShaderChunk> chunks;
  mutable ScratchShelf<BatchMemory> vertex_memory{};
  mutable ScratchShelf<FragmentMemory> fragment_memory{};

  ShadersRecorded(const RenderPass& pass, const DrawState& draw_state,
                  std::span<const std::uint32_t> draw_indices, std::uint32_t vertex_count,
                  std::uint32_t chunk_count, const ShaderDraw& of)
      : targets(pass.targets),
        profile(pass.profile),
        state(draw_state),
        indices(draw_indices),
        draw(of),
        vertex_batches(*of.vertex,
                       {.textures = of.vertex_textures,
                        .profile = pass.profile,
                        .budget = of.budget,
                        .lanes = of.lanes,
                        .uniforms = of.vertex_uniforms},
                       pass.isa),
        fragment_batches(*of.fragment,
                         {.textures = of.fragment_textures,
                          .profile = pass.profile,
                          .budget = of.budget,
                          .lanes = of.lanes,
                          .y_is_up = of.clip_space == ShaderClipSpace::y_up,
                          .uniforms = of.fragment_uniforms},
                         pass.isa),
        positions(vertex_count),
        chunks(chunk_count) {
    const Rectangle target = target_area(targets);
    clip = state.scissor ? intersection(target, *state.scissor) : target;
    viewport = draw.viewport.value_or(target);
    if (draw.viewport) clip = intersection(clip, viewport);
    width = target.x_end;
    height = target.y_end;
    if (draw.texel.most_w) interpolated.push_back(~std::size_t{0});
    std::vector<Interpolation> of_each(interpolated.size(), Interpolation::perspective);
    for (const ShaderProgram::Input& input : of.fragment->inputs) {
      if (input.input.uniform >= 0) continue;
      inputs.push_back(input_of(input.input, of_each));
    }
    kinds.resize(std::max<std::size_t>(1, (of_each.size() + kGroup - 1) / kGroup));
    for (GroupKinds& group : kinds) group.fill(Interpolation::flat);
    for (std::size_t i = 0; i < of_each.size(); ++i) kinds[i / kGroup][i % kGroup] = of_each[i];
    values.resize(varyings.size() * vertex_count);
    find_outputs();
  }

  FragmentInput input_of(const ShaderInput& input, std::vector<Interpolation>& of_each) {
    using enum FragmentInput::From;
    if (input.builtin >= 0) {
      return {builtin, 0, static_cast<SpirvBuiltin>(input.builtin), input.part};
    }
    const auto same =
        std::find_if(varyings.begin(), varyings.end(), [&](const ShaderVarying& varying) {
          return varying.location == input.location && varying.component == input.component;
        });
    const auto value = static_cast<std::size_t>(same - varyings.begin());
    if (same == varyings.end()) {
      varyings.push_back({input.location, input.component});
      if (varyings.size() > kMostShaderVaryings) {
        throw ShaderError("the shaders exchange more than " + std::to_string(kMostShaderVaryings) +
                          " numbers");
      }
    }
    if (input.is_flat || input.is_whole) return {vertex, value};
    interpolated.push_back(value);
    of_each.push_back(input.is_linear ? Interpolation::linear : Interpolation::perspective);
    return {FragmentInput::From::pipeline, of_each.size() - 1};
  }

  void find_outputs() {
    for (const ShaderProgram::Output& output : draw.fragment->outputs) {
      const ShaderOutput& of = output.output;
      if (of.builtin == static_cast<int>(SpirvBuiltin::frag_depth)) depth_output = output.from;
      if (of.builtin >= 0 || of.location >= kMaxColourTargets || of.component >= 4) continue;
      const auto location = static_cast<std::size_t>(of.location);
      outputs[location][static_cast<std::size_t>(of.component)] = output.from;
      has_output[location] = true;
    }
    if (draw.texel.colour || draw.texel.most_w || draw.texel.opacity) has_output[0] = true;
    tests_come_last = depth_output.is_there || draw.fragment->killed.is_there ||
                      (state.alpha_to_coverage && targets.samples > 1);
  }
};

// --- vertices and triangles ---

void shade_vertices(ShadersRecorded& draw, std::uint32_t begin, std::uint32_t end) {
  VertexRun run{.vertex_count = end,
                .attributes = draw.draw.attributes,
                .varyings = draw.varyings,
                .positions = draw.positions,
                .values = draw.values};
  std::unique_ptr<BatchMemory> memory = draw.vertex_memory.take();
  run_vertices(draw.vertex_batches, run, begin, end, *memory);
  draw.vertex_memory.put_back(std::move(memory));
  if (draw.draw.clip_space == ShaderClipSpace::y_down) return;
  for (std::uint32_t i = begin; i < end; ++i) draw.positions[i].y = -draw.positions[i].y;
}

std::array<VertexOutput<kGroup>, 3> corners_of(const ShadersRecorded& draw, std::size_t triangle,
                                               std::size_t group) {
  std::array<VertexOutput<kGroup>, 3> corners{};
  const std::size_t first = group * kGroup;
  const std::size_t end = std::min(first + kGroup, draw.interpolated.size());
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t vertex = draw.indices[3 * triangle + i];
    corners[i].position = draw.positions[vertex];
    for (std::size_t k = first; k < end; ++k) {
      const std::size_t value = draw.interpolated[k];
      corners[i].varyings[k - first] =
          value == ~std::size_t{0}
              ? corners[i].position.w
              : std::bit_cast<float>(draw.values[vertex * draw.varyings.size() + value]);
    }
  }
  return corners;
}

void assemble_triangle(const ShadersRecorded& draw, ShaderChunk& chunk, std::size_t triangle,
                       bool cull_unsnapped) {
  using Window = std::array<WindowVertex, 3>;
  const auto each = [&](std::size_t group, const auto& add) {
    to_window_triangles(corners_of(draw, triangle, group), draw.kinds[group],
                        draw.state.provoking_vertex, draw.viewport, draw.profile, add);
  };
  const std::size_t before = chunk.first.triangles.size();
  std::array<bool, ClipPolygon{}.vertices.size()> is_drawn{};
  std::size_t number = 0;
  each(0, [&](const Window& window, const Corners& varyings) {
    const std::size_t count = chunk.first.triangles.size();
    draw_detail::add_triangle(draw, chunk.first, window, varyings, cull_unsnapped);
    is_drawn[number++] = chunk.first.triangles.size() > count;
  });
  const std::size_t after = chunk.first.triangles.size();
  chunk.numbers.resize(after, static_cast<std::uint32_t>(triangle));
  const std::size_t others = draw.kinds.size() - 1;
  chunk.more.resize(after * others);
  for (std::size_t group = 1; group <= others && after > before; ++group) {
    std::size_t to = before;
    number = 0;
    each(group, [&](const Window&, const Corners& varyings) {
      if (is_drawn[number++]) chunk.more[to++ * others + group - 1] = varyings;
    });
  }
}

void assemble(ShadersRecorded& draw, std::uint32_t number) {
  ShaderChunk& chunk = draw.chunks[number];
  const std::size_t chunk_begin = std::size_t{number} * kChunkTriangles;
  const std::size_t chunk_end = std::min(chunk_begin + kChunkTriangles, draw.indices.size() / 3);
  for (std::size_t begin = chunk_begin; begin < chunk_end; begin += kBatchTriangles) {
    const std::size_t end = std::min(begin + kBatchTriangles, chunk_end);
    const bool cull_unsnapped = draw_detail::culls_unsnapped(
        draw, begin, end, [&](std::uint32_t i) { return draw.positions[i]; });
    for (std::size_t t = begin; t < end; ++t) assemble_triangle(draw, chunk, t, cull_unsnapped);
  }
  draw_detail::sort_bins(chunk.first.bins);
}

// --- fragments ---

/// The fragments of a tile, in the order of submission, shaded in batches.
class FragmentBatches {
 public:
  FragmentBatches(const ShadersRecorded& draw, FragmentMemory& memory)
      : draw_(draw),
        memory_(memory),
        lanes_(static_cast<std::size_t>(draw.fragment_batches.lanes())) {
    memory_.fragments.clear();
    memory_.inputs.resize(draw.inputs.size() * lanes_);
    memory_.w.resize(lanes_);
  }

  template <class Interpolator>
  void add(const ShaderChunk& chunk, std::uint32_t number, const Rectangle& tile) {
    const std::size_t others = draw_.kinds.size() - 1;
    const Triangle<kGroup>& triangle = chunk.first.triangles[number];
    // Other groups are set up with the same triangle.
    std::vector<Triangle<kGroup>> more_triangles;
    std::vector<Interpolator> more;
    more_triangles.reserve(others);
    more.reserve(others);
    for (std::size_t i = 0; i < others; ++i) {
      more_triangles.push_back(
          {triangle.setup, chunk.more[number * others + i], triangle.provoking});
      more.emplace_back(more_triangles.back(), draw_.profile, draw_.kinds[i + 1]);
    }
    const Interpolator first{triangle, draw_.profile, draw_.kinds[0]};
    const Shading<Interpolator> shading{first, more, triangle.setup.front_facing,
                                        chunk.numbers[number]};
    const Rectangle area = intersection(tile, triangle.setup.bounds);
    if (draw_.draw.fragment->has_derivatives) {
      add_blocks(shading, triangle.setup, area);
      return;
    }
    for (int y = area.y_begin; y < area.y_end; ++y) {
      const draw_detail::SampleSpans spans{triangle.setup, draw_.targets.samples, y, area};
      for (int x = spans.all.x_begin; x < spans.all.x_end; ++x) {
        const draw_detail::Samples covered = spans.covered(x);
        if (covered != 0) add_one(shading, x, y, covered);
      }
    }
  }

  void flush() {
    if (memory_.fragments.empty()) return;
    const std::size_t count = memory_.fragments.size();
    // What is behind the last fragment does as the last block, or pixel, does.
    const std::size_t together = draw_.draw.fragment->has_derivatives ? 4 : 1;
    std::size_t input = 0;
    draw_.fragment_batches.run(
        memory_.registers, [&](const ShaderInput&, std::span<std::uint32_t> to) {
          const std::uint32_t* from = memory_.inputs.data() + input++ * lanes_;
          std::copy_n(from, count, to.begin());
          for (std::size_t i = count; i < lanes_; ++i) to[i] = to[i - together];
        });
    for (std::size_t lane = 0; lane < count; ++lane) merge(lane);
    memory_.fragments.clear();
  }

 private:
  const ShadersRecorded& draw_;
  FragmentMemory& memory_;
  std::size_t lanes_;

  template <class Interpolator>
  struct Shading {
    const Interpolator& first;
    const std::vector<Interpolator>& more;
    bool front_facing;
    std::uint32_t number;
  };

  template <class Interpolator>
  void add_blocks(const Shading<Interpolator>& shading, const TriangleSetup& setup,
                  const Rectangle& area) {
    for (int y = area.y_begin & ~1; y < area.y_end; y += 2) {
      std::array<draw_detail::SampleSpans, 2> spans;
      Span both{area.x_end, area.x_begin};
      for (int row = 0; row < 2; ++row) {
        if (y + row < area.y_begin || y + row >= area.y_end) continue;
        draw_detail::SampleSpans& own = spans[static_cast<std::size_t>(row)];
        own = {setup, draw_.targets.samples, y + row, area};
        if (own.all.x_begin >= own.all.x_end) continue;
        both = {std::min(both.x_begin, own.all.x_begin), std::max(both.x_end, own.all.x_end)};
      }
      for (int x = both.x_begin & ~1; x < both.x_end; x += 2) {
        const std::array covered{spans[0].covered(x), spans[0].covered(x + 1), spans[1].covered(x),
                                 spans[1].covered(x + 1)};
        if ((covered[0] | covered[1] | covered[2] | covered[3]) == 0) continue;
        add_block(shading, x, y, covered);
      }
    }
  }

  template <class Interpolator>
  void add_block(const Shading<Interpolator>& shading, int x, int y,
                 const std::array<draw_detail::Samples, 4>& covered) {
    const std::size_t before = memory_.fragments.size();
    for (int i = 0; i < 4; ++i) {
      put(shading, x + (i & 1), y + (i >> 1), covered[static_cast<std::size_t>(i)]);
    }
    bool any = false;
    for (std::size_t i = before; i < before + 4; ++i) {
      any = any || memory_.fragments[i].covered != 0;
    }
    if (!any) memory_.fragments.resize(before);
    if (memory_.fragments.size() == lanes_) flush();
  }

  template <class Interpolator>
  void add_one(const Shading<Interpolator>& shading, int x, int y, draw_detail::Samples covered) {
    put(shading, x, y, covered);
    if (memory_.fragments.back().covered == 0) memory_.fragments.pop_back();
    if (memory_.fragments.size() == lanes_) flush();
  }

  /// Puts a fragment behind those that wait. It counts as not covered if it fails the tests, where
  /// these come before the shader.
  template <class Interpolator>
  void put(const Shading<Interpolator>& shading, int x, int y, draw_detail::Samples covered) {
    const auto pixel = shading.first.pixel(x, y);
    const auto depth_at = [&](const auto& at) {
      return draw_detail::clamped_depth(shading.first.depth(at), draw_.profile);
    };
    const std::size_t lane = memory_.fragments.size();
    Waiting& fragment = memory_.fragments.emplace_back(
        Waiting{x, y, depth_at(pixel), {}, shading.front_facing, covered});
    const std::span<const glm::ivec2> places = sample_places(draw_.targets.samples);
    for (std::size_t s = 0; s < places.size(); ++s) {
      fragment.depths[s] =
          places.size() == 1 ? fragment.depth : depth_at(shading.first.pixel(x, y, places[s]));
    }
    if (!draw_.tests_come_last) fragment.covered = tested(fragment);
    for (std::size_t i = 0; i < draw_.inputs.size(); ++i) {
      memory_.inputs[i * lanes_ + lane] = input(shading, pixel, i, memory_.fragments.back());
    }
    if (draw_.draw.texel.most_w) memory_.w[lane] = shading.first.varying(pixel, kPositionVarying);
  }

  /// Those of its samples that pass.
  draw_detail::Samples tested(const Waiting& fragment) const {
    const int count = draw_.targets.samples;
    draw_detail::Samples passing = 0;
    for (int s = 0; s < count; ++s) {
      if (draw_detail::has_sample(fragment.covered, s) &&
          draw_detail::passes_tests(draw_, fragment.x, fragment.y * count + s,
                                    fragment.depths[static_cast<std::size_t>(s)],
                                    fragment.front_facing)) {
        passing |= 1u << s;
      }
    }
    return passing;
  }

  template <class Interpolator, class Pixel>
  std::uint32_t input(const Shading<Interpolator>& shading, const Pixel& pixel, std::size_t number,
                      const Waiting& fragment) const {
    const FragmentInput& of = draw_.inputs[number];
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    switch (of.from) {
      case FragmentInput::From::pipeline: {
        if (of.number < kGroup) return bits(shading.first.varying(pixel, of.number));
        const Interpolator& from = shading.more[of.number / kGroup - 1];
        return bits(from.varying(from.pixel(fragment.x, fragment.y), of.number % kGroup));
      }
      case FragmentInput::From::vertex: {
        const std::uint32_t vertex =
            draw_.indices[3 * std::size_t{shading.number} + provoking_index(draw_.state)];
        return draw_.values[vertex * draw_.varyings.size() + of.number];
      }
      case FragmentInput::From::builtin: break;
    }
    switch (of.builtin) {
      case SpirvBuiltin::frag_coord: {
        if (of.part == 0) return bits(static_cast<float>(fragment.x) + 0.5f);
        if (of.part == 2) return bits(fragment.depth);
        if (of.part == 3) return bits(pixel.inverse_w);
        const bool is_up = draw_.draw.clip_space == ShaderClipSpace::y_up;
        const int row = is_up ? draw_.height - 1 - fragment.y : fragment.y;
        return bits(static_cast<float>(row) + 0.5f);
      }
      case SpirvBuiltin::front_facing: return fragment.front_facing ? ~0u : 0u;
      case SpirvBuiltin::primitive_id: return shading.number;
      case SpirvBuiltin::helper_invocation: return fragment.covered != 0 ? 0u : ~0u;
      default: return 0;
    }
  }

  std::uint32_t number_of(const ShaderRegister& of, std::size_t lane) const {
    std::uint32_t bits = 0;
    if (!of.is_there) return bits;
    const std::byte* at = draw_.fragment_batches.place(memory_.registers, of);
    std::memcpy(&bits, at + (of.varies ? 4 * lane : 0), sizeof bits);
    return bits;
  }

  glm::vec4 colour_of(std::size_t target, std::size_t lane) const {
    glm::vec4 colour{};
    for (std::size_t i = 0; i < 4; ++i) {
      colour[static_cast<int>(i)] = std::bit_cast<float>(number_of(draw_.outputs[target][i], lane));
    }
    if (target != 0) return colour;
    const ShaderTexel& texel = draw_.draw.texel;
    if (texel.colour) colour = {*texel.colour, colour.w};
    if (texel.opacity) colour = {glm::vec3{colour} * *texel.opacity, *texel.opacity};
    if (texel.most_w) colour.w = memory_.w[lane] < *texel.most_w ? memory_.w[lane] : *texel.most_w;
    return colour;
  }

  void merge(std::size_t lane) const {
    Waiting fragment = memory_.fragments[lane];
    if (fragment.covered == 0) return;
    const int count = draw_.targets.samples;
    if (draw_.tests_come_last) {
      if (number_of(draw_.draw.fragment->killed, lane) != 0) return;
      if (draw_.depth_output.is_there) {
        const float written = std::bit_cast<float>(number_of(draw_.depth_output, lane));
        fragment.depth = written <= 1.0f ? std::max(written, 0.0f) : 1.0f;
        fragment.depths.fill(fragment.depth);
      }
      if (draw_.state.alpha_to_coverage && count > 1) {
        fragment.covered &= draw_detail::alpha_coverage(colour_of(0, lane).w, count);
      }
      fragment.covered = tested(fragment);
      if (fragment.covered == 0) return;
    }
    const int x = fragment.x, y = fragment.y;
    if (has_layers(draw_.targets)) {
      // Fragments of the batch may have come into its place since it was tested.
      if (!reaches_layers(draw_.targets, x, y, fragment.depth)) return;
      insert_into_layers(draw_.targets, x, y, fragment.depth, colour_of(0, lane), draw_.profile);
      return;
    }
    for (std::size_t i = 0; i < kMaxColourTargets; ++i) {
      if (draw_.targets.colour[i] == nullptr || !draw_.has_output[i]) continue;
      for (int s = 0; s < count; ++s) {
        if (!draw_detail::has_sample(fragment.covered, s)) continue;
        write_colour(draw_.state.colour[i], *draw_.targets.colour[i], x, y * count + s,
                     colour_of(i, lane), draw_.profile);
      }
    }
  }
};

template <class Interpolator>
void shade_listed(const ShadersRecorded& draw, const ShaderChunk& chunk, std::span<const Bin> bins,
                  const Rectangle& tile) {
  std::unique_ptr<FragmentMemory> memory = draw.fragment_memory.take();
  FragmentBatches batches{draw, *memory};
  for (const Bin& bin : bins) batches.add<Interpolator>(chunk, bin.triangle, tile);
  batches.flush();
  draw.fragment_memory.put_back(std::move(memory));
}

void shade_shaders_tile(const ShadersRecorded& draw, const ShaderChunk& chunk,
                        std::span<const Bin> bins, const Rectangle& tile) {
  switch (draw.profile.attributes) {
    case AttributeSetup::exact_barycentric:
      return shade_listed<BarycentricInterpolator<kGroup>>(draw, chunk, bins, tile);
    case AttributeSetup::planes_from_origin:
      return shade_listed<PlaneInterpolator<PlanesFromOrigin, kGroup>>(draw, chunk, bins, tile);
    case AttributeSetup::planes_by_quad:
      return shade_listed<PlaneInterpolator<PlanesByQuad, kGroup>>(draw, chunk, bins, tile);
  }
}

constexpr ScalarSteps kShaderSteps{
    [](void* recorded, std::uint32_t begin, std::uint32_t end) {
      shade_vertices(*static_cast<ShadersRecorded*>(recorded), begin, end);
    },
    [](void* recorded, std::uint32_t chunk) {
      assemble(*static_cast<ShadersRecorded*>(recorded), chunk);
    },
    [](const void* recorded, std::uint32_t chunk) {
      return std::span<const Bin>{
          static_cast<const ShadersRecorded*>(recorded)->chunks[chunk].first.bins};
    },
    [](const void* recorded, std::uint32_t chunk, std::span<const Bin> bins,
       const Rectangle& tile) {
      const auto& draw = *static_cast<const ShadersRecorded*>(recorded);
      shade_shaders_tile(draw, draw.chunks[chunk], bins, tile);
    }};

}  // namespace

void draw_shaders(RenderPass& pass, const DrawState& state, std::span<const std::uint32_t> indices,
                  std::uint32_t vertex_count, const ShaderDraw& draw) {
  assert(indices.size() % 3 == 0);
  assert(pass.profile.coverage == Coverage::edge_functions ||
         pass.profile.attributes != AttributeSetup::exact_barycentric);
  assert(!has_layers(pass.targets) || can_peel(pass.targets, state));
  const auto triangles = static_cast<std::uint32_t>(indices.size() / 3);
  const std::uint32_t chunks = (triangles + kChunkTriangles - 1) / kChunkTriangles;
  DrawCall call;
  call.vertex_count = vertex_count;
  call.chunk_count = chunks;
  call.recorded =
      std::make_shared<ShadersRecorded>(pass, state, indices, vertex_count, chunks, draw);
  call.scalar_steps = &kShaderSteps;
  pass.draws.push_back(std::move(call));
}

}  // namespace softfocus
