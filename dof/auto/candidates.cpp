#include "dof/auto/candidates.h"

#include <algorithm>
#include <array>

namespace softfocus {
namespace {

// To draw a lens view and add it to the sum.
constexpr double kDrawnPixelNs = 5.0, kDrawnTriangleNs = 25.0;

constexpr CostModel kNothing{};
constexpr CostModel kTwoPass{.pixel = 1.5f, .blurred_pixel = 3.0f, .blurred_pixel_radius = 0.1f};
constexpr CostModel kDiscLayers{
    .pixel = 3.0f, .blurred_pixel = 11.0f, .blurred_pixel_radius = 0.05f};
constexpr CostModel kCircular{.pixel = 8.0f, .blurred_pixel = 9.0f, .blurred_pixel_radius = 0.9f};
constexpr CostModel kScatter{.pixel = 30.0f, .blurred_pixel = 25.0f, .blurred_pixel_radius = 1.0f};

// clang-format off
constexpr std::array kCandidates{
    //        method             R   N   always    fine    blurred lost    near    far     ghosts    cost
    Candidate{"pinhole",        -1, -1, {0.0056f, 0.000f, 1.489f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.0065f, 0.000f, 0.000f, 1.640f, 0.000f, 1.606f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.0067f, 0.000f, 0.253f, 1.436f, 0.000f, 0.688f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.0034f, 0.000f, 0.422f, 0.856f, 0.120f, 1.115f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.0039f, 0.000f, 0.312f, 0.000f, 0.341f, 2.444f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.0039f, 0.000f, 0.291f, 0.000f, 0.411f, 2.740f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.0068f, 0.000f, 0.148f, 1.402f, 0.000f, 1.003f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.0026f, 0.000f, 0.333f, 1.078f, 0.000f, 0.489f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.0029f, 0.000f, 0.241f, 0.151f, 0.055f, 0.328f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.0036f, 0.000f, 0.226f, 0.000f, 0.031f, 0.247f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.0036f, 0.000f, 0.226f, 0.000f, 0.028f, 0.251f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.0024f, 0.000f, 0.524f, 0.895f, 0.045f, 1.091f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.0038f, 0.000f, 0.303f, 0.086f, 0.344f, 2.254f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.0041f, 0.000f, 0.261f, 0.000f, 0.407f, 2.565f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.0004f, 0.000f, 0.509f, 0.967f, 0.134f, 0.641f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.0014f, 0.307f, 0.141f, 0.000f, 0.374f, 0.900f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.0018f, 0.305f, 0.123f, 0.000f, 0.385f, 0.889f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.0018f, 0.305f, 0.123f, 0.000f, 0.385f, 0.889f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.0014f, 0.470f, 0.000f, 0.000f, 0.000f, 0.000f, 1.923f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.0000f, 0.307f, 0.000f, 0.000f, 0.000f, 0.000f, 1.987f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.0001f, 0.200f, 0.000f, 0.000f, 0.000f, 0.000f, 2.003f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.0000f, 0.178f, 0.000f, 0.000f, 0.000f, 0.000f, 1.941f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.0003f, 0.082f, 0.000f, 0.000f, 0.000f, 0.000f, 1.884f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.0001f, 0.082f, 0.000f, 0.000f, 0.000f, 0.000f, 1.884f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.0001f, 0.082f, 0.000f, 0.000f, 0.000f, 0.000f, 1.884f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.0000f, 0.082f, 0.000f, 0.000f, 0.000f, 0.000f, 1.884f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.0000f, 0.082f, 0.000f, 0.000f, 0.000f, 0.000f, 1.884f}, kNothing},
};
// clang-format on

double product(float a, float b) { return static_cast<double>(a) * static_cast<double>(b); }

}  // namespace

std::span<const Candidate> candidates() { return kCandidates; }

double predicted_error(const Candidate& candidate, const SceneTraits& traits) {
  const ErrorModel& model = candidate.error;
  double error =
      static_cast<double>(model.always) + product(model.fine, traits.by_radius.front().blurred);
  if (candidate.samples >= 0) {
    return error +
           product(model.ghosts, traits.ghosts[static_cast<std::size_t>(candidate.samples)]);
  }
  if (candidate.radius < 0) return error + product(model.blurred, traits.blur);
  const RadiusTraits& of = traits.by_radius[static_cast<std::size_t>(candidate.radius)];
  error += product(model.blurred, of.blurred);
  error += product(model.lost, of.lost);
  error += product(model.near_edges, of.near_edges);
  return error + product(model.far_edges, of.far_edges);
}

double predicted_ms(const Candidate& candidate, const SceneTraits& traits, std::size_t triangles) {
  const double pixels = static_cast<double>(traits.width) * traits.height;
  double ns = static_cast<double>(candidate.cost.pixel) * pixels;
  if (candidate.samples >= 0) {
    const double drawing =
        kDrawnPixelNs * pixels + kDrawnTriangleNs * static_cast<double>(triangles);
    ns += drawing * kSampleCounts[static_cast<std::size_t>(candidate.samples)];
  }
  if (candidate.radius >= 0) {
    const float radius_px =
        std::min(kFilterRadiiPx[static_cast<std::size_t>(candidate.radius)], largest_px(traits));
    const double of_blurred = static_cast<double>(candidate.cost.blurred_pixel) +
                              product(candidate.cost.blurred_pixel_radius, radius_px);
    ns += of_blurred * static_cast<double>(traits.blurred_share) * pixels;
  }
  return ns * 1e-6;
}

}  // namespace softfocus
