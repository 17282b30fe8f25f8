#include "scenes/relief/warp/resample.h"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "raster/numbers/vector_math.h"
#include "scenes/relief/warp/resample_walk.h"
#include "tests/support/relief_pictures.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

const glm::dvec3 kEyes[] = {{0.0, 0.0, 1.5},   {0.5, 0.3, 1.2},   {-0.6, 0.1, 1.0},
                            {0.05, -0.7, 0.9}, {-0.4, -0.5, 1.4}, {0.03, 0.02, 0.4}};

/// The eye of a perspective relief. Some of the eyes are nearer to the plane, some farther: texels
/// move towards the epipole or away from it.
constexpr glm::dvec3 kSource{-0.2, 0.15, 1.1};

/// The oracle of the passes: a line of texels, written down as the rule reads. `along` is the place
/// on the line, `carried` what else is mixed.
struct LineTexel {
  double along, half;
  double carried[2];
  std::uint32_t colour;
};
using Line = std::map<int, LineTexel>;

void fill_line(const Line& texels, double epipole, bool outwards, int sign, Line& filled) {
  std::vector<int> order;
  for (const auto& [i, texel] : texels) {
    if ((sign > 0) == ((i <= std::floor(epipole)) != outwards)) order.push_back(i);
  }
  if (sign < 0) std::reverse(order.begin(), order.end());
  const auto put_flat = [&](const LineTexel& texel, double from, double to) {
    for (int x = -400; x < 400; ++x) {
      if (sign * x > sign * from && sign * x <= sign * to) filled[x] = texel;
    }
  };
  for (std::size_t k = 0; k < order.size(); ++k) {
    const LineTexel& now = texels.at(order[k]);
    const bool is_next = k > 0 && order[k] - order[k - 1] == sign;
    const LineTexel* before = is_next ? &texels.at(order[k - 1]) : nullptr;
    if (before != nullptr && sign * now.along >= sign * before->along) {
      for (int x = -400; x < 400; ++x) {
        if (!(sign * x > sign * before->along && sign * x <= sign * now.along)) continue;
        const double share = (x - before->along) / (now.along - before->along);
        LineTexel mixed = now;
        for (int i = 0; i < 2; ++i) {
          mixed.carried[i] = before->carried[i] + share * (now.carried[i] - before->carried[i]);
        }
        mixed.colour = mix_colours(before->colour, now.colour,
                                   static_cast<std::uint32_t>(std::floor(share * 256.0 + 0.5)));
        filled[x] = mixed;
      }
    } else {
      put_flat(now, now.along - sign * now.half, now.along);
    }
    const bool goes_on = k + 1 < order.size() && order[k + 1] - order[k] == sign &&
                         sign * texels.at(order[k + 1]).along >= sign * now.along;
    if (!goes_on) put_flat(now, now.along, now.along + sign * now.half);
  }
}

/// Both passes in binary64, all places by the equation; carried are v' and the depth.
std::map<std::pair<int, int>, std::uint32_t> warped_by_oracle(const ReliefTexture& relief,
                                                              glm::dvec3 eye,
                                                              Resampling resampling) {
  const PreWarp warp = pre_warp(relief, eye);
  const auto half_texel = [&](double depth_m) {
    return 0.5 / (1.0 + shares_of(warp, depth_m).scale);
  };
  std::map<int, Line> columns;
  for (int v = 0; v < relief.height; ++v) {
    Line row, filled;
    for (int u = 0; u < relief.width; ++u) {
      const std::size_t at = texel_at(relief, u, v);
      if (relief.depths[at] == empty_depth(relief.depth_bits)) continue;
      const double depth = relief.depths[at] * depth_step(relief);
      const WarpedPlace place = pre_warp_oracle(relief, eye, u, v, depth);
      row[u] = {place.u, half_texel(depth), {place.v, depth}, relief.colours[at]};
    }
    for (const int sign : {1, -1}) fill_line(row, warp.epipole_u, warp.outwards, sign, filled);
    for (auto& [x, texel] : filled) {
      const double depth = texel.carried[1];
      if (resampling == Resampling::two_pass) {
        texel.carried[0] = pre_warp_oracle(relief, eye, x, v, depth).v;
      }
      columns[x][v] = {texel.carried[0], half_texel(depth), {0.0, depth}, texel.colour};
    }
  }
  std::map<std::pair<int, int>, std::uint32_t> plane;
  for (const auto& [x, column] : columns) {
    Line filled;
    for (const int sign : {1, -1}) {
      fill_line(column, warp.epipole_v, warp.outwards, sign, filled);
    }
    for (const auto& [y, texel] : filled) plane[{x, y}] = texel.colour;
  }
  return plane;
}

