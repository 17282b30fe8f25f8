#include "raster/effects/effect.h"

#include <array>
#include <cassert>

#include "raster/effects/bloom.h"
#include "raster/effects/effect_settings.h"
#include "raster/effects/lens_flare.h"
#include "raster/effects/motion/motion_blur.h"
#include "raster/effects/tone_map.h"
#include "raster/passes/bilateral.h"
#include "raster/passes/kernel.h"
#include "raster/threads/float_environment.h"

namespace softfocus {
namespace {

void by_kernel(const Effect& effect, const EffectInput& input, const ImageView& result,
               ThreadPool& pool) {
  convolve(*find_kernel(effect.name), input.picture, result, input.profile, pool);
}

void gaussian(const Effect&, const EffectInput& input, const ImageView& result, ThreadPool& pool) {
  const std::vector<float> weights = gaussian_weights(input.parameters[0]);
  Image across = make_image(Format::rgba16f, result.width, result.height);
  convolve(row_kernel(weights), input.picture, across, input.profile, pool);
  convolve(column_kernel(weights), across, result, input.profile, pool);
}

constexpr std::array kGaussian{Parameter{"sigma", "standard deviation in pixels", 0.0, 341.0, 2.0}};

void gaussian_at_once(const Effect&, const EffectInput& input, const ImageView& result,
                      ThreadPool& pool) {
  convolve(square_kernel(gaussian_weights(input.parameters[0])), input.picture, result,
           input.profile, pool);
}

constexpr std::array kGaussianAtOnce{
    Parameter{"sigma", "standard deviation in pixels", 0.0, 20.0, 2.0}};

void bilateral_effect(const Effect&, const EffectInput& input, const ImageView& result,
                      ThreadPool& pool) {
  bilateral(bilateral_settings(input.parameters), input.picture, result, input.profile, pool);
}

constexpr std::array kBilateral{
    Parameter{"sigma", "standard deviation of the distance in pixels", 0.0, 20.0, 2.0},
    Parameter{"colour", "distance of unlike colours in linear light, 0 = none", 0.0, 1000.0, 0.1},
    Parameter{"depth", "distance of unlike depths over the pixel's depth, 0 = none", 0.0, 1000.0,
              0.0}};

void dual_filter_effect(const Effect&, const EffectInput& input, const ImageView& result,
                        ThreadPool& pool) {
  const auto [levels, widening] = dual_filter_settings(input.parameters);
  dual_filter(levels, widening, input.picture, result, input.profile, pool);
}

constexpr std::array kDualFilter{
    Parameter{"levels", "halvings: each makes the blur twice as wide", 1.0, 12.0, 2.0},
    Parameter{"bilinear", "1: wider again by bilinear samples, 0: by tents of them", 0.0, 1.0,
              0.0}};

void bloom_effect(const Effect&, const EffectInput& input, const ImageView& result,
                  ThreadPool& pool) {
  bloom(bloom_settings(input.parameters), input.picture, result, input.profile, pool);
}

constexpr std::array kBloom{
    Parameter{"threshold", "what is darker does not bloom, white is 1", 0.0, 65504.0, 1.0},
    Parameter{"knee", "half the way from nothing to all that blooms", 0.0, 65504.0, 0.5},
    Parameter{"strength", "share of the bright light that is scattered", 0.0, 1.0, 0.1},
    Parameter{"levels", "halvings: the widest reaches some 2^levels pixels", 1.0, 12.0, 6.0},
    Parameter{"spread", "how much of each level comes from wider ones", 0.0, 1.0, 0.6},
    Parameter{"steady", "1: bright pixels do not flicker as they move, and lose light", 0.0, 1.0,
              0.0}};

void bloom_gaussian_effect(const Effect&, const EffectInput& input, const ImageView& result,
                           ThreadPool& pool) {
  bloom_by_gaussian(gaussian_bloom_settings(input.parameters), input.picture, result, input.profile,
                    pool);
}

constexpr std::array kBloomGaussian{
    kBloom[0], kBloom[1], kBloom[2],
    Parameter{"sigma", "standard deviation in pixels", 0.0, 341.0, 8.0}};

void lens_flare_effect(const Effect&, const EffectInput& input, const ImageView& result,
                       ThreadPool& pool) {
  lens_flare(lens_flare_settings(input.parameters), input.picture, result, input.profile, pool);
}

constexpr std::array kLensFlare{
    Parameter{"threshold", "what is darker has no flare, white is 1", 0.0, 65504.0, 1.0},
    Parameter{"knee", "half the way from nothing to all that has one", 0.0, 65504.0, 0.5},
    Parameter{"beyond", "light nearer than this, in metres of depth, has none; 0: all has", 0.0,
              65504.0, 0.0},
    Parameter{"strength", "factor of all that is added", 0.0, 10.0, 0.05},
    Parameter{"ghosts", "mirrored and scaled pictures of the light", 0.0, 8.0, 5.0},
    Parameter{"fringe", "how much larger ghosts are in blue than in green", 0.0, 0.3, 0.03},
    Parameter{"halo", "radius of a ring, over half the picture's height; 0: none", 0.0, 1.0, 0.5},
    Parameter{"streak", "length of streaks to either side in pixels; 0: none", 0.0, 4096.0, 200.0},
    Parameter{"rays", "length of rays from the light, over the way to it; 0: none", 0.0, 1.0, 0.3},
    Parameter{"aperture",
              "radius of a ghost's six blades, over half the picture's height; 0: the "
              "light's own shape",
              0.0, 0.5, 0.08}};

void motion_blur_along_own_effect(const Effect&, const EffectInput& input, const ImageView& result,
                                  ThreadPool& pool) {
  motion_blur_along_own(static_cast<float>(input.parameters[0]),
                        static_cast<int>(input.parameters[1]), input.picture, input.velocity,
                        result, input.profile, pool);
}

template <MotionFilter filter>
void motion_blur_effect(const Effect&, const EffectInput& input, const ImageView& result,
                        ThreadPool& pool) {
  motion_blur(motion_blur_settings(input.parameters, filter), input.picture, input.velocity, result,
              input.profile, pool);
}

constexpr std::array kMotionBlur{
    Parameter{"shutter", "part of a frame that it is open, centred on the frame", 0.0, 8.0, 0.5},
    Parameter{"samples", "pixels that are read for each", 1.0, 64.0, 16.0},
    Parameter{"radius", "longest way to either side in pixels, and the size of the tiles", 1.0,
              256.0, 32.0},
    Parameter{"depth", "part of its depth by which something lies wholly before another", 0.001,
              1000.0, 0.1}};

void tone_map_effect(const Effect& effect, const EffectInput& input, const ImageView& result,
                     ThreadPool& pool) {
  tone_map(*find_tone_curve(effect.name), static_cast<float>(input.parameters[0]), input.picture,
           result, input.profile, pool);
}

constexpr std::array kExposure{Parameter{"exposure", "factor of the light", 0.0, 65504.0, 1.0}};

/// The effect that a tone curve is.
constexpr Effect of_curve(const NamedToneCurve& named) {
  return {named.name, named.summary, kExposure, tone_map_effect};
}

constexpr Parameter kFrameDepth{
    "depth", "how much nearer or farther a surface may have been, over its depth; 0: any", 0.0,
    1000.0, 0.1};
constexpr Parameter kWarmUp{"warm-up", "frames that are drawn before the first, for a history", 0.0,
                            1000.0, 0.0};

constexpr std::array kTemporalAa{
    Parameter{"new", "least share of the new frame in the average", 0.001, 1.0, 0.1},
    Parameter{"places", "in the pixel that frames look from in turn, 1: its centre", 1.0, 64.0,
              8.0},
    Parameter{"box", "old colours are cut to 3x3 new ones: 0 not, 1 to all, 2 by deviations", 0.0,
              2.0, 2.0},
    Parameter{"deviations", "standard ones from the mean that are kept, of box=2", 0.0, 1000.0,
              1.0},
    Parameter{"cubic", "1: the frame before is read by a cubic curve; 0: bilinear", 0.0, 1.0, 1.0},
    kFrameDepth,
    kWarmUp};
constexpr std::array kRefresh{Parameter{"groups", "a frame draws one of them", 1.0, 64.0, 4.0},
                              kFrameDepth, kWarmUp};
constexpr std::array kReproject{
    Parameter{"every", "one of so many frames is drawn", 1.0, 1000.0, 2.0},
    Parameter{"forward", "1: pixels go to where they are now; 0: look where they were", 0.0, 1.0,
              0.0},
    Parameter{"holes", "what was not seen is 0 drawn, 1 filled from beside it, 2 left black", 0.0,
              2.0, 0.0},
    kFrameDepth, kWarmUp};

constexpr std::array kEffects{
    // Effects of frames of a scene: scenes/temporal.
    Effect{"temporal-aa", "frames of a scene averaged, for smooth edges, after Karis 2014",
           kTemporalAa, nullptr},
    Effect{"refresh", "frames of a scene that each draw a part, and take the rest from before",
           kRefresh, nullptr},
    Effect{"reproject", "frames of a scene that are made from those before, in place of drawn",
           kReproject, nullptr},
    Effect{"edge-detection", "a pixel eight times, less its eight neighbours", {}, by_kernel},
    Effect{"sharpen", "a pixel five times, less the four beside it", {}, by_kernel},
    Effect{"box-3", "the mean of 3x3 pixels", {}, by_kernel, true},
    Effect{"gaussian-3", "3x3 pixels weighed by binomials", {}, by_kernel, true},
    Effect{"gaussian-5", "5x5 pixels weighed by binomials", {}, by_kernel, true},
    Effect{"gaussian", "a Gaussian of any width, along x and then along y", kGaussian, gaussian,
           true},
    Effect{"gaussian-at-once", "the same in one pass: the square of the reads", kGaussianAtOnce,
           gaussian_at_once, true},
    Effect{"bilateral", "a Gaussian that leaves out unlike colours and depths", kBilateral,
           bilateral_effect},
    Effect{"dual-filter", "a wide blur by halving the picture and doubling it again", kDualFilter,
           dual_filter_effect, true},
    Effect{"bloom", "bright light scattered over its surroundings, after Jimenez 2014", kBloom,
           bloom_effect},
    Effect{"bloom-gaussian", "bright light scattered by one Gaussian of the picture's own size",
           kBloomGaussian, bloom_gaussian_effect},
    Effect{"lens-flare", "ghosts, halo, streaks and rays of bright light, after Chapman 2013",
           kLensFlare, lens_flare_effect},
    Effect{"motion-blur-simple", "samples along each pixel's own motion",
           std::span{kMotionBlur}.first(2), motion_blur_along_own_effect, true, VelocityOf::all},
    Effect{"motion-blur-camera", "likewise, of the camera's motion alone, from the depth",
           std::span{kMotionBlur}.first(2), motion_blur_along_own_effect, true, VelocityOf::camera},
    Effect{"motion-blur-2012", "along the longest motion of the tiles around, McGuire et al. 2012",
           kMotionBlur, motion_blur_effect<MotionFilter::one_way>, true, VelocityOf::all},
    Effect{"motion-blur", "along that and along the pixel's own, after Guertin et al. 2014",
           kMotionBlur, motion_blur_effect<MotionFilter::two_ways>, true, VelocityOf::all},
    of_curve(kToneCurves[0]),
    of_curve(kToneCurves[1]),
    of_curve(kToneCurves[2]),
};

}  // namespace

std::span<const Effect> effects() { return kEffects; }

const Effect* find_effect(std::string_view name) {
  for (const Effect& effect : kEffects) {
    if (effect.name == name) return &effect;
  }
  return nullptr;
}

BilateralSettings bilateral_settings(std::span<const double> parameters) {
  return {parameters[0], static_cast<float>(parameters[1]), static_cast<float>(parameters[2])};
}

BloomSettings bloom_settings(std::span<const double> parameters) {
  const auto number = [&](std::size_t i) { return static_cast<float>(parameters[i]); };
  return {number(0), number(1),           number(2), static_cast<int>(parameters[3]),
          number(4), parameters[5] >= 0.5};
}

GaussianBloomSettings gaussian_bloom_settings(std::span<const double> parameters) {
  const auto number = [&](std::size_t i) { return static_cast<float>(parameters[i]); };
  return {number(0), number(1), number(2), parameters[3]};
}

LensFlareSettings lens_flare_settings(std::span<const double> parameters) {
  const auto number = [&](std::size_t i) { return static_cast<float>(parameters[i]); };
  LensFlareSettings settings{.threshold = number(0),
                             .knee = number(1),
                             .strength = number(3),
                             .ghosts = static_cast<int>(parameters[4]),
                             .aperture = number(9),
                             .fringe = number(5),
                             .halo = number(6),
                             .streak_px = number(7),
                             .rays = number(8)};
  if (parameters[2] > 0.0) settings.beyond_m = number(2);
  return settings;
}

MotionBlurSettings motion_blur_settings(std::span<const double> parameters, MotionFilter filter) {
  return {.shutter = static_cast<float>(parameters[0]),
          .samples = static_cast<int>(parameters[1]),
          .radius_px = static_cast<int>(parameters[2]),
          .depth = static_cast<float>(parameters[3]),
          .filter = filter};
}

DualFilterSettings dual_filter_settings(std::span<const double> parameters) {
  return {static_cast<int>(parameters[0]),
          parameters[1] >= 0.5 ? Widening::bilinear : Widening::tent};
}

void apply_into(const Effect& effect, const EffectInput& input, const ImageView& result,
                ThreadPool& pool) {
  assert(input.picture.format == Format::rgba16f && result.format == Format::rgba16f);
  assert(input.picture.width == result.width && input.picture.height == result.height);
  assert(input.parameters.size() == effect.parameters.size());
  assert(effect.filter != nullptr);
  assert(effect.velocity == VelocityOf::nothing ||
         (input.velocity.format == Format::rg16f && input.velocity.width == input.picture.width &&
          input.velocity.height == input.picture.height));
  const DefaultFloatEnvironment environment;
  effect.filter(effect, input, result, pool);
}

Image apply(const Effect& effect, const EffectInput& input, ThreadPool& pool) {
  Image result = make_image(Format::rgba16f, input.picture.width, input.picture.height);
  apply_into(effect, input, result, pool);
  return result;
}

}  // namespace softfocus
