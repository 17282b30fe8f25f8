// The stages of velocity, scalar and in lanes.

#ifndef SOFTFOCUS_ISA

#include "scenes/draw/velocity.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstring>

#include "raster/numbers/fixed_point.h"
#include "raster/numbers/half.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/lanes/draw_in_lanes.h"
#include "scenes/draw/draw_scene.h"

namespace softfocus {

/// Places of the varyings: clip x, y and w at both instants, then u and v.
inline constexpr std::size_t kMotionTo = 0, kMotionFrom = 3, kMotionUv = 6;

template <bool may_be_holed>
struct VelocityVertexStage {
  static constexpr std::size_t kVaryings = may_be_holed ? 8 : 6;
  VelocityInput input;
  bool holed = may_be_holed;

  VertexOutput<kVaryings> operator()(std::uint32_t index) const {
    const glm::vec3 position = input.mesh->positions[index];
    VertexOutput<kVaryings> output{transform_point(input.shown, position), {}};
    const glm::vec4 to = transform_point(input.to, position);
    const glm::vec4 from = transform_point(input.from, position);
    output.varyings[kMotionTo] = to.x;
    output.varyings[kMotionTo + 1] = to.y;
    output.varyings[kMotionTo + 2] = to.w;
    output.varyings[kMotionFrom] = from.x;
    output.varyings[kMotionFrom + 1] = from.y;
    output.varyings[kMotionFrom + 2] = from.w;
    if (may_be_holed && holed) {
      output.varyings[kMotionUv] = input.mesh->uvs[index].x;
      output.varyings[kMotionUv + 1] = input.mesh->uvs[index].y;
    }
    return output;
  }
};

template <bool may_be_holed>
struct VelocityFragmentStage {
  static constexpr std::size_t kVaryings = VelocityVertexStage<may_be_holed>::kVaryings;
  static constexpr bool kDiscards = may_be_holed;
  static constexpr bool kNeedsDerivatives = may_be_holed;
  static constexpr std::array<Interpolation, kVaryings> kInterpolation{};  // perspective

  glm::vec2 half_size_px;
  float least_w;
  Profile profile;
  SurfaceOpacity opacity;
  const DecodedTexture* decoded_opacity = nullptr;  ///< for the form in lanes

  bool discards() const { return opacity.texture != nullptr; }
  std::size_t varying_count() const { return discards() ? kVaryings : kMotionUv; }

  FragmentOutput<1> operator()(const Fragment<kVaryings>& in) const {
    if constexpr (may_be_holed) {
      const std::size_t u = kMotionUv, v = kMotionUv + 1;
      const float lod = level_of_detail(*opacity.texture, {in.ddx[u], in.ddx[v]},
                                        {in.ddy[u], in.ddy[v]}, profile);
      const glm::vec4 texel =
          sample(*opacity.texture, opacity.sampler, {in.varyings[u], in.varyings[v]}, lod, profile);
      if (texel.x < least_texel(opacity)) return {{}, true};
    }
    const auto clip = [&](std::size_t at) {
      return glm::vec3{in.varyings[at], in.varyings[at + 1], in.varyings[at + 2]};
    };
    return {{glm::vec4{motion_px(clip(kMotionTo), clip(kMotionFrom), half_size_px, least_w), 0.0f,
                       1.0f}},
            false};
  }
};

}  // namespace softfocus

#define SOFTFOCUS_KERNELS "scenes/draw/velocity.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {
namespace {

/// Over the whole picture, at z = 0.
const Mesh& picture_triangle() {
  static const Mesh mesh{{{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}}, {}, {}, {0, 1, 2}};
  return mesh;
}

/// From eye space to another camera's.
glm::dmat4 eye_to_eye(const CameraMatrices& from, const CameraMatrices& to) {
  glm::dmat4 to_world{1.0};  // the inverse of a turn and a move
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) to_world[i][j] = from.world_to_eye[j][i];
  }
  const glm::dvec3 moved{from.world_to_eye[3]};
  for (int j = 0; j < 3; ++j) to_world[3][j] = -dot(glm::dvec3{from.world_to_eye[j]}, moved);
  return multiply(to.world_to_eye, to_world);
}

