#include "tools/gl/effects_on_gl.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tools/gl/temporal_on_gl.h"

namespace softfocus {

const GlProgram& EffectPasses::program(std::string_view fragment, const std::string& defines) {
  return program_of("fullscreen.vert", fragment, (quads_ ? "#define AS_QUAD\n" : "") + defines);
}

const GlProgram& EffectPasses::program_of(std::string_view vertex, std::string_view fragment,
                                          const std::string& defines) {
  const std::string name = std::string{vertex} + '\n' + std::string{fragment} + '\n' + defines;
  const auto found = programs_.find(name);
  if (found != programs_.end()) return found->second;
  return programs_.emplace(name, link_program(context_, shaders_, vertex, fragment, defines))
      .first->second;
}

void EffectPasses::draw(const GlTarget& target, const GlProgram& program) const {
  if (quads_) {
    draw_fullscreen_quad(target, program);
  } else {
    draw_fullscreen(target, program);
  }
}

const GlTarget& EffectPasses::target(int width, int height) {
  return target(std::array{Format::rgba16f}, width, height, false);
}

const GlTarget& EffectPasses::target(std::span<const Format> formats, int width, int height,
                                     bool with_depth) {
  if (used_targets_ == targets_.size()) targets_.emplace_back();
  GlTarget& target = targets_[used_targets_++];
  if (target.width != width || target.height != height || (target.depth != 0) != with_depth ||
      !std::equal(target.formats.begin(), target.formats.end(), formats.begin(), formats.end())) {
    target = make_target(formats, width, height, with_depth);
  }
  return target;
}

const GlTexture& EffectPasses::table(const Image& image) {
  if (used_tables_ == tables_.size()) tables_.emplace_back();
  Table& table = tables_[used_tables_++];
  if (table.texture == 0 || table.image.format != image.format || !equal(table.image, image)) {
    table = {image, upload(image)};
  }
  return table.texture;
}

namespace {

const GlTarget& motion_on_gl(EffectPasses& passes, const Effect& effect,
                             std::span<const double> parameters, const GlMovingPicture& of) {
  if (effect.name == "motion-blur" || effect.name == "motion-blur-2012") {
    const MotionFilter filter =
        effect.name == "motion-blur" ? MotionFilter::two_ways : MotionFilter::one_way;
    return motion_blur_on_gl(passes, motion_blur_settings(parameters, filter), of);
  }
  return motion_blur_along_own_on_gl(passes, static_cast<float>(parameters[0]),
                                     static_cast<int>(parameters[1]), of);
}

void set_bright_pass(const GlProgram& program, const BrightPass& pass) {
  set_uniform(program, "threshold", pass.threshold);
  set_uniform(program, "begin", pass.begin);
  set_uniform(program, "double_knee", pass.double_knee);
  set_uniform(program, "square_factor", pass.square_factor);
  set_uniform(program, "beyond", pass.beyond);
}

const GlTarget& bright(EffectPasses& passes, const BrightPass& pass, const GlPicture& picture) {
  const GlTarget& target = passes.target(picture.width, picture.height);
  const GlProgram& program = passes.program("bloom_bright.frag");
  set_bright_pass(program, pass);
  set_uniform(program, "steady", pass.is_steady ? 1 : 0);
  set_texture(program, "source", 0, picture.texture);
  passes.draw(target, program);
  return target;
}

const GlTarget& added(EffectPasses& passes, const BrightPass& pass, float strength,
                      const GlPicture& picture, const GlTarget& scattered) {
  const GlTarget& result = passes.target(picture.width, picture.height);
  const GlProgram& program = passes.program("bloom_combine.frag");
  set_bright_pass(program, pass);
  set_uniform(program, "strength", strength);
  set_texture(program, "source", 0, picture.texture);
  set_texture(program, "scattered", 1, scattered.colour[0]);
  passes.draw(result, program);
  return result;
}

Image table_of(const Kernel& kernel) {
  Image table = make_image(Format::r32f, kernel.width, kernel.height);
  const float* weight = kernel.weights.data();
  for (int y = 0; y < table.height; ++y) {
    for (float& value : row<float>(table, y)) value = *weight++;
  }
  return table;
}

const GlTarget& spread(EffectPasses& passes, const GlTarget& light, float radius_px,
                       Kernel (*kernel)(float)) {
  if (radius_px <= kMostFlareRadiusPx) {
    return convolved_on_gl(passes, kernel(radius_px), picture_of(light));
  }
  const GlTarget& half = halved_on_gl(passes, picture_of(light));
  const GlTarget& wide = spread(passes, half, 0.5f * radius_px, kernel);
  return widened_on_gl(passes, picture_of(wide), picture_of(light), {});
}

const GlTarget& copied(EffectPasses& passes, const CopiesPass& pass, const GlTarget& source,
                       const GlTexture& own) {
  constexpr int kNumbers = 6;
  Image numbers = make_image(Format::r32f, kNumbers, static_cast<int>(pass.copies.size()));
  for (int y = 0; y < numbers.height; ++y) {
    const ScaledCopy& copy = pass.copies[static_cast<std::size_t>(y)];
    const std::array values{copy.scale.x,  copy.scale.y,  copy.scale.z,
                            copy.colour.x, copy.colour.y, copy.colour.z};
    std::copy(values.begin(), values.end(), row<float>(numbers, y).begin());
  }
  const GlTexture& copies = passes.table(numbers);
  const GlTarget& target = passes.target(source.width, source.height);
  const GlProgram& program = passes.program("scaled_copies.frag");
  set_uniform(program, "anchor_and_fade",
              glm::vec4{pass.anchor.x, pass.anchor.y, pass.fade.x, pass.fade.y});
  set_texture(program, "source", 0, source.colour[0]);
  set_texture(program, "own", 1, own);
  set_texture(program, "copies", 2, copies);
  passes.draw(target, program);
  return target;
}

}  // namespace

const GlTarget& convolved_on_gl(EffectPasses& passes, const Kernel& kernel,
                                const GlPicture& picture, glm::ivec2 guard) {
  // Weights as constants of the program's loop take less than fetches from a table, while they are
  // few.
  constexpr std::size_t kMostUniforms = 64;
  const bool as_uniforms = kernel.weights.size() <= kMostUniforms;
  const std::string defines = as_uniforms
                                  ? "#define COLUMNS " + std::to_string(kernel.width) +
                                        "\n#define ROWS " + std::to_string(kernel.height) + "\n"
                                  : "";
  const GlTarget& target = passes.target(picture.width - 2 * guard.x, picture.height - 2 * guard.y);
  const GlProgram& program = passes.program("kernel.frag", defines);
  set_texture(program, "source", 0, picture.texture);
  set_uniform(program, "guard", guard);
  if (as_uniforms) {
    set_uniform(program, "weights", kernel.weights);
  } else {
    set_texture(program, "weights", 1, passes.table(table_of(kernel)));
  }
  passes.draw(target, program);
  return target;
}

const GlTarget& halved_on_gl(EffectPasses& passes, const GlPicture& above) {
  const GlTarget& half = passes.target((above.width + 1) / 2, (above.height + 1) / 2);
  const GlProgram& program = passes.program("downsample.frag");
  set_texture(program, "source", 0, above.texture);
  passes.draw(half, program);
  return half;
}

const GlTarget& widened_on_gl(EffectPasses& passes, const GlPicture& from, const GlPicture& own,
                              const Upsampling& how) {
  const GlTarget& wider = passes.target(own.width, own.height);
  const std::string defines =
      std::string{how.widening == Widening::bilinear ? "#define BILINEAR\n" : ""} +
      (how.alone ? "#define ALONE\n" : "");
  const GlProgram& program = passes.program("upsample.frag", defines);
  set_texture(program, "source", 0, from.texture);
  set_texture(program, "own", 1, own.texture);
  set_uniform(program, "share", how.share);
  passes.draw(wider, program);
  return wider;
}

const GlTarget& bloom_on_gl(EffectPasses& passes, const BloomSettings& settings,
                            const GlPicture& picture) {
  passes.begin();
  const BrightPass pass = bright_pass_of(settings);
  std::vector<const GlTarget*> levels{&bright(passes, pass, picture)};
  for (int i = 0; i < settings.levels; ++i) {
    const GlTarget* half = &halved_on_gl(passes, picture_of(*levels.back()));
    if (i == 0 && pass.is_steady) {
      const GlTarget& mean = passes.target(half->width, half->height);
      const GlProgram& divide = passes.program("bloom_divide.frag");
      set_texture(divide, "source", 0, half->colour[0]);
      passes.draw(mean, divide);
      half = &mean;
    }
    levels.push_back(half);
  }
  for (std::size_t i = levels.size() - 1; i-- > 0;) {
    levels[i] = &widened_on_gl(passes, picture_of(*levels[i + 1]), picture_of(*levels[i]),
                               {i == 0 ? 1.0f : settings.spread});
  }
  return added(passes, pass, settings.strength, picture, *levels[0]);
}

const GlTarget& bloom_by_gaussian_on_gl(EffectPasses& passes, const GaussianBloomSettings& settings,
                                        const GlPicture& picture) {
  passes.begin();
  const BrightPass pass = bright_pass_of(settings);
  const std::vector<float> weights = gaussian_weights(settings.sigma_px);
  const GlTarget& light = bright(passes, pass, picture);
  const GlTarget& across = convolved_on_gl(passes, row_kernel(weights), picture_of(light));
  const GlTarget& wide = convolved_on_gl(passes, column_kernel(weights), picture_of(across));
  return added(passes, pass, settings.strength, picture, wide);
}

const GlTarget& dual_filter_on_gl(EffectPasses& passes, int levels, Widening widening,
                                  const GlPicture& picture) {
  passes.begin();
  std::vector<GlPicture> pictures{picture};
  for (int i = 0; i < levels; ++i) {
    pictures.push_back(picture_of(halved_on_gl(passes, pictures.back())));
  }
  const Upsampling how{.widening = widening, .alone = true};
  const GlTarget* wide = nullptr;
  for (std::size_t i = pictures.size() - 1; i-- > 0;) {
    wide = &widened_on_gl(passes, wide != nullptr ? picture_of(*wide) : pictures[i + 1],
                          pictures[i], how);
  }
  return *wide;
}

const GlTarget& lens_flare_on_gl(EffectPasses& passes, const LensFlareSettings& settings,
                                 const GlPicture& picture) {
  passes.begin();
  std::vector<const GlTarget*> levels{&bright(passes, bright_pass_of(settings), picture)};
  for (int i = 0; i < kFlareHalvings; ++i) {
    levels.push_back(&halved_on_gl(passes, picture_of(*levels.back())));
  }
  const GlTarget& light = *levels.back();
  const GlTexture& nothing = passes.table(make_image(Format::rgba16f, light.width, light.height));
  const GlTarget* flare = nullptr;
  const auto flare_or_nothing = [&]() -> const GlTexture& {
    return flare == nullptr ? nothing : flare->colour[0];
  };
  const auto radius_px = [&](float share) {
    return share * 0.5f * static_cast<float>(light.height);
  };
  if (settings.streak_px > 0.0f) {
    const float length = settings.streak_px / static_cast<float>(1 << kFlareHalvings);
    flare = &convolved_on_gl(passes, row_kernel(streak_weights(length)), picture_of(light));
  }
  if (settings.halo > 0.0f) {
    const GlTarget& halo = spread(passes, light, radius_px(settings.halo), halo_kernel);
    flare =
        &added(passes, kNothingBright, 1.0f, {flare_or_nothing(), light.width, light.height}, halo);
  }
  if (settings.rays > 0.0f) {
    const CopiesPass pass = rays_pass(settings.rays, middle_of_light(read_colour(light, 0)));
    const GlTarget& once = copied(passes, pass, light, nothing);
    flare = &copied(passes, pass, once, flare_or_nothing());
  }
  const CopiesPass ghosts = ghosts_pass(settings, light.width, light.height);
  if (!ghosts.copies.empty()) {
    const GlTarget& shape =
        settings.aperture > 0.0f
            ? spread(passes, light, radius_px(settings.aperture), aperture_kernel)
            : light;
    flare = &copied(passes, ghosts, shape, flare_or_nothing());
  }
  if (flare == nullptr) {
    flare = &bright(passes, kNothingBright, {nothing, light.width, light.height});
  }
  for (std::size_t i = kFlareHalvings; i-- > 0;) {
    flare = &widened_on_gl(passes, picture_of(*flare), picture_of(*levels[i]), {});
  }
  return added(passes, kNothingBright, settings.strength, picture, *flare);
}

const GlTarget& tone_map_on_gl(EffectPasses& passes, const ToneCurve& curve, float exposure,
                               const GlPicture& picture) {
  passes.begin();
  const GlTarget& result = passes.target(picture.width, picture.height);
  const GlProgram& program = passes.program("tone_map.frag");
  set_uniform(program, "exposure", exposure);
  set_uniform(program, "numerator", glm::vec3{curve.a, curve.b, curve.c});
  set_uniform(program, "denominator", glm::vec3{curve.d, curve.e, curve.f});
  set_uniform(program, "offset", curve.g);
  set_uniform(program, "factor", curve.h);
  set_texture(program, "source", 0, picture.texture);
  passes.draw(result, program);
  return result;
}

const GlTarget& bilateral_on_gl(EffectPasses& passes, const BilateralSettings& settings,
                                const GlPicture& picture) {
  passes.begin();
  const GlTarget& result = passes.target(picture.width, picture.height);
  const Kernel weights = row_kernel(gaussian_weights(settings.sigma_px));
  const GlProgram& program =
      passes.program("bilateral.frag", "#define TAPS " + std::to_string(weights.width) + "\n");
  set_texture(program, "source", 0, picture.texture);
  set_uniform(program, "weights", weights.weights);
  set_uniform(program, "colour_factor", bilateral_colour_factor(settings));
  set_uniform(program, "depth_tolerance", settings.depth_tolerance);
  passes.draw(result, program);
  return result;
}

const GlTarget& effect_on_gl(EffectPasses& passes, const Effect& effect,
                             std::span<const double> parameters, const GlPicture& picture,
                             const GlTexture* velocity) {
  if (velocity != nullptr) {
    return motion_on_gl(passes, effect, parameters,
                        {picture.texture, *velocity, picture.width, picture.height});
  }
  passes.begin();
  if (const Kernel* kernel = find_kernel(effect.name)) {
    return convolved_on_gl(passes, *kernel, picture);
  }
  if (const ToneCurve* curve = find_tone_curve(effect.name)) {
    return tone_map_on_gl(passes, *curve, static_cast<float>(parameters[0]), picture);
  }
  if (effect.name == "gaussian") {
    const std::vector<float> weights = gaussian_weights(parameters[0]);
    const GlTarget& across = convolved_on_gl(passes, row_kernel(weights), picture);
    return convolved_on_gl(passes, column_kernel(weights), picture_of(across));
  }
  if (effect.name == "gaussian-at-once") {
    return convolved_on_gl(passes, square_kernel(gaussian_weights(parameters[0])), picture);
  }
  if (effect.name == "bilateral") {
    return bilateral_on_gl(passes, bilateral_settings(parameters), picture);
  }
  if (effect.name == "dual-filter") {
    const auto [levels, widening] = dual_filter_settings(parameters);
    return dual_filter_on_gl(passes, levels, widening, picture);
  }
  if (effect.name == "bloom") return bloom_on_gl(passes, bloom_settings(parameters), picture);
  if (effect.name == "bloom-gaussian") {
    return bloom_by_gaussian_on_gl(passes, gaussian_bloom_settings(parameters), picture);
  }
  if (effect.name == "lens-flare") {
    return lens_flare_on_gl(passes, lens_flare_settings(parameters), picture);
  }
  throw DriverError("the effect " + std::string{effect.name} + " has no shader");
}

}  // namespace softfocus
