#include "tools/gl/maps_repeated_on_gl.h"

#include "tools/gl/maps_on_gl.h"

namespace softfocus {

struct MapsRepeatedOnGl::State {
  const Driver& driver;
  GlContext context;
  std::vector<GlMap> maps;
};

MapsRepeatedOnGl::MapsRepeatedOnGl(const Driver& driver, std::span<const MapCasters> maps,
                                   int threads) {
  naming(driver, [&] {
    state_.reset(new State{driver, GlContext{driver, threads}, {}});
    for (const MapCasters& map : maps) {
      state_->maps.push_back(make_gl_map(state_->context, Shaders{}, map.settings));
      for (const std::vector<CutCasters>& casters : map.sides) {
        add_side(state_->maps.back(), casters);
      }
    }
  });
}

MapsRepeatedOnGl::~MapsRepeatedOnGl() = default;

std::string MapsRepeatedOnGl::renderer() const {
  return state_->context.renderer() + ", OpenGL " + state_->context.version();
}

void MapsRepeatedOnGl::draw() {
  for (const GlMap& map : state_->maps) softfocus::draw(map);
  glFinish();
}

Image MapsRepeatedOnGl::nearness(std::size_t map, std::size_t side) const {
  return naming(state_->driver,
                [&] { return read_colour(state_->maps[map].sides[side].target, 0); });
}

}  // namespace softfocus
