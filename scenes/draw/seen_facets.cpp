#ifndef SOFTFOCUS_ISA

#include "scenes/draw/seen_facets.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <numeric>
#include <utility>

#include "raster/images/texel.h"
#include "raster/numbers/fixed_point.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {

// A facet's number, from 1 on, in base 2048, for a half holds whole numbers up to there; and in
// alpha 1 if the triangle is seen from its front.
inline constexpr std::uint32_t kDigit = 2048;

struct NumberVertexStage {
  const NumberedMesh* mesh;
  glm::mat4 to_clip;

  VertexOutput<3> operator()(std::uint32_t index) const {
    const std::uint32_t number = 1 + mesh->first_facet + index / 3;
    const auto low = number % kDigit, middle = number / kDigit % kDigit,
               high = number / kDigit / kDigit;
    return {transform_point(to_clip, mesh->positions[index]),
            {static_cast<float>(low), static_cast<float>(middle), static_cast<float>(high)}};
  }
};

struct NumberFragmentStage {
  static constexpr bool kDiscards = false;
  static constexpr bool kNeedsDerivatives = false;
  static constexpr std::array<Interpolation, 3> kInterpolation{
      Interpolation::flat, Interpolation::flat, Interpolation::flat};

  FragmentOutput<1> operator()(const Fragment<3>& in) const {
    return {
        {glm::vec4{in.varyings[0], in.varyings[1], in.varyings[2], in.front_facing ? 1.0f : 0.0f}},
        false};
  }
};

// Cut-outs: a fragment is there if its opacity says so.
struct HoledNumberVertexStage {
  NumberVertexStage of_whole;

  VertexOutput<5> operator()(std::uint32_t index) const {
    const VertexOutput<3> whole = of_whole(index);
    const glm::vec2 uv = of_whole.mesh->uvs[index];
    return {whole.position, {whole.varyings[0], whole.varyings[1], whole.varyings[2], uv.x, uv.y}};
  }
};

struct HoledNumberFragmentStage {
  static constexpr bool kDiscards = true;
  static constexpr bool kNeedsDerivatives = true;
  static constexpr std::array<Interpolation, 5> kInterpolation{
      Interpolation::flat, Interpolation::flat, Interpolation::flat, Interpolation::perspective,
      Interpolation::perspective};
  SurfaceOpacity opacity;
  Profile profile;

  FragmentOutput<1> operator()(const Fragment<5>& in) const {
    const float lod =
        level_of_detail(*opacity.texture, {in.ddx[3], in.ddx[4]}, {in.ddy[3], in.ddy[4]}, profile);
    const glm::vec4 texel =
        sample(*opacity.texture, opacity.sampler, {in.varyings[3], in.varyings[4]}, lod, profile);
    if (texel.x < least_texel(opacity)) return {{}, true};
    return {
        {glm::vec4{in.varyings[0], in.varyings[1], in.varyings[2], in.front_facing ? 1.0f : 0.0f}},
        false};
  }
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/draw/seen_facets.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

using NumberLaneStages = LaneStages<NumberVertexStage, NumberFragmentStage>;

NumberLaneStages number_lane_stages(Isa isa) {
  return {SOFTFOCUS_KERNEL(isa, place_number_vertices),
          SOFTFOCUS_KERNEL(isa, shade_number_vertices),
          SOFTFOCUS_KERNEL(isa, shade_number_fragments)};
}

void record_numbers(const NumberedScene& numbered, const Scene& scene, const CameraMatrices& camera,
                    double frame, std::span<const std::uint8_t> hidden, RenderPass& pass) {
  const std::vector<SurfaceDraw> surfaces = surface_draws(scene, camera, frame);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const SurfaceDraw& surface = surfaces[i];
    if (surface.opacity.blends || (!hidden.empty() && hidden[i] != 0)) continue;
    const NumberedMesh& mesh = numbered.meshes[i];
    const auto corners = static_cast<std::uint32_t>(mesh.positions.size());
    const std::span indices = std::span{numbered.indices}.first(corners);
    const NumberVertexStage vertex_stage{&mesh, surface.input.to_clip};
    if (surface.variant.holed) {
      draw(pass, surface.state, indices, corners, HoledNumberVertexStage{vertex_stage},
           HoledNumberFragmentStage{surface.opacity, pass.profile});
    } else if (can_draw_in_lanes(pass, surface.state)) {
      draw_in_lanes(pass, surface.state, indices, corners, vertex_stage, NumberFragmentStage{},
                    number_lane_stages(pass.isa));
    } else {
      draw(pass, surface.state, indices, corners, vertex_stage, NumberFragmentStage{});
    }
  }
}

SeenFacet seen_facet(glm::vec4 texel) {
  const std::uint32_t number =
      static_cast<std::uint32_t>(texel.x) +
      kDigit * (static_cast<std::uint32_t>(texel.y) + kDigit * static_cast<std::uint32_t>(texel.z));
  if (number == 0) return 0;
  return 1 + 2 * (number - 1) + (texel.w > 0.0f ? 0u : 1u);
}

void set_images(std::vector<Image>& images, std::size_t count, Format format, int width,
                int height) {
  if (images.size() < count) images.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (images[i].width == width && images[i].height == height) continue;
    images[i] = make_image(format, width, height);
  }
}

}  // namespace

