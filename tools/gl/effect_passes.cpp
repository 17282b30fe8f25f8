#include "tools/gl/effect_passes.h"

#include <algorithm>
#include <array>
#include <utility>

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

}  // namespace softfocus
