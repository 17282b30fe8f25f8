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
    Candidate{"pinhole",        -1, -1, {0.0028f, 0.000f, 1.554f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.0035f, 0.479f, 0.000f, 1.553f, 0.336f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.0035f, 0.259f, 0.242f, 1.445f, 0.297f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.0041f, 0.239f, 0.170f, 1.239f, 0.571f, 0.321f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.0040f, 0.181f, 0.149f, 1.007f, 0.666f, 3.774f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.0040f, 0.173f, 0.129f, 0.890f, 0.699f, 5.546f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.0033f, 0.000f, 0.296f, 1.509f, 0.129f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.0032f, 0.000f, 0.193f, 1.429f, 0.259f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.0034f, 0.120f, 0.081f, 1.435f, 0.271f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.0035f, 0.118f, 0.089f, 1.449f, 0.262f, 0.120f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.0035f, 0.055f, 0.138f, 0.000f, 0.238f, 0.095f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.0043f, 0.335f, 0.102f, 1.332f, 0.662f, 0.335f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.0041f, 0.333f, 0.000f, 1.184f, 0.847f, 2.891f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.0042f, 0.289f, 0.000f, 0.718f, 0.874f, 4.132f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.0039f, 0.139f, 0.168f, 1.403f, 0.527f, 0.000f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.0043f, 0.265f, 0.018f, 1.364f, 0.637f, 0.806f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.0043f, 0.276f, 0.000f, 1.062f, 0.649f, 1.312f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.0043f, 0.241f, 0.028f, 0.000f, 0.637f, 1.285f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.0022f, 0.148f, 0.000f, 0.000f, 0.000f, 0.000f, 2.340f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.0011f, 0.054f, 0.000f, 0.000f, 0.000f, 0.000f, 1.739f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.0008f, 0.047f, 0.000f, 0.000f, 0.000f, 0.000f, 2.109f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.0005f, 0.029f, 0.000f, 0.000f, 0.000f, 0.000f, 1.691f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.0004f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.391f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.0003f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.391f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.0002f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.391f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.0001f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.391f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.0001f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.391f}, kNothing},
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
