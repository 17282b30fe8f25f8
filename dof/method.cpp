#include "dof/dof.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "dof/disc_layers/disc_layers.h"
#include "dof/methods/circular_separable.h"
#include "dof/methods/diffusion.h"
#include "dof/methods/pinhole.h"
#include "dof/methods/post_process.h"
#include "dof/methods/ring_bucket.h"
#include "dof/one_pass/one_pass.h"
#include "dof/scatter/scatter.h"
#include "dof/two_pass/two_pass.h"
#include "raster/images/image.h"
#include "raster/threads/float_environment.h"

namespace softfocus {
namespace {

constexpr std::string_view kColourAndDepth = "colour and depth";

constexpr std::array kMethods{
    Method{"pinhole", "everything sharp: no lens", "colour", pinhole},
    Method{"two-pass", "a horizontal and a vertical gather, after Zhou et al. 2007",
           kColourAndDepth, two_pass},
    Method{"two-pass-single", "two-pass with RGBA32F between the passes", kColourAndDepth,
           two_pass_single},
    Method{"one-pass", "one gather over rings: round and slower, the thesis 5.1", kColourAndDepth,
           one_pass},
    Method{"scatter", "every pixel spread over its disc, after Potmesil and Chakravarty 1981",
           kColourAndDepth, scatter_unsorted},
    Method{"scatter-sorted", "scatter in slabs of depth, one over the other", kColourAndDepth,
           scatter_sorted},
    Method{"layers", "near, focus and far, each blurred by itself, after Scofield 1992",
           kColourAndDepth, layers},
    Method{"diffusion", "colour flows like heat, after Kass, Lefohn and Owens 2006",
           kColourAndDepth, diffusion, true},
    Method{"ring-bucket", "rings at half resolution, the near field apart, after Abadie 2018",
           kColourAndDepth, ring_bucket},
    Method{"circular-1", "a disc of one complex Gaussian, separable, after Garcia 2017",
           kColourAndDepth, circular_one},
    Method{"circular-2", "circular-1 with two complex Gaussians", kColourAndDepth, circular_two},
    Method{"disc-layers", "layers of equal circles, each a disc, the nearer over the farther",
           kColourAndDepth, disc_layers, true},
    Method{"post-process", "blended from four sharpnesses, after Hammon 2007", kColourAndDepth,
           post_process},
};

}  // namespace

std::span<const Method> methods() { return kMethods; }

const Method* find_method(std::string_view name) {
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

const char* input_error(const DofInput& input, const ConstImageView& result) {
  const ConstImageView& scene = input.scene;
  const DofSettings& settings = input.settings;
  if (scene.format != Format::rgba16f) return "the scene is not RGBA16F";
  if (scene.width < 1 || scene.width > kMaxImageSize || scene.height < 1 ||
      scene.height > kMaxImageSize) {
    return "the scene's width and height are not from 1 to 16384";
  }
  if (scene.texels == nullptr || result.texels == nullptr) return "there is no memory";
  if (result.format != scene.format || result.width != scene.width ||
      result.height != scene.height) {
    return "the result has not the scene's size and format";
  }
  const auto row_bytes = static_cast<std::ptrdiff_t>(static_cast<std::size_t>(scene.width) *
                                                     bytes_per_texel(scene.format));
  if (std::abs(scene.stride_bytes) < row_bytes || std::abs(result.stride_bytes) < row_bytes) {
    return "a stride is shorter than a row";
  }
  if (!(settings.max_coc_px >= 0.0f && settings.max_coc_px <= kLargestMaxCoc)) {
    return "max_coc_px is not from 0 to 1024";
  }
  if (!(settings.leak >= 0.0f && settings.leak <= std::numeric_limits<float>::max())) {
    return "leak is not 0 or more";
  }
  if (!std::isfinite(settings.coc.radius_at_infinity_px) || !(settings.coc.focus_m > 0.0f)) {
    return "the circle of confusion has no finite radius or no focus above 0";
  }
  return nullptr;
}

void apply(const Method& method, const DofInput& input, const ImageView& result, ThreadPool& pool) {
  assert(input_error(input, result) == nullptr);
  const DefaultFloatEnvironment environment;
  method.filter(input, result, pool);
}

Image apply(const Method& method, const DofInput& input, ThreadPool& pool) {
  Image result = make_image(input.scene.format, input.scene.width, input.scene.height);
  apply(method, input, result, pool);
  return result;
}

}  // namespace softfocus
