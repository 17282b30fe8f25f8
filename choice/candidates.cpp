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
    //        method             R   N   always   fine    blurred lost    near    far     ghosts   cost
    Candidate{"pinhole",        -1, -1, {0.0029f, 0.000f, 1.512f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",        0, -1, {0.0035f, 0.471f, 0.000f, 1.526f, 0.308f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        1, -1, {0.0035f, 0.230f, 0.252f, 1.407f, 0.294f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        2, -1, {0.0039f, 0.385f, 0.092f, 1.205f, 0.587f, 0.751f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        3, -1, {0.0040f, 0.240f, 0.129f, 1.023f, 0.647f, 3.804f, 0.000f}, kTwoPass},
    Candidate{"two-pass",        4, -1, {0.0039f, 0.245f, 0.104f, 1.039f, 0.670f, 5.225f, 0.000f}, kTwoPass},
    Candidate{"disc-layers",     1, -1, {0.0033f, 0.000f, 0.279f, 1.478f, 0.144f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     2, -1, {0.0033f, 0.013f, 0.187f, 1.375f, 0.235f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     3, -1, {0.0034f, 0.156f, 0.059f, 1.524f, 0.279f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     4, -1, {0.0035f, 0.108f, 0.114f, 1.299f, 0.231f, 0.055f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",     5, -1, {0.0035f, 0.053f, 0.156f, 0.000f, 0.209f, 0.039f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",      2, -1, {0.0040f, 0.445f, 0.040f, 1.278f, 0.675f, 0.848f, 0.000f}, kCircular},
    Candidate{"circular-1",      3, -1, {0.0040f, 0.363f, 0.000f, 1.169f, 0.829f, 3.035f, 0.000f}, kCircular},
    Candidate{"circular-1",      4, -1, {0.0040f, 0.349f, 0.000f, 0.734f, 0.829f, 3.956f, 0.000f}, kCircular},
    Candidate{"scatter-sorted",  2, -1, {0.0040f, 0.209f, 0.132f, 1.368f, 0.532f, 0.000f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  3, -1, {0.0042f, 0.305f, 0.000f, 1.380f, 0.634f, 0.889f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  4, -1, {0.0042f, 0.297f, 0.013f, 1.025f, 0.611f, 1.135f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",  5, -1, {0.0042f, 0.262f, 0.041f, 0.000f, 0.597f, 1.127f, 0.000f}, kScatter},
    Candidate{"accumulation",   -1,  0, {0.0022f, 0.143f, 0.000f, 0.000f, 0.000f, 0.000f, 2.362f}, kNothing},
    Candidate{"accumulation",   -1,  1, {0.0011f, 0.049f, 0.000f, 0.000f, 0.000f, 0.000f, 1.753f}, kNothing},
    Candidate{"accumulation",   -1,  2, {0.0008f, 0.044f, 0.000f, 0.000f, 0.000f, 0.000f, 2.140f}, kNothing},
    Candidate{"accumulation",   -1,  3, {0.0005f, 0.031f, 0.000f, 0.000f, 0.000f, 0.000f, 1.720f}, kNothing},
    Candidate{"accumulation",   -1,  4, {0.0004f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.393f}, kNothing},
    Candidate{"accumulation",   -1,  5, {0.0003f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.393f}, kNothing},
    Candidate{"accumulation",   -1,  6, {0.0002f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.393f}, kNothing},
    Candidate{"accumulation",   -1,  7, {0.0001f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.393f}, kNothing},
    Candidate{"accumulation",   -1,  8, {0.0001f, 0.036f, 0.000f, 0.000f, 0.000f, 0.000f, 1.393f}, kNothing},
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