double colour_difference(std::uint32_t a, std::uint32_t b) {
  double most = 0.0;
  for (int i = 0; i < 3; ++i) {
    most = std::fmax(most, std::fabs(static_cast<double>(a >> (8 * i) & 255u) -
                                     static_cast<double>(b >> (8 * i) & 255u)));
  }
  return most;
}

}  // namespace

TEST_CASE("what has no depth stays where it is") {
  ThreadPool pool(1);
  ReliefTexture flat = rough_relief(33, 21, 8, 1);
  for (std::uint16_t& code : flat.depths) code = code == 255 ? 255 : 0;
  for (const WarpRule& setting : all_warps()) {
    const WarpedRelief result = warped(flat, {0.2, 0.1, 0.8}, setting, pool);
    bool same = true;
    for (int y = -1; y <= flat.height; ++y) {
      for (int x = -1; x <= flat.width; ++x) {
        const bool inside = x >= 0 && y >= 0 && x < flat.width && y < flat.height;
        const std::uint32_t own = inside ? flat.colours[texel_at(flat, x, y)] : 0;
        same &= plane_colour(result, x, y) == own;
      }
    }
    CHECK(same);
  }
}

TEST_CASE("for the eye that a perspective relief was drawn for, it is its own picture") {
  ThreadPool pool(2);
  const ReliefTexture relief = seen_from_eye(rough_relief(33, 21, 8, 3), kSource);
  for (const WarpRule& setting : all_warps()) {
    const WarpedRelief result = warped(relief, kSource, setting, pool);
    bool same = true;
    for (int y = 0; y < relief.height; ++y) {
      for (int x = 0; x < relief.width; ++x) {
        same &= plane_colour(result, x, y) == relief.colours[texel_at(relief, x, y)];
      }
    }
    CHECK(same);
  }
}

TEST_CASE("both passes do what a line's rule says, texel by texel") {
  ThreadPool pool(1);
  for (const Resampling resampling : {Resampling::two_pass, Resampling::asymmetric}) {
    std::size_t wrong = 0, all = 0;
    const std::array reliefs{rough_relief(24, 19, 8, 1),
                             seen_from_eye(rough_relief(24, 19, 8, 2), kSource)};
    for (const ReliefTexture& relief : reliefs) {
      for (const glm::dvec3& eye : kEyes) {
        const auto plane = warped_by_oracle(relief, eye, resampling);
        const WarpedRelief result =
            warped(relief, eye, {resampling, PlaceNumbers::floats, WarpRule::kJoinAll}, pool);
        for (int y = 0; y < result.place.height; ++y) {
          for (int x = 0; x < result.place.width; ++x) {
            const int u = x + result.place.x_begin, v = y + result.place.y_begin;
            const auto found = plane.find({u, v});
            const std::uint32_t right = found == plane.end() ? 0 : found->second;
            const std::uint32_t own = plane_colour(result, u, v);
            ++all;
            // Binary32 may round a place to the other side of a texel.
            wrong += (own == 0) != (right == 0) || colour_difference(own, right) > 2.0 ? 1 : 0;
          }
        }
      }
    }
    CHECK(all > 5000);
    CHECK(wrong <= all / 1000);
  }
}

