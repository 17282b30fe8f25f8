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

// clang-format off
constexpr std::array kCandidates{
    //        method                      R   N   always    fine    blurred lost    near    far     ghosts    cost
    Candidate{"pinhole",                 -1, -1, {0.0025f, 0.000f, 1.514f, 0.000f, 0.000f, 0.000f, 0.000f}, kNothing},
    Candidate{"two-pass",                 0, -1, {0.0034f, 0.468f, 0.000f, 1.582f, 0.000f, 0.282f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 1, -1, {0.0034f, 0.283f, 0.284f, 1.468f, 0.217f, 0.000f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 2, -1, {0.0032f, 0.000f, 0.443f, 0.997f, 0.416f, 0.603f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 3, -1, {0.0035f, 0.000f, 0.378f, 0.000f, 0.511f, 1.826f, 0.000f}, kTwoPass},
    Candidate{"two-pass",                 4, -1, {0.0037f, 0.000f, 0.340f, 0.000f, 0.540f, 2.363f, 0.000f}, kTwoPass},
    Candidate{"generalised-diffusion",    2, -1, {0.0009f, 0.000f, 0.817f, 1.072f, 0.115f, 0.000f, 0.000f}, kGeneralised},
    Candidate{"generalised-diffusion",    3, -1, {0.0014f, 0.000f, 0.799f, 0.315f, 0.159f, 0.274f, 0.000f}, kGeneralised},
    Candidate{"generalised-diffusion",    4, -1, {0.0016f, 0.000f, 0.774f, 0.000f, 0.177f, 0.398f, 0.000f}, kGeneralised},
    Candidate{"disc-layers",              1, -1, {0.0029f, 0.143f, 0.269f, 1.578f, 0.000f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              2, -1, {0.0018f, 0.020f, 0.321f, 1.376f, 0.039f, 0.000f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              3, -1, {0.0026f, 0.142f, 0.167f, 0.933f, 0.005f, 0.380f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              4, -1, {0.0027f, 0.170f, 0.138f, 0.341f, 0.013f, 0.276f, 0.000f}, kDiscLayers},
    Candidate{"disc-layers",              5, -1, {0.0027f, 0.176f, 0.136f, 0.000f, 0.007f, 0.295f, 0.000f}, kDiscLayers},
    Candidate{"circular-1",               2, -1, {0.0015f, 0.112f, 0.406f, 1.285f, 0.000f, 0.155f, 0.000f}, kCircular},
    Candidate{"circular-1",               3, -1, {0.0018f, 0.204f, 0.249f, 0.789f, 0.027f, 0.794f, 0.000f}, kCircular},
    Candidate{"circular-1",               4, -1, {0.0017f, 0.225f, 0.228f, 0.648f, 0.028f, 0.931f, 0.000f}, kCircular},
    Candidate{"mipmap",                   2, -1, {0.0005f, 0.000f, 0.410f, 1.322f, 0.001f, 0.000f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   3, -1, {0.0020f, 0.000f, 0.312f, 0.690f, 0.000f, 0.284f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   4, -1, {0.0022f, 0.024f, 0.284f, 0.011f, 0.000f, 0.247f, 0.000f}, kMipmap},
    Candidate{"mipmap",                   5, -1, {0.0023f, 0.039f, 0.271f, 0.000f, 0.000f, 0.271f, 0.000f}, kMipmap},
    Candidate{"object-identification",    2, -1, {0.0005f, 0.000f, 0.355f, 1.372f, 0.027f, 0.000f, 0.000f}, kObjects},
    Candidate{"object-identification",    3, -1, {0.0018f, 0.115f, 0.196f, 0.917f, 0.000f, 0.265f, 0.000f}, kObjects},
    Candidate{"object-identification",    4, -1, {0.0016f, 0.148f, 0.174f, 0.274f, 0.000f, 0.133f, 0.000f}, kObjects},
    Candidate{"object-identification",    5, -1, {0.0017f, 0.159f, 0.164f, 0.000f, 0.000f, 0.152f, 0.000f}, kObjects},
    Candidate{"anisotropic-diffusion",    2, -1, {0.0021f, 0.000f, 0.387f, 1.241f, 0.491f, 0.193f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    3, -1, {0.0033f, 0.000f, 0.265f, 0.335f, 0.650f, 1.008f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    4, -1, {0.0035f, 0.000f, 0.232f, 0.000f, 0.674f, 1.217f, 0.000f}, kAnisotropic},
    Candidate{"anisotropic-diffusion",    5, -1, {0.0035f, 0.000f, 0.232f, 0.000f, 0.668f, 1.251f, 0.000f}, kAnisotropic},
    Candidate{"importance-ordered",       2, -1, {0.0025f, 0.029f, 0.592f, 1.036f, 0.293f, 1.182f, 0.000f}, kImportance},
    Candidate{"importance-ordered",       3, -1, {0.0034f, 0.253f, 0.287f, 0.440f, 0.454f, 2.435f, 0.000f}, kImportance},
    Candidate{"importance-ordered",       4, -1, {0.0033f, 0.392f, 0.179f, 0.000f, 0.475f, 2.850f, 0.000f}, kImportance},
    Candidate{"scatter-sorted",           2, -1, {0.0009f, 0.104f, 0.330f, 1.262f, 0.540f, 0.343f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           3, -1, {0.0014f, 0.345f, 0.100f, 0.776f, 0.585f, 0.738f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           4, -1, {0.0014f, 0.439f, 0.042f, 0.000f, 0.594f, 0.626f, 0.000f}, kScatter},
    Candidate{"scatter-sorted",           5, -1, {0.0013f, 0.466f, 0.033f, 0.000f, 0.572f, 0.666f, 0.000f}, kScatter},
    Candidate{"ray-distribution-buffer",  2, -1, {0.0010f, 0.000f, 0.349f, 1.357f, 0.033f, 0.000f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  3, -1, {0.0022f, 0.214f, 0.122f, 0.959f, 0.027f, 0.183f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  4, -1, {0.0022f, 0.260f, 0.087f, 0.551f, 0.040f, 0.073f, 0.000f}, kRays},
    Candidate{"ray-distribution-buffer",  5, -1, {0.0023f, 0.262f, 0.085f, 0.000f, 0.029f, 0.084f, 0.000f}, kRays},
    Candidate{"surface-splatting",       -1, -1, {0.0028f, 0.000f, 0.424f, 0.000f, 0.102f, 0.791f, 0.000f}, kSplats},
    Candidate{"accumulation",            -1,  0, {0.0012f, 0.351f, 0.000f, 0.000f, 0.000f, 0.000f, 2.474f}, kNothing},
    Candidate{"accumulation",            -1,  1, {0.0005f, 0.234f, 0.000f, 0.000f, 0.000f, 0.000f, 2.058f}, kNothing},
    Candidate{"accumulation",            -1,  2, {0.0004f, 0.166f, 0.000f, 0.000f, 0.000f, 0.000f, 2.312f}, kNothing},
    Candidate{"accumulation",            -1,  3, {0.0000f, 0.134f, 0.000f, 0.000f, 0.000f, 0.000f, 2.177f}, kNothing},
    Candidate{"accumulation",            -1,  4, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",            -1,  5, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",            -1,  6, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",            -1,  7, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
    Candidate{"accumulation",            -1,  8, {0.0000f, 0.074f, 0.000f, 0.000f, 0.000f, 0.000f, 2.149f}, kNothing},
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
