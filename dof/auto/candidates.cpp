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
    Candidate{"pinhole",        -1, -1, {0.0025f, 0.000f, 1.514f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.0034f, 0.468f, 0.000f, 1.582f, 0.000f, 0.282f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.0034f, 0.283f, 0.284f, 1.468f, 0.217f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.0032f, 0.000f, 0.443f, 0.997f, 0.416f, 0.603f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.0035f, 0.000f, 0.378f, 0.000f, 0.511f, 1.826f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.0037f, 0.000f, 0.340f, 0.000f, 0.540f, 2.363f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.0028f, 0.087f, 0.317f, 1.556f, 0.090f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.0018f, 0.000f, 0.327f, 1.333f, 0.217f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.0031f, 0.026f, 0.223f, 0.748f, 0.189f, 0.186f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.0032f, 0.073f, 0.186f, 0.000f, 0.182f, 0.108f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.0031f, 0.092f, 0.183f, 0.000f, 0.160f, 0.135f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.0026f, 0.000f, 0.457f, 1.050f, 0.418f, 0.792f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.0046f, 0.000f, 0.304f, 0.132f, 0.570f, 1.605f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.0044f, 0.063f, 0.250f, 0.000f, 0.594f, 1.843f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.0009f, 0.104f, 0.330f, 1.262f, 0.540f, 0.343f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.0014f, 0.345f, 0.100f, 0.776f, 0.585f, 0.738f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.0014f, 0.439f, 0.042f, 0.000f, 0.594f, 0.626f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.0013f, 0.466f, 0.033f, 0.000f, 0.572f, 0.666f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.0012f, 0.351f, 0.000f, 0.000f, 0.000f, 0.000f, 2.474f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.0005f, 0.234f, 0.000f, 0.000f, 0.000f, 0.000f, 2.058f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.0004f, 0.166f, 0.000f, 0.000f, 0.000f, 0.000f, 2.312f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.0000f, 0.134f, 0.000f, 0.000f, 0.000f, 0.000f, 2.177f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
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
