#pragma once
// Full-screen passes of an effect on a GL driver, one after the other.

#include <deque>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "raster/images/image.h"
#include "tools/gl/objects.h"
#include "tools/gl/shaders.h"

namespace softfocus {

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

}  // namespace softfocus