/// The pixels of `shown` as `by` sees them.
PixelsToClip seen_by(const CameraMatrices& by, const CameraMatrices& shown) {
  if (by.world_to_eye == shown.world_to_eye && by.eye_to_clip == shown.eye_to_clip) return {};
  // The point at (x, y) and a depth of 1, which is clip w.
  const glm::dmat4& p = shown.eye_to_clip;
  glm::dmat4 to_eye{0.0};
  to_eye[0][0] = 1.0 / p[0][0];
  to_eye[1][1] = 1.0 / p[1][1];
  to_eye[2] = {p[2][0] / p[0][0], p[2][1] / p[1][1], -1.0, 0.0};
  to_eye[3][3] = 1.0;
  const glm::dmat4 clip = multiply(by.eye_to_clip, multiply(eye_to_eye(shown, by), to_eye));
  PixelsToClip seen;
  for (int i = 0; i < 4; ++i) {
    const glm::vec3 column{clip[i].x, clip[i].y, clip[i].w};
    (i < 3 ? seen.turn[i] : seen.shift) = column;
  }
  return seen;
}

/// From a pixel's x and y to clip space, for points at infinity.
glm::mat4 at_infinity(const PixelsToClip& seen) {
  const auto column = [&](int i) {
    return glm::vec4{seen.turn[i].x, seen.turn[i].y, 0.0f, seen.turn[i].z};
  };
  return {column(0), column(1), glm::vec4{0.0f}, column(2)};
}

glm::vec2 half_size_px(const MotionSpan& span, int width, int height) {
  return {static_cast<float>(0.5 * width * span.factor),
          static_cast<float>(0.5 * height * span.factor)};
}

VelocityDraw background_draw(const Scene& scene, const Instant& shown, const MotionSpan& span,
                             int width, int height) {
  VelocityDraw draw{};
  draw.state.cull = Cull::none;
  draw.state.depth = DepthState{Compare::always, false};
  glm::mat4 far{1.0f};
  far[2][2] = 0.0f;
  far[3][2] = 1.0f;  // z = w
  draw.input = {&picture_triangle(),
                far,
                at_infinity(seen_by(span.to.camera, shown.camera)),
                at_infinity(seen_by(span.from.camera, shown.camera)),
                half_size_px(span, width, height),
                static_cast<float>(scene.camera.near_m / scene.camera.far_m)};
  return draw;
}

using VelocityLaneStages = LaneStages<VelocityVertexStage<true>, VelocityFragmentStage<true>>;

std::uint32_t vertex_count(const VelocityDraw& what) {
  return static_cast<std::uint32_t>(what.input.mesh->positions.size());
}

template <bool holed>
VelocityFragmentStage<holed> fragment_stage_of(const VelocityDraw& what, const Profile& profile) {
  return {what.input.half_size_px, what.input.least_w, profile, what.opacity, nullptr};
}

template <bool holed>
void draw_slowly(const VelocityDraw& what, RenderPass& pass) {
  draw(pass, what.state, what.input.mesh->indices, vertex_count(what),
       VelocityVertexStage<holed>{what.input}, fragment_stage_of<holed>(what, pass.profile));
}

void record_velocity(const PreparedScene& prepared, const VelocityDraw& what, RenderPass& pass) {
  const bool holed = what.opacity.texture != nullptr;
  if (!can_draw_in_lanes(pass, what.state)) {
    return holed ? draw_slowly<true>(what, pass) : draw_slowly<false>(what, pass);
  }
  auto fragment_stage = fragment_stage_of<true>(what, pass.profile);
  VelocityLaneStages stages{SOFTFOCUS_KERNEL(pass.isa, place_velocity_vertices),
                            SOFTFOCUS_KERNEL(pass.isa, shade_velocity_vertices),
                            SOFTFOCUS_KERNEL(pass.isa, shade_velocity_fragments)};
  if (holed) {
    const auto number = what.opacity.texture - prepared.scene->textures.data();
    fragment_stage.decoded_opacity = &prepared.textures[static_cast<std::size_t>(number)];
    stages.keep_fragments = SOFTFOCUS_KERNEL(pass.isa, keep_velocity_fragments);
  }
  draw_in_lanes(pass, what.state, what.input.mesh->indices, vertex_count(what),
                VelocityVertexStage<true>{what.input, holed}, fragment_stage, stages);
}

}  // namespace

Instant instant_at(const Scene& scene, double frame, int width, int height) {
  return {camera_matrices(scene.camera, frame, width, height), frame};
}

CameraMotion camera_motion(const Scene& scene, const CameraMatrices& shown, const MotionSpan& span,
                           int width, int height) {
  // As alpha has it, or a step before: halves are rounded in several ways.
  const float far_m = alpha_depth(static_cast<float>(scene.camera.far_m));
  return {seen_by(span.to.camera, shown), seen_by(span.from.camera, shown),
          half_size_px(span, width, height), static_cast<float>(scene.camera.near_m),
          half_to_float(float_to_half(far_m, HalfRounding::toward_zero))};
}

