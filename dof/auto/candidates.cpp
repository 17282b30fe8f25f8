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
    Candidate{"pinhole",        -1, -1, {0.0054f, 0.000f, 1.492f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.0056f, 0.312f, 0.000f, 1.523f, 0.000f, 1.922f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.0040f, 0.155f, 0.372f, 1.338f, 0.000f, 1.186f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.0044f, 0.016f, 0.363f, 0.989f, 0.319f, 1.750f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.0048f, 0.000f, 0.318f, 0.168f, 0.449f, 2.563f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.0048f, 0.029f, 0.277f, 0.000f, 0.481f, 3.043f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.0043f, 0.000f, 0.296f, 1.407f, 0.000f, 0.974f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.0024f, 0.000f, 0.319f, 1.265f, 0.094f, 0.542f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.0037f, 0.019f, 0.212f, 0.783f, 0.130f, 0.584f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.0037f, 0.055f, 0.180f, 0.001f, 0.135f, 0.515f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.0037f, 0.066f, 0.176f, 0.000f, 0.126f, 0.545f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.0036f, 0.029f, 0.346f, 1.055f, 0.350f, 2.277f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.0054f, 0.056f, 0.205f, 0.369f, 0.528f, 2.752f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.0051f, 0.146f, 0.134f, 0.000f, 0.578f, 3.048f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.0018f, 0.101f, 0.316f, 1.228f, 0.368f, 0.952f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.0021f, 0.329f, 0.110f, 0.901f, 0.466f, 0.909f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.0021f, 0.410f, 0.060f, 0.000f, 0.494f, 0.770f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.0020f, 0.423f, 0.057f, 0.000f, 0.482f, 0.800f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.0023f, 0.208f, 0.000f, 0.000f, 0.000f, 0.000f, 2.458f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.0012f, 0.141f, 0.000f, 0.000f, 0.000f, 0.000f, 2.073f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.0010f, 0.096f, 0.000f, 0.000f, 0.000f, 0.000f, 2.277f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.0005f, 0.080f, 0.000f, 0.000f, 0.000f, 0.000f, 2.253f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.0009f, 0.035f, 0.000f, 0.000f, 0.000f, 0.000f, 2.147f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.0004f, 0.035f, 0.000f, 0.000f, 0.000f, 0.000f, 2.147f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.0002f, 0.035f, 0.000f, 0.000f, 0.000f, 0.000f, 2.147f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.0001f, 0.035f, 0.000f, 0.000f, 0.000f, 0.000f, 2.147f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.0001f, 0.035f, 0.000f, 0.000f, 0.000f, 0.000f, 2.147f}, kNothing},
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
