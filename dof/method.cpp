#include "dof/dof.h"

#include <array>

#include "dof/disc_layers/disc_layers.h"
#include "dof/methods/circular_separable.h"
#include "dof/methods/diffusion.h"
#include "dof/methods/pinhole.h"
#include "dof/methods/post_process.h"
#include "dof/methods/ring_bucket.h"
#include "dof/one_pass/one_pass.h"
#include "dof/scatter/scatter.h"
#include "dof/two_pass/two_pass.h"

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
           kColourAndDepth, diffusion},
    Method{"ring-bucket", "rings at half resolution, the near field apart, after Abadie 2018",
           kColourAndDepth, ring_bucket},
    Method{"circular-1", "a disc of one complex Gaussian, separable, after Garcia 2017",
           kColourAndDepth, circular_one},
    Method{"circular-2", "circular-1 with two complex Gaussians", kColourAndDepth, circular_two},
    Method{"disc-layers", "layers of equal circles, each a disc, the nearer over the farther",
           kColourAndDepth, disc_layers},
    Method{"post-process", "blended from four sharpnesses, after Hammon 2007", kColourAndDepth,
           post_process},
};

}  // namespace

Image apply(const Method& method, const DofInput& input, ThreadPool& pool) {
  Image result = make_image(input.scene.format, input.scene.width, input.scene.height);
  method.apply(input, result, pool);
  return result;
}

std::span<const Method> methods() { return kMethods; }

const Method* find_method(std::string_view name) {
  for (const Method& method : kMethods) {
    if (method.name == name) return &method;
  }
  return nullptr;
}

}  // namespace softfocus