std::vector<VelocityDraw> velocity_draws(const Scene& scene, const Instant& shown,
                                         const MotionSpan& span, int width, int height) {
  const auto surfaces_at = [&](const Instant& instant) {
    return surface_draws(scene, instant.camera, instant.frame);
  };
  const std::vector<SurfaceDraw> seen = surfaces_at(shown);
  const std::vector<SurfaceDraw> before = surfaces_at(span.from), after = surfaces_at(span.to);
  std::vector<VelocityDraw> draws{background_draw(scene, shown, span, width, height)};
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].opacity.blends) continue;
    const SurfaceVertexInput& input = seen[i].input;
    draws.push_back({seen[i].state,
                     {input.mesh, input.to_clip, after[i].input.to_clip, before[i].input.to_clip,
                      half_size_px(span, width, height), static_cast<float>(scene.camera.near_m)},
                     input.material,
                     seen[i].opacity});
  }
  return draws;
}

void draw_velocity(PreparedScene& prepared, const Instant& shown, const MotionSpan& span,
                   Image& velocity, ThreadPool& pool) {
  assert(velocity.format == Format::rg16f);
  const int width = velocity.width, height = velocity.height;
  RenderPass pass;
  pass.profile = prepared.pass.profile;
  pass.isa = prepared.pass.isa;
  Image depth = make_image(Format::r32f, width, height);
  Image wide = make_image(Format::rgba16f, width, height);
  pass.targets.depth = &depth;
  pass.targets.colour[0] = &wide;
  pass.clear_colour = glm::vec4{0.0f};
  pass.clear_depth = 1.0f;
  pass.keep_depth = false;
  // The kernels write four channels; the other form writes two.
  const bool in_lanes = can_draw_in_lanes(pass, DrawState{});
  if (!in_lanes) pass.targets.colour[0] = &velocity;
  const std::vector<VelocityDraw> draws =
      velocity_draws(*prepared.scene, shown, span, width, height);
  for (const VelocityDraw& what : draws) {
    record_velocity(prepared, what, pass);
  }
  finish(pass, pool);
  if (!in_lanes) return;
  pool.for_each(height, [&](int y) {
    const std::uint16_t* from = row<std::uint16_t>(wide, y).data();
    std::uint16_t* to = row<std::uint16_t>(velocity, y).data();
    for (int x = 0; x < width; ++x) std::memcpy(to + 2 * x, from + 4 * x, 2 * sizeof *to);
  });
}

Image draw_velocity(const Scene& scene, const Instant& shown, const MotionSpan& span, int width,
                    int height, const Profile& profile, ThreadPool& pool) {
  PreparedScene prepared = prepare_surfaces(scene, profile, pool);
  Image velocity = make_image(Format::rg16f, width, height);
  draw_velocity(prepared, shown, span, velocity, pool);
  return velocity;
}