NumberedScene number_triangles(const Scene& scene, const Profile& profile, Isa isa) {
  NumberedScene numbered;
  numbered.pass.profile = profile;
  numbered.pass.isa = isa;
  std::uint32_t facet = 0;
  std::size_t most = 0;
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const Material& material = scene.materials[object.material];
    NumberedMesh own;
    own.first_facet = facet;
    for (const std::uint32_t index : mesh.indices) own.positions.push_back(mesh.positions[index]);
    if (material.opacity_texture && !mesh.uvs.empty()) {
      for (const std::uint32_t index : mesh.indices) own.uvs.push_back(mesh.uvs[index]);
    }
    facet += static_cast<std::uint32_t>(mesh.indices.size() / 3);
    most = std::max(most, mesh.indices.size());
    numbered.meshes.push_back(std::move(own));
  }
  numbered.indices.resize(most);
  std::iota(numbered.indices.begin(), numbered.indices.end(), 0u);
  return numbered;
}

std::vector<std::vector<SeenFacet>> draw_seen_facets(NumberedScene& numbered, const Scene& scene,
                                                     const CameraMatrices& camera, double frame,
                                                     int width, int height, std::size_t layers,
                                                     ThreadPool& pool,
                                                     std::optional<float> behind_before,
                                                     std::span<const std::uint8_t> hidden) {
  set_images(numbered.layers, layers, Format::rgba16f, width, height);
  set_images(numbered.depths, layers, Format::r32f, width, height);
  RenderPass& pass = numbered.pass;
  pass.targets.colour[0] = numbered.layers.data();
  pass.targets.depth = numbered.depths.data();
  pass.targets.behind = {};
  for (std::size_t i = 1; i < layers; ++i) {
    pass.targets.behind[i - 1] = {&numbered.layers[i], &numbered.depths[i]};
  }
  pass.clear_colour = glm::vec4{0.0f};
  pass.clear_depth = 1.0f;
  pass.behind_before = behind_before;
  pass.keep_depth = false;
  record_numbers(numbered, scene, camera, frame, hidden, pass);
  finish(pass, pool);

  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::vector<SeenFacet>> seen(layers);
  for (auto& of_layer : seen) of_layer.resize(columns * static_cast<std::size_t>(height));
  pool.for_each(height, [&](int y) {
    for (std::size_t i = 0; i < layers; ++i) {
      SeenFacet* to = seen[i].data() + columns * static_cast<std::size_t>(y);
      const std::span<const std::uint16_t> texels =
          row<std::uint16_t>(std::as_const(numbered.layers[i]), y);
      std::uint64_t last_bits = 0;
      SeenFacet last = 0;
      for (int x = 0; x < width; ++x) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, texels.data() + 4 * x, sizeof bits);
        if (bits != last_bits) {
          last_bits = bits;
          last = seen_facet(load_texel<Format::rgba16f>(numbered.layers[i], x, y));
        }
        to[x] = last;
      }
    }
  });
  return seen;
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

#include "raster/lanes/vector_math_lanes.inl"
#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"

namespace {

struct NumberVertexLanes {
  static constexpr std::size_t kVaryings = 3;
  const NumberVertexStage& stage;

  SOFTFOCUS_INLINE void position(Ints index, std::array<Floats, 4>& in_clip_space) const {
    const float* first = &stage.mesh->positions[0].x;
    const Ints at = index * 3;
    const Mask every = ~Mask{};
    const Floats x = gather(first, at, every);
    const Floats y = gather(first + 1, at, every);
    const Floats z = gather(first + 2, at, every);
    for (int i = 0; i < 4; ++i) {
      const glm::mat4& m = stage.to_clip;
      in_clip_space[static_cast<std::size_t>(i)] =
          ((m[0][i] * x + m[1][i] * y) + m[2][i] * z) + m[3][i];
    }
  }

  SOFTFOCUS_INLINE void operator()(Ints index, std::array<Floats, 4>& in_clip_space,
                                   std::array<Floats, kVaryings>& varyings) const {
    position(index, in_clip_space);
    const Ints number = index / 3 + static_cast<std::int32_t>(1 + stage.mesh->first_facet);
    constexpr auto kLast = static_cast<std::int32_t>(kDigit - 1);
    varyings[0] = to_floats(number & kLast);
    varyings[1] = to_floats(number >> 11 & kLast);
    varyings[2] = to_floats(number >> 22 & kLast);
  }
};

struct NumberFragmentLanes {
  static constexpr auto kInterpolation = NumberFragmentStage::kInterpolation;
  static constexpr std::size_t kInputs = 4;

  template <class Quads, class Put>
  SOFTFOCUS_INLINE void inputs(const Quads& in, const Put& put) const {
    put(0, in.varying(0));
    put(1, in.varying(1));
    put(2, in.varying(2));
    put(3, select(in.front_facing(), splat(1.0f), splat(0.0f)));
  }

  SOFTFOCUS_INLINE void shade(const FragmentBatch<kInputs>& batch,
                              std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    for (int i = 0; i < count; ++i) {
      colours[i] = {batch.input(0, i), batch.input(1, i), batch.input(2, i), batch.input(3, i)};
    }
  }
};

}  // namespace

unsigned place_number_vertices(const NumberVertexStage& stage, const VertexJob& job) {
  return place_vertices(NumberVertexLanes{stage}, job);
}

void shade_number_vertices(const NumberVertexStage& stage, const VertexJob& job) {
  shade_vertices(NumberVertexLanes{stage}, job);
}

void shade_number_fragments(const NumberFragmentStage&, const FragmentJob& job,
                            const VisibilityTile& tile, const VisibleRun& run) {
  shade_fragments(NumberFragmentLanes{}, job, tile, run);
}

#endif
