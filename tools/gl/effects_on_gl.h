#pragma once
// Image-space effects on a GL driver, with the project's shaders.

#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "raster/effects/effect_settings.h"
#include "raster/effects/tone_map.h"
#include "raster/images/image.h"
#include "raster/passes/kernel.h"
#include "tools/gl/objects.h"
#include "tools/gl/shaders.h"

namespace softfocus {

// Full-screen passes of an effect on a GL driver, one after the other.

/// Keeps programs, targets and tables: passes that are run again after begin(), in the same order,
/// make nothing anew. A pass's result is valid until begin().
class EffectPasses {
 public:
  EffectPasses(const GlContext& context, const Shaders& shaders)
      : context_(context), shaders_(shaders) {}

  void begin() { used_targets_ = used_tables_ = 0; }

  /// Draws two triangles in place of one, to measure it.
  void draw_quads(bool quads) { quads_ = quads; }
  void draw(const GlTarget& target, const GlProgram& program) const;

  /// With fullscreen.vert.
  const GlProgram& program(std::string_view fragment, const std::string& defines = {});
  /// With a vertex shader of its own, for points and triangles.
  const GlProgram& program_of(std::string_view vertex, std::string_view fragment,
                              const std::string& defines = {});
  /// RGBA16F, its pixels undefined.
  const GlTarget& target(int width, int height);
  const GlTarget& target(std::span<const Format> formats, int width, int height, bool with_depth);
  /// An image for texelFetch.
  const GlTexture& table(const Image& image);

 private:
  struct Table {
    Image image;
    GlTexture texture;
  };
  const GlContext& context_;
  const Shaders& shaders_;
  std::map<std::string, GlProgram, std::less<>> programs_;
  std::deque<GlTarget> targets_;
  std::deque<Table> tables_;
  bool quads_ = false;
  std::size_t used_targets_ = 0, used_tables_ = 0;
};

/// RGBA16F to be read, and its size.
struct GlPicture {
  const GlTexture& texture;
  int width;
  int height;
};

/// The colour of a target of one texture.
inline GlPicture picture_of(const GlTarget& target) {
  return {target.colour[0], target.width, target.height};
}

/// Each begins `passes`; the result is the target's one colour texture. As apply(). Throws
/// DriverError for an effect without a shader. The velocity is of the picture's size, RG16F;
/// effects that read none need none.
const GlTarget& effect_on_gl(EffectPasses& passes, const Effect& effect,
                             std::span<const double> parameters, const GlPicture& picture,
                             const GlTexture* velocity = nullptr);

const GlTarget& bloom_on_gl(EffectPasses& passes, const BloomSettings& settings,
                            const GlPicture& picture);
const GlTarget& bloom_by_gaussian_on_gl(EffectPasses& passes, const GaussianBloomSettings& settings,
                                        const GlPicture& picture);
const GlTarget& lens_flare_on_gl(EffectPasses& passes, const LensFlareSettings& settings,
                                 const GlPicture& picture);
const GlTarget& tone_map_on_gl(EffectPasses& passes, const ToneCurve& curve, float exposure,
                               const GlPicture& picture);
const GlTarget& bilateral_on_gl(EffectPasses& passes, const BilateralSettings& settings,
                                const GlPicture& picture);
const GlTarget& dual_filter_on_gl(EffectPasses& passes, int levels, Widening widening,
                                  const GlPicture& picture);

/// Passes of these, which begin nothing. The result is smaller by the guard band.
const GlTarget& convolved_on_gl(EffectPasses& passes, const Kernel& kernel,
                                const GlPicture& picture, glm::ivec2 guard = {0, 0});
const GlTarget& halved_on_gl(EffectPasses& passes, const GlPicture& above);
const GlTarget& widened_on_gl(EffectPasses& passes, const GlPicture& from, const GlPicture& own,
                              const Upsampling& how);

}  // namespace softfocus