TEST_CASE("a warp has the same bits for any number of threads and vector unit") {
  const ReliefTexture relief = rough_relief(61, 47, 16, 5);
  ThreadPool plain(1, Isa::scalar);
  for (const ReliefTexture& of : {relief, seen_from_eye(relief, kSource)}) {
    for (const WarpRule& setting : all_warps()) {
      for (const glm::dvec3& eye : {kEyes[1], kEyes[5]}) {
        const WarpedRelief right = warped(of, eye, setting, plain);
        for (const Isa isa : available_isas()) {
          for (const int threads : {1, 3}) {
            ThreadPool pool(threads, isa);
            CHECK(warped(of, eye, setting, pool).colours == right.colours);
          }
        }
      }
    }
  }
}

TEST_CASE("a near square covers the far wall behind it, from everywhere") {
  ThreadPool pool(1);
  ReliefTexture orthographic = empty_relief(48, 48, 8, 0.4);
  constexpr std::uint32_t kNear = 0xFF0000C8u, kFar = 0xFF00C800u;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 48; ++x) {
      const bool is_near = x >= 20 && x < 29 && y >= 17 && y < 27;
      orthographic.depths[texel_at(orthographic, x, y)] = is_near ? 20 : 220;
      orthographic.colours[texel_at(orthographic, x, y)] = is_near ? kNear : kFar;
    }
  }
  const std::array reliefs{orthographic, seen_from_eye(orthographic, kSource)};
  for (std::size_t i = 0; i < 2 * all_warps().size(); ++i) {
    const WarpRule setting = all_warps()[i / 2];
    const ReliefTexture& relief = reliefs[i % 2];
    for (const glm::dvec3& eye : kEyes) {
      const WarpedRelief result = warped(relief, eye, setting, pool);
      const auto place = [&](double u, double v) {
        return pre_warp_oracle(relief, eye, u, v, 20 * depth_step(relief));
      };
      const WarpedPlace first = place(20, 17), last = place(28, 26);
      bool covered = true;
      for (int v = static_cast<int>(std::ceil(first.v)); v <= std::floor(last.v); ++v) {
        for (int u = static_cast<int>(std::ceil(first.u)); u <= std::floor(last.u); ++u) {
          covered &= plane_colour(result, u, v) == kNear;
        }
      }
      CAPTURE(static_cast<int>(setting.resampling));
      CAPTURE(static_cast<int>(setting.numbers));
      CAPTURE(eye.x);
      CHECK(covered);
    }
  }
}

TEST_CASE("a warped sphere shows what a ray through the texel meets") {
  ThreadPool pool(1);
  const int size = 96;
  const ReliefTexture relief = sphere_relief(size, 16);
  const double radius = (0.5 * size - 1.0) * 0.01;
  const glm::dvec3 centre{0.0, 0.0, -radius}, eye{0.45, 0.3, 1.6};
  for (const WarpRule& setting : all_warps()) {
    const WarpedRelief result = warped(relief, eye, setting, pool);
    int seen = 0, wrong = 0;
    for (int y = 0; y < result.place.height; ++y) {
      for (int x = 0; x < result.place.width; ++x) {
        const int u = x + result.place.x_begin, v = y + result.place.y_begin;
        const glm::dvec3 ray = relief_point(relief, u, v, 0) - eye, out = eye - centre;
        const double a = dot(ray, ray), b = dot(ray, out), c = dot(out, out) - radius * radius;
        const double square = b * b - a * c;
        if (square <= 0.0) continue;
        const glm::dvec3 hit = eye + ray * ((-b - std::sqrt(square)) / a);
        // Near the rim of the relief a texel is a large step of depth.
        if (hit.z < -0.85 * radius) continue;
        ++seen;
        const double texel_x = hit.x / 0.01 + 0.5 * (size - 1);
        const double texel_y = -hit.y / 0.01 + 0.5 * (size - 1);
        const std::uint32_t own = plane_colour(result, u, v);
        const double red = 40 + 170 * texel_x / size, green = 40 + 170 * texel_y / size;
        const bool is_right = own != 0 && std::fabs((own & 255u) - red) < 4.0 &&
                              std::fabs((own >> 8 & 255u) - green) < 4.0;
        wrong += is_right ? 0 : 1;
      }
    }
    CAPTURE(static_cast<int>(setting.resampling));
    CAPTURE(static_cast<int>(setting.numbers));
    CHECK(seen > 4000);
    CHECK(wrong <= seen / 200);
  }
}

