#include "dof/auto/candidates.h"

#include <algorithm>
#include <array>

namespace softfocus {
namespace {

// To draw a lens view and add it to the sum.
constexpr double kDrawnPixelNs = 5.0, kDrawnTriangleNs = 25.0;

constexpr CostModel kNothing{};
constexpr CostModel kTwoPass{.pixel = 1.5f, .blurred_pixel = 3.0f, .blurred_pixel_radius = 0.1f};
constexpr CostModel kGeneralised{.pixel = 7.0f};
constexpr CostModel kDiscLayers{
    .pixel = 4.0f, .blurred_pixel = 15.0f, .blurred_pixel_radius = 0.05f};
constexpr CostModel kCircular{.pixel = 10.0f, .blurred_pixel = 15.0f, .blurred_pixel_radius = 0.1f};
constexpr CostModel kMipmap{.pixel = 10.0f, .blurred_pixel = 17.0f};
constexpr CostModel kObjects{.pixel = 10.0f, .blurred_pixel = 30.0f, .blurred_pixel_radius = 0.35f};
constexpr CostModel kAnisotropic{
    .pixel = 10.0f, .blurred_pixel = 22.0f, .blurred_pixel_radius = 1.4f};
constexpr CostModel kImportance{
    .pixel = 10.0f, .blurred_pixel = 12.0f, .blurred_pixel_radius = 2.8f};
constexpr CostModel kScatter{.pixel = 30.0f, .blurred_pixel = 25.0f, .blurred_pixel_radius = 1.0f};
constexpr CostModel kRays{.pixel = 20.0f, .blurred_pixel = 300.0f, .blurred_pixel_radius = 10.0f};
constexpr CostModel kSplats{.pixel = 200.0f};
// Of all rays, which are as many for each number of views.
constexpr CostModel kFilteredViews{.pixel = 60.0f};

// clang-format off
constexpr std::array kCandidates{
    //        method                      R   N   always    fine    blurred lost    near    far     ghosts    cost
    Candidate{"pinhole",                 -1, -1, {0.0026f, 0.000f, 1.488f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",                 0, -1, {0.0037f, 0.453f, 0.000f, 1.592f, 0.025f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 1, -1, {0.0036f, 0.253f, 0.283f, 1.470f, 0.240f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 2, -1, {0.0032f, 0.000f, 0.442f, 1.003f, 0.418f, 0.577f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 3, -1, {0.0036f, 0.000f, 0.380f, 0.004f, 0.514f, 1.669f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 4, -1, {0.0038f, 0.000f, 0.346f, 0.000f, 0.539f, 2.103f, 0.000f}, kTwoPass},
    Candidate{"generalised-diffusion",    2, -1, {0.0013f, 0.000f, 0.783f, 1.094f, 0.146f, 0.000f, 0.000f}, kGeneralised},
    Candidate{"generalised-diffusion",    3, -1, {0.0019f, 0.000f, 0.778f, 0.424f, 0.180f, 0.139f, 0.000f}, kGeneralised},
    Candidate{"generalised-diffusion",    4, -1, {0.0021f, 0.000f, 0.751f, 0.000f, 0.200f, 0.284f, 0.000f}, kGeneralised},
    Candidate{"disc-layers",              1, -1, {0.0030f, 0.132f, 0.267f, 1.578f, 0.001f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              2, -1, {0.0016f, 0.064f, 0.306f, 1.387f, 0.030f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              3, -1, {0.0025f, 0.165f, 0.163f, 0.946f, 0.001f, 0.340f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              4, -1, {0.0025f, 0.195f, 0.136f, 0.355f, 0.007f, 0.247f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              5, -1, {0.0025f, 0.198f, 0.134f, 0.000f, 0.002f, 0.264f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",               2, -1, {0.0014f, 0.152f, 0.388f, 1.290f, 0.000f, 0.182f, 0.000f}, kCircular},
    Candidate{"circular-1",               3, -1, {0.0017f, 0.215f, 0.246f, 0.796f, 0.025f, 0.796f, 0.000f}, kCircular},
    Candidate{"circular-1",               4, -1, {0.0017f, 0.229f, 0.226f, 0.650f, 0.027f, 0.924f, 0.000f}, kCircular},
    Candidate{"mipmap",                   2, -1, {0.0006f, 0.000f, 0.408f, 1.323f, 0.003f, 0.000f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   3, -1, {0.0020f, 0.000f, 0.313f, 0.689f, 0.000f, 0.277f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   4, -1, {0.0022f, 0.031f, 0.281f, 0.016f, 0.000f, 0.245f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   5, -1, {0.0023f, 0.043f, 0.269f, 0.000f, 0.000f, 0.266f, 0.000f}, kMipmap},
    Candidate{"object-identification",    2, -1, {0.0005f, 0.000f, 0.359f, 1.369f, 0.023f, 0.000f, 0.000f}, kObjects},
    Candidate{"object-identification",    3, -1, {0.0017f, 0.123f, 0.193f, 0.922f, 0.000f, 0.267f, 0.000f}, kObjects},
    Candidate{"object-identification",    4, -1, {0.0016f, 0.159f, 0.170f, 0.282f, 0.000f, 0.142f, 0.000f}, kObjects},
    Candidate{"object-identification",    5, -1, {0.0017f, 0.168f, 0.161f, 0.000f, 0.000f, 0.159f, 0.000f}, kObjects},
    Candidate{"anisotropic-diffusion",    2, -1, {0.0022f, 0.000f, 0.385f, 1.254f, 0.495f, 0.140f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    3, -1, {0.0035f, 0.000f, 0.260f, 0.347f, 0.656f, 0.884f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    4, -1, {0.0038f, 0.000f, 0.228f, 0.000f, 0.681f, 1.087f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    5, -1, {0.0038f, 0.000f, 0.227f, 0.000f, 0.675f, 1.110f, 0.000f}, kAnisotropic},
    Candidate{"importance-ordered",       2, -1, {0.0027f, 0.009f, 0.598f, 1.040f, 0.300f, 1.105f, 0.000f}, kImportance},
    Candidate{"importance-ordered",       3, -1, {0.0038f, 0.212f, 0.298f, 0.417f, 0.468f, 2.323f, 0.000f}, kImportance},
    Candidate{"importance-ordered",       4, -1, {0.0037f, 0.353f, 0.188f, 0.000f, 0.487f, 2.686f, 0.000f}, kImportance},
    Candidate{"scatter-sorted",           2, -1, {0.0010f, 0.089f, 0.335f, 1.268f, 0.545f, 0.302f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           3, -1, {0.0016f, 0.325f, 0.106f, 0.762f, 0.592f, 0.672f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           4, -1, {0.0015f, 0.421f, 0.046f, 0.000f, 0.602f, 0.579f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           5, -1, {0.0014f, 0.446f, 0.038f, 0.000f, 0.580f, 0.612f, 0.000f}, kScatter},
    Candidate{"ray-distribution-buffer",  2, -1, {0.0010f, 0.000f, 0.351f, 1.354f, 0.031f, 0.000f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  3, -1, {0.0023f, 0.214f, 0.122f, 0.960f, 0.027f, 0.174f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  4, -1, {0.0022f, 0.263f, 0.087f, 0.553f, 0.039f, 0.072f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  5, -1, {0.0023f, 0.265f, 0.084f, 0.000f, 0.029f, 0.082f, 0.000f}, kRays},
    Candidate{"surface-splatting",       -1, -1, {0.0029f, 0.000f, 0.422f, 0.000f, 0.110f, 0.637f, 0.000f}, kSplats},
    Candidate{"filtered-views",          -1,  0, {0.0020f, 0.149f, 0.000f, 0.000f, 0.056f, 0.032f, 0.149f}, kFilteredViews},
    Candidate{"filtered-views",          -1,  1, {0.0018f, 0.105f, 0.000f, 0.000f, 0.046f, 0.074f, 0.157f}, kFilteredViews},
    Candidate{"filtered-views",          -1,  2, {0.0016f, 0.056f, 0.009f, 0.000f, 0.033f, 0.095f, 0.257f}, kFilteredViews},
    Candidate{"accumulation",            -1,  0, {0.0006f, 0.234f, 0.000f, 0.000f, 0.000f, 0.000f, 1.677f}, kNothing},
    Candidate{"accumulation",            -1,  1, {0.0006f, 0.185f, 0.000f, 0.000f, 0.000f, 0.000f, 1.226f}, kNothing},
    Candidate{"accumulation",            -1,  2, {0.0004f, 0.140f, 0.000f, 0.000f, 0.000f, 0.000f, 1.124f}, kNothing},
    Candidate{"accumulation",            -1,  3, {0.0002f, 0.099f, 0.000f, 0.000f, 0.000f, 0.000f, 1.335f}, kNothing},
    Candidate{"accumulation",            -1,  4, {0.0002f, 0.071f, 0.000f, 0.000f, 0.000f, 0.000f, 1.525f}, kNothing},
    Candidate{"accumulation",            -1,  5, {0.0001f, 0.071f, 0.000f, 0.000f, 0.000f, 0.000f, 1.525f}, kNothing},
    Candidate{"accumulation",            -1,  6, {0.0001f, 0.071f, 0.000f, 0.000f, 0.000f, 0.000f, 1.525f}, kNothing},
    Candidate{"accumulation",            -1,  7, {0.0000f, 0.071f, 0.000f, 0.000f, 0.000f, 0.000f, 1.525f}, kNothing},
    Candidate{"accumulation",            -1,  8, {0.0000f, 0.071f, 0.000f, 0.000f, 0.000f, 0.000f, 1.525f}, kNothing},
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
    error += product(model.ghosts, traits.ghosts[static_cast<std::size_t>(candidate.samples)]);
  }
  const bool has_radius = candidate.radius >= 0;
  const RadiusTraits& of = has_radius ? traits.by_radius[static_cast<std::size_t>(candidate.radius)]
                                      : traits.by_radius.back();
  error += product(model.blurred, has_radius ? of.blurred : traits.blur);
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
