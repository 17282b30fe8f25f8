#include "dof/dof.h"

#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "dof/circular/circular.h"
#include "dof/disc_layers/disc_layers.h"
#include "dof/methods/anisotropic_diffusion.h"
#include "dof/methods/diffusion.h"
#include "dof/methods/fields.h"
#include "dof/methods/generalised_diffusion.h"
#include "dof/methods/importance_ordered.h"
#include "dof/methods/pinhole.h"
#include "dof/methods/post_process.h"
#include "dof/mipmap/mipmap.h"
#include "dof/object_layers/object_layers.h"
#include "dof/one_pass/one_pass.h"
#include "dof/pipelines/pipeline.h"
#include "dof/polygon/polygon.h"
#include "dof/ray_distribution/ray_distribution.h"
#include "dof/ring_bucket/ring_bucket.h"
#include "dof/scatter/aperture_scatter.h"
#include "dof/scatter/layers.h"
#include "dof/scatter/scatter.h"
#include "dof/smooth_edges.h"
#include "dof/transparent.h"
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
    Method{"importance-ordered",
           "one-pass where it shows most, the rest roughly, after Fearing 1995", kColourAndDepth,
           importance_ordered},
    Method{"scatter", "every pixel spread over its disc, after Potmesil and Chakravarty 1981",
           kColourAndDepth, scatter_unsorted},
    Method{"scatter-sorted", "scatter in slabs of depth, one over the other", kColourAndDepth,
           scatter_sorted},
    Method{"scatter-aperture",
           "scatter-sorted with the aperture's exact image: round, bladed, stretched",
           kColourAndDepth, scatter_aperture},
    Method{"layers", "near, middle and far, each blurred by itself, after Scofield 1992",
           kColourAndDepth, layers},
    Method{"fields", "near, focus and far as three pictures, one radius a field", kColourAndDepth,
           fields},
    Method{"ray-distribution-buffer",
           "the nearest thing through each point of the lens, after Shinya 1994", kColourAndDepth,
           ray_distribution},
    Method{"diffusion", "colour flows like heat, after Kass, Lefohn and Owens 2006",
           kColourAndDepth, diffusion, true},
    Method{
        .name = "generalised-diffusion",
        .summary = "blurred as the user asks, by radii of his own, after Kosloff and Barsky 2007",
        .needs = kColourAndDepth,
        .filter = generalised_diffusion,
        .any_radius_costs_the_same = true,
        .takes_radii = true},
    Method{"anisotropic-diffusion",
           "heat again, step by step, after Bertalmio, Fort and Sanchez-Crespo 2004",
           kColourAndDepth, anisotropic_diffusion},
    Method{"ring-bucket", "rings at half resolution, the near field apart, after Abadie 2018",
           kColourAndDepth, ring_bucket},
    Method{"circular-1", "a disc of one complex Gaussian, separable, after Garcia 2017",
           kColourAndDepth, circular_one},
    Method{"circular-2", "circular-1 with two complex Gaussians", kColourAndDepth, circular_two},
    Method{"pentagonal", "pentagons by blurs along lines, after McIntosh et al. 2012",
           kColourAndDepth, pentagonal},
    Method{"hexagonal", "hexagons by blurs along lines, after White 2011", kColourAndDepth,
           hexagonal},
    Method{"disc-layers", "layers of equal circles, each a disc, the nearer over the farther",
           kColourAndDepth, disc_layers, true},
    Method{.name = "layered",
           .summary = "disc-layers that sees what lies behind, after Lee 2009 and Franke 2018",
           .needs = "colour and depth of several layers",
           .filter = layered,
           .any_radius_costs_the_same = true,
           .layers = 2},
    Method{"object-identification",
           "disc-layers that cut no object and go on behind others, after Barsky et al. 2005",
           kColourAndDepth, object_layers, true, true},
    Method{"post-process", "blended from four sharpnesses, after Hammon 2007", kColourAndDepth,
           post_process},
    Method{"mipmap", "blended from levels of a pyramid, after Lee, Kim and Choi 2009",
           kColourAndDepth, mipmap, true},
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
  const auto pixels =
      static_cast<std::size_t>(scene.width) * static_cast<std::size_t>(scene.height);
  if (!input.objects.empty() && input.objects.size() != pixels) {
    return "there is not one object number for each pixel";
  }
  const auto layer_error = [&](const ConstImageView& layer) -> const char* {
    if (layer.texels == nullptr) return "there is no memory";
    if (layer.format != scene.format || layer.width != scene.width ||
        layer.height != scene.height) {
      return "a layer has not the scene's size and format";
    }
    return std::abs(layer.stride_bytes) < row_bytes ? "a stride is shorter than a row" : nullptr;
  };
  if (input.behind.size() > kMostBehind) return "there are more than 3 layers behind the first";
  for (const ConstImageView& layer : input.behind) {
    if (const char* error = layer_error(layer)) return error;
  }
  if (input.transparent.size() > kMostTransparent)
    return "there are more than 4 transparent layers";
  for (const TransparentLayer& layer : input.transparent) {
    if (const char* error = layer_error(layer.colour)) return error;
    if (const char* error = layer_error(layer.opacity)) return error;
  }
  const EdgeSurfaces& edges = input.edges;
  if (edges.coverage.texels != nullptr) {
    if (edges.coverage.format != Format::r8 || edges.coverage.width != scene.width ||
        edges.coverage.height != scene.height ||
        std::abs(edges.coverage.stride_bytes) < scene.width) {
      return "the edges' coverage is not r8 of the scene's size";
    }
    if (const char* error = layer_error(edges.other)) return error;
    if (!input.radii_px.empty()) return "radii are of one surface a pixel, and edges have two";
  }
  if (!input.transparent.empty() && !input.radii_px.empty()) {
    return "radii are of one picture, and transparent layers are pictures of their own";
  }
  if (!input.radii_px.empty() && input.radii_px.size() != pixels) {
    return "there is not one radius for each pixel";
  }
  for (const float radius_px : input.radii_px) {
    if (!std::isfinite(radius_px)) return "a radius is not finite";
  }
  if (!(settings.max_coc_px >= 0.0f && settings.max_coc_px <= kLargestMaxCoc)) {
    return "max_coc_px is not from 0 to 1024";
  }
  if (!(settings.leak >= 0.0f && settings.leak <= std::numeric_limits<float>::max())) {
    return "leak is not 0 or more";
  }
  if (!(settings.budget >= 0.0f && settings.budget <= 1.0f)) return "budget is not from 0 to 1";
  if (const char* error = aperture_error(settings.aperture)) return error;
  if (!std::isfinite(settings.coc.radius_at_infinity_px) || !(settings.coc.focus_m > 0.0f)) {
    return "the circle of confusion has no finite radius or no focus above 0";
  }
  return nullptr;
}