TEST_CASE("the compensated depth is equation 8-1's, and moves a texel to the place asked for") {
  const ReliefTexture relief = empty_relief(64, 64, 8, 0.4);
  Random random{4};
  for (int i = 0; i < 100; ++i) {
    const PreWarp warp =
        pre_warp(relief, {random.between(-0.5, 0.5), random.between(0.4, 0.9), 1.0});
    const double k2 = static_cast<double>(warp.k2), k3 = static_cast<double>(warp.k3);
    const double v = random.whole(0, 63), t = random.between(0.0, 1.0);
    const double disp_a = random.between(0.0, 0.4), disp_b = random.between(0.0, 0.4);
    const auto moved = [&](double disp) { return (v + k2 * disp) / (1.0 + k3 * disp); };
    const double vp_a = moved(disp_a);
    const double beta1 = v * (1.0 + k3 * disp_b) - vp_a, beta2 = v - vp_a + k2 * disp_b;
    const double beta3 = vp_a * k3 * disp_b;
    const double gamma1 = vp_a * k3 - (1.0 + k3 * disp_b) * k2, gamma2 = beta2 * k3;
    const double gamma3 = vp_a * k3 * k3 * disp_b;
    const double by_source =
        (beta1 - t * beta2 - (1.0 - t) * beta3) / (gamma1 + t * gamma2 + (1.0 - t) * gamma3);
    const double place = (1.0 - t) * vp_a + t * moved(disp_b);
    CHECK(moved(by_source) == doctest::Approx(place).epsilon(1e-9));
    const auto own = static_cast<double>(
        compensated_depth(warp, static_cast<float>(v), static_cast<float>(place), 0.0f));
    CHECK(own == doctest::Approx(by_source).epsilon(1e-3));
  }
}

TEST_CASE("overlaps and stretched texels are counted") {
  ThreadPool pool(2);
  const ReliefTexture sphere = sphere_relief(64, 8);
  ReliefTexture flat = sphere;
  for (std::uint16_t& code : flat.depths) code = code == 255 ? 255 : 9;
  for (const WarpRule& setting : all_warps()) {
    WarpCounts counts;
    warped(flat, {0.3, 0.2, 1.2}, setting, pool, &counts);
    CHECK(counts.stretched == 0);
    warped(sphere, {0.9, 0.2, 1.2}, setting, pool, &counts);
    CHECK(counts.stretched > 0);
    CHECK(counts.overlaps > 0);
    CHECK(counts.pieces > counts.overlaps);
  }
}

TEST_CASE("neighbours that come farther apart than asked for leave a hole between them") {
  ThreadPool pool(1);
  ReliefTexture relief = empty_relief(40, 8, 8, 0.4);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 40; ++x) {
      relief.depths[texel_at(relief, x, y)] = x < 20 ? 0 : 250;
      relief.colours[texel_at(relief, x, y)] = x < 20 ? 0xFF0000FFu : 0xFF00FF00u;
    }
  }
  const glm::dvec3 eye{0.6, 0.0, 1.0};  // from the right, past the near part's edge
  for (WarpRule rule : all_warps()) {
    const auto holes_by = [&](double join_texels) {
      rule.join_texels = join_texels;
      const WarpedRelief result = warped(relief, eye, rule, pool);
      int holes = 0;
      for (int u = 20; u < 30; ++u) holes += plane_colour(result, u, 4) == 0 ? 1 : 0;
      return holes;
    };
    CHECK(holes_by(WarpRule::kJoinAll) == 0);
    CHECK(holes_by(4.0) >= 8);
  }
}
