#include "tools/gl/effect_passes.h"

#include <array>
#include <utility>

namespace softfocus {

const GlProgram& EffectPasses::program(std::string_view fragment, const std::string& defines) {
  const std::string all_defines = (quads_ ? "#define AS_QUAD\n" : "") + defines;
  const std::string name = std::string{fragment} + '\n' + all_defines;
  const auto found = programs_.find(name);
  if (found != programs_.end()) return found->second;
  return programs_
      .emplace(name, link_program(context_, shaders_, "fullscreen.vert", fragment, all_defines))
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
  if (used_targets_ == targets_.size()) targets_.emplace_back();
  GlTarget& target = targets_[used_targets_++];
  if (target.width != width || target.height != height) {
    target = make_target(std::array{Format::rgba16f}, width, height, false);
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
