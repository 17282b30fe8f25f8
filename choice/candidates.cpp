#include "choice/candidates.h"

#include <algorithm>
#include <array>

namespace softfocus {
namespace {

// Drawing a picture again and adding it to the others' sum.
constexpr double kDrawnPixelNs = 5.0, kDrawnTriangleNs = 25.0;

constexpr CostModel kNothing{};
constexpr CostModel kTwoPass{.pixel = 1.5f, .blurred_pixel = 3.0f, .blurred_pixel_radius = 0.1f};
constexpr CostModel kDiscLayers{
    .pixel = 3.0f, .blurred_pixel = 11.0f, .blurred_pixel_radius = 0.05f};
constexpr CostModel kCircular{.pixel = 8.0f, .blurred_pixel = 9.0f, .blurred_pixel_radius = 0.9f};
constexpr CostModel kScatter{.pixel = 30.0f, .blurred_pixel = 25.0f, .blurred_pixel_radius = 1.0f};

// clang-format off
constexpr std::array kCandidates{
    //        method             R   N   share   fine    blurred lost    near    ghosts   cost
    Candidate{"pinhole",        -1, -1, {0.004f, 0.000f, 1.480f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.003f, 0.562f, 0.000f, 1.575f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.003f, 0.486f, 0.000f, 1.623f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.003f, 0.471f, 0.038f, 1.458f, 0.757f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.005f, 0.496f, 0.011f, 1.481f, 1.318f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.007f, 0.346f, 0.115f, 1.113f, 1.809f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.001f, 0.339f, 0.000f, 1.695f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.000f, 0.173f, 0.182f, 1.565f, 0.099f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.000f, 0.173f, 0.188f, 1.515f, 0.151f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.001f, 0.134f, 0.215f, 0.769f, 0.154f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.001f, 0.129f, 0.216f, 0.000f, 0.272f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.002f, 0.522f, 0.019f, 1.511f, 0.924f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.000f, 0.617f, 0.000f, 1.480f, 1.475f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.001f, 0.629f, 0.043f, 0.581f, 1.967f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.000f, 0.312f, 0.192f, 1.475f, 0.500f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.000f, 0.339f, 0.193f, 1.232f, 0.670f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.000f, 0.341f, 0.233f, 0.211f, 0.778f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.000f, 0.423f, 0.188f, 0.000f, 1.347f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.000f, 0.267f, 0.000f, 0.000f, 0.000f, 2.178f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.001f, 0.068f, 0.000f, 0.000f, 0.000f, 1.743f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.000f, 0.075f, 0.000f, 0.000f, 0.000f, 1.995f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.000f, 0.059f, 0.000f, 0.000f, 0.000f, 1.523f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.000f, 0.038f, 0.000f, 0.000f, 0.000f, 1.433f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.000f, 0.038f, 0.000f, 0.000f, 0.000f, 1.433f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.000f, 0.038f, 0.000f, 0.000f, 0.000f, 1.433f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.000f, 0.038f, 0.000f, 0.000f, 0.000f, 1.433f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.000f, 0.038f, 0.000f, 0.000f, 0.000f, 1.433f}, kNothing},
};
// clang-format on

double product(float a, float b) { return static_cast<double>(a) * static_cast<double>(b); }

}  // namespace

std::span<const Candidate> candidates() { return kCandidates; }

double predicted_error(const Candidate& candidate, const SceneTraits& traits) {
  const ErrorModel& model = candidate.error;
  double error = product(model.share, traits.blurred_share) +
                 product(model.fine, traits.by_radius.front().blurred);
  if (candidate.samples >= 0) {
    return error +
           product(model.ghosts, traits.ghosts[static_cast<std::size_t>(candidate.samples)]);
  }
  if (candidate.radius < 0) return error + product(model.blurred, traits.blur);
  const RadiusTraits& of = traits.by_radius[static_cast<std::size_t>(candidate.radius)];
  error += product(model.blurred, of.blurred);
  error += product(model.lost, of.lost);
  return error + product(model.near_edges, of.near_edges);
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