Image velocity_for(const ChosenEffect& chosen, const Scene& scene, double frame,
                   const Image& picture, const Profile& profile, ThreadPool& pool) {
  const int width = picture.width, height = picture.height;
  const double shutter = chosen.parameters[0];
  if (!(shutter > 0.0)) return make_image(Format::rg16f, width, height);
  const Instant shown = instant_at(scene, frame, width, height);
  const MotionSpan span{instant_at(scene, frame - 0.5 * shutter, width, height),
                        instant_at(scene, frame + 0.5 * shutter, width, height), 1.0 / shutter};
  if (chosen.effect->velocity == VelocityOf::all) {
    return draw_velocity(scene, shown, span, width, height, profile, pool);
  }
  Image velocity = make_image(Format::rg16f, width, height);
  camera_velocity(camera_motion(scene, shown.camera, span, width, height), picture, velocity,
                  profile, pool);
  return velocity;
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

#include "raster/effects/motion/motion_lanes.inl"
#include "raster/images/sample_lanes.inl"
#include "raster/lanes/vector_math_lanes.inl"
#include "raster/pipeline/lanes/block_lanes.inl"
#include "raster/pipeline/lanes/edge_lanes.inl"
#include "raster/pipeline/lanes/interpolate_lanes.inl"
#include "raster/pipeline/lanes/shade_lanes.inl"
#include "raster/pipeline/lanes/vertex_lanes.inl"
#include "scenes/surfaces/opacity_lanes.inl"

namespace {

/// A row of a matrix times points.
SOFTFOCUS_INLINE Floats transformed(const glm::mat4& m, int part, const Vec3Lanes& p) {
  return ((m[0][part] * p.x + m[1][part] * p.y) + m[2][part] * p.z) + m[3][part];
}

struct VelocityVertexLanes {
  static constexpr std::size_t kVaryings = VelocityVertexStage<true>::kVaryings;
  const VelocityInput& input;
  bool holed;

  SOFTFOCUS_INLINE std::size_t varying_count() const { return holed ? kVaryings : kMotionUv; }

  SOFTFOCUS_INLINE void position(Ints index, std::array<Floats, 4>& in_clip_space) const {
    const Vec3Lanes p = load_vectors(input.mesh->positions, index);
    for (int i = 0; i < 4; ++i) {
      in_clip_space[static_cast<std::size_t>(i)] = transformed(input.shown, i, p);
    }
  }

  SOFTFOCUS_INLINE void operator()(Ints index, std::array<Floats, 4>& in_clip_space,
                                   std::array<Floats, kVaryings>& varyings) const {
    position(index, in_clip_space);
    const Vec3Lanes p = load_vectors(input.mesh->positions, index);
    varyings[kMotionTo] = transformed(input.to, 0, p);
    varyings[kMotionTo + 1] = transformed(input.to, 1, p);
    varyings[kMotionTo + 2] = transformed(input.to, 3, p);
    varyings[kMotionFrom] = transformed(input.from, 0, p);
    varyings[kMotionFrom + 1] = transformed(input.from, 1, p);
    varyings[kMotionFrom + 2] = transformed(input.from, 3, p);
    if (holed) {
      const float* first = &input.mesh->uvs[0].x;
      varyings[kMotionUv] = gather(first, index * 2, ~Mask{});
      varyings[kMotionUv + 1] = gather(first + 1, index * 2, ~Mask{});
    }
  }
};

/// Holes are cut out before.
struct VelocityFragmentLanes {
  static constexpr auto kInterpolation = VelocityFragmentStage<true>::kInterpolation;
  static constexpr std::size_t kInputs = 6;
  const VelocityFragmentStage<true>& stage;

  SOFTFOCUS_INLINE std::size_t varying_count() const { return kInputs; }

  template <class Quads, class Put>
  SOFTFOCUS_INLINE void inputs(const Quads& in, const Put& put) const {
    for (std::size_t i = 0; i < kInputs; ++i) put(i, in.varying(i));
  }

  SOFTFOCUS_INLINE void shade(const FragmentBatch<kInputs>& batch,
                              std::array<Floats, 4>* colours) const {
    const int count = batch.vectors();
    for (int i = 0; i < count; ++i) {
      const ClipLanes to{batch.input(kMotionTo, i), batch.input(kMotionTo + 1, i),
                         batch.input(kMotionTo + 2, i)};
      const ClipLanes from{batch.input(kMotionFrom, i), batch.input(kMotionFrom + 1, i),
                           batch.input(kMotionFrom + 2, i)};
      const MotionLanes moved = motion_px_lanes(to, from, stage.half_size_px, splat(stage.least_w));
      colours[i] = {moved.x, moved.y, splat(0.0f), splat(1.0f)};
    }
  }
};

struct VelocityHoles {
  static constexpr auto kInterpolation = VelocityFragmentStage<true>::kInterpolation;
  const VelocityFragmentStage<true>& stage;

  template <class Quads>
  SOFTFOCUS_INLINE Mask keeps(const Quads& in) const {
    const Floats red =
        opacity_texels(in, kMotionUv, *stage.decoded_opacity, stage.opacity.sampler, stage.profile);
    return ~(red < least_texel(stage.opacity));
  }
};

}  // namespace

unsigned place_velocity_vertices(const VelocityVertexStage<true>& stage, const VertexJob& job) {
  return place_vertices(VelocityVertexLanes{stage.input, stage.holed}, job);
}

void shade_velocity_vertices(const VelocityVertexStage<true>& stage, const VertexJob& job) {
  shade_vertices(VelocityVertexLanes{stage.input, stage.holed}, job);
}

void shade_velocity_fragments(const VelocityFragmentStage<true>& stage, const FragmentJob& job,
                              const VisibilityTile& tile, const VisibleRun& run) {
  shade_fragments(VelocityFragmentLanes{stage}, job, tile, run);
}

unsigned keep_velocity_fragments(const VelocityFragmentStage<true>& stage, const FragmentJob& job,
                                 const LaneTriangle& triangle, int x, int y, unsigned pixels) {
  return keep_fragments(VelocityHoles{stage}, job, triangle, x, y, pixels);
}

#endif
