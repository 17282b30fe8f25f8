// The places of a row's texels, scalar and in lanes.

#ifndef SOFTFOCUS_ISA

#include "scenes/relief/warp/pre_warp.h"

#include <cmath>

#include "raster/numbers/vector_math.h"

#define SOFTFOCUS_KERNELS "scenes/relief/warp/pre_warp.cpp"
#include "raster/lanes/for_each_isa.inl"

namespace softfocus {

namespace {

/// Where texels do not move, along one axis. Without a scale all move one way, as if towards a
/// point at infinity.
double epipole_of(double shift, double scale) {
  if (scale != 0.0) return shift / scale;
  return shift == 0.0 ? 0.0 : std::copysign(HUGE_VAL, shift);
}

}  // namespace

bool sees_front(const ReliefTexture& relief, glm::dvec3 eye) {
  return dot(relief.camera.origin - eye, relief.camera.f) >
         relief.camera.depth_m * kLeastShareBefore;
}

PreWarp pre_warp(const ReliefTexture& relief, glm::dvec3 eye) {
  const ReliefCamera& camera = relief.camera;
  const auto foot_of = [&](glm::dvec3 point, glm::dvec3 axis) {
    return -dot(camera.origin - point, axis) / dot(axis, axis);
  };
  PreWarp warp;
  warp.height_m = dot(camera.origin - eye, camera.f);
  warp.foot_u = warp.epipole_u = foot_of(eye, camera.a);
  warp.foot_v = warp.epipole_v = foot_of(eye, camera.b);
  double k1 = warp.foot_u / warp.height_m, k2 = warp.foot_v / warp.height_m;
  double k3 = 1.0 / warp.height_m;
  if (camera.eye) {
    warp.source_u = foot_of(*camera.eye, camera.a);
    warp.source_v = foot_of(*camera.eye, camera.b);
    warp.source_per_m = 1.0 / source_distance(camera);
    k1 -= warp.source_u * warp.source_per_m;
    k2 -= warp.source_v * warp.source_per_m;
    k3 -= warp.source_per_m;
    warp.epipole_u = epipole_of(k1, k3);
    warp.epipole_v = epipole_of(k2, k3);
    warp.outwards = k3 < 0.0;
  }
  warp.k1 = static_cast<float>(k1);
  warp.k2 = static_cast<float>(k2);
  warp.k3 = static_cast<float>(k3);
  warp.step_m = static_cast<float>(depth_step(relief));
  return warp;
}

WarpedPlace exact_place(const PreWarp& warp, double u, double v, double depth_m) {
  const DepthShares shares = shares_of(warp, depth_m);
  const double scale = 1.0 / (1.0 + shares.scale);
  return {(u + shares.u) * scale, (v + shares.v) * scale};
}

std::vector<WarpedDepth> warp_table(const PreWarp& warp, int depth_bits) {
  std::vector<WarpedDepth> table(static_cast<std::size_t>(last_depth(depth_bits)) + 1);
  for (std::size_t code = 0; code < table.size(); ++code) {
    table[code] = warped_depth(warp, static_cast<float>(code) * warp.step_m);
  }
  return table;
}

std::vector<FixedDepth> fixed_warp_table(const PreWarp& warp, int depth_bits) {
  std::vector<FixedDepth> table(static_cast<std::size_t>(last_depth(depth_bits)) + 1);
  // Past 2^21 texels a place leaves every texture anyway.
  const auto fixed = [](double value, double unit) {
    const double scaled = std::fmin(std::fmax(value * unit, -0x1p29), 0x1p29);
    return static_cast<std::int32_t>(std::lrint(scaled));
  };
  for (std::size_t code = 0; code < table.size(); ++code) {
    const double depth = static_cast<double>(code) * static_cast<double>(warp.step_m);
    const DepthShares shares = shares_of(warp, depth);
    table[code] = {fixed(shares.u, 256.0), fixed(shares.v, 256.0),
                   fixed(1.0 / (1.0 + shares.scale), 65536.0)};
  }
  return table;
}

void warp_row(const PreWarp& warp, const std::uint16_t* codes, int width, int v, float* along_u,
              float* along_v, Isa isa) {
  int u = 0;
  if (isa != Isa::scalar) {
    u = SOFTFOCUS_KERNEL(isa, warp_vectors)(warp, codes, width, v, along_u, along_v);
  }
  for (; u < width; ++u) {
    const WarpedDepth depth = warped_depth(warp, static_cast<float>(codes[u]) * warp.step_m);
    along_u[u] = (static_cast<float>(u) + depth.shift_u) * depth.scale;
    along_v[u] = (static_cast<float>(v) + depth.shift_v) * depth.scale;
  }
}

WarpedPlace pre_warp_oracle(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m) {
  const ReliefCamera& camera = relief.camera;
  const glm::dvec3 a = camera.a, b = camera.b, c = camera.origin - eye;
  const glm::dvec3 f =
      camera.eye ? (eye - *camera.eye) * (1.0 / source_distance(camera)) : camera.f;
  const double k1 = dot(f, cross(b, c)) / dot(a, cross(b, c));
  const double k2 = dot(f, cross(c, a)) / dot(b, cross(c, a));
  const double k3 = dot(f, cross(a, b)) / dot(c, cross(a, b));
  return {(u + k1 * depth_m) / (1.0 + k3 * depth_m), (v + k2 * depth_m) / (1.0 + k3 * depth_m)};
}

WarpedPlace projected_place(const ReliefTexture& relief, glm::dvec3 eye, double u, double v,
                            double depth_m) {
  const ReliefCamera& camera = relief.camera;
  const glm::dvec3 ray = point_at_depth(camera, u, v, depth_m) - eye;
  const double along = dot(camera.origin - eye, camera.f) / dot(ray, camera.f);
  const glm::dvec3 in_plane = (eye + ray * along) - camera.origin;
  return {dot(in_plane, camera.a) / dot(camera.a, camera.a),
          dot(in_plane, camera.b) / dot(camera.b, camera.b)};
}

}  // namespace softfocus

#else  // the kernels, once a vector unit

namespace {
using Codes [[gnu::vector_size(2 * SOFTFOCUS_LANES)]] = std::uint16_t;
}

/// Returns how many texels are done.
int warp_vectors(const PreWarp& warp, const std::uint16_t* codes, int width, int v, float* along_u,
                 float* along_v) {
  const Floats row = splat(static_cast<float>(v));
  int u = 0;
  for (; u + kLanes <= width; u += kLanes) {
    Codes some;
    std::memcpy(&some, codes + u, sizeof some);
    const Floats depth = __builtin_convertvector(some, Floats) * warp.step_m;
    const Floats scale = 1.0f / (1.0f + warp.k3 * depth);
    store(along_u + u, (to_floats(u + lane_numbers()) + warp.k1 * depth) * scale);
    store(along_v + u, (row + warp.k2 * depth) * scale);
  }
  return u;
}

#endif