namespace {

/// What a method has to make: a kept pixel on an edge takes colours of its neighbours.
KeptPart with_neighbours(const DofInput& input) {
  const KeptPart& kept = input.kept;
  if (kept.width == 0 || input.edges.coverage.texels == nullptr) return kept;
  const int left = std::max(kept.x - 1, 0), top = std::max(kept.y - 1, 0);
  const int right = std::min(kept.x + kept.width + 1, input.scene.width);
  const int bottom = std::min(kept.y + kept.height + 1, input.scene.height);
  return {left, top, right - left, bottom - top};
}

}  // namespace

void apply(const Method& method, const DofInput& input, const ImageView& result, ThreadPool& pool) {
  assert(input_error(input, result) == nullptr);
  const DefaultFloatEnvironment environment;
  const auto filter = [&](const DofInput& of, const ImageView& to) {
    if (method.pipeline != nullptr) return run_pipeline(*method.pipeline, of, to, pool);
    method.filter(of, to, pool);
  };
  DofInput of_edges = input;
  if (method.filter == pinhole) of_edges.settings.coc.radius_at_infinity_px = 0.0f;
  const DiffusedScene diffused = diffused_scene(of_edges, pool);
  DofInput of_filter = input;
  of_filter.scene = diffused.scene;
  of_filter.kept = with_neighbours(input);
  filter(of_filter, result);
  smooth_edges(of_edges, diffused.scene, result, pool);
  lay_transparent_over(input, result, filter, pool);
}

Image apply(const Method& method, const DofInput& input, ThreadPool& pool) {
  Image result = make_image(input.scene.format, input.scene.width, input.scene.height);
  apply(method, input, result, pool);
  return result;
}

}  // namespace softfocus
