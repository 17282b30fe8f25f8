#include "dof/transparent.h"

#include "raster/images/image.h"
#include "raster/passes/over.h"

namespace softfocus {

void lay_transparent_over(const DofInput& input, const ImageView& result,
                          const FilterPicture& filter, ThreadPool& pool) {
  if (input.transparent.empty()) return;
  const int width = input.scene.width, height = input.scene.height;
  Image colour = make_image(Format::rgba16f, width, height);
  Image opacity = make_image(Format::rgba16f, width, height);
  DofInput layer{.scene = input.scene, .settings = input.settings, .profile = input.profile};
  for (std::size_t i = input.transparent.size(); i-- > 0;) {
    layer.scene = input.transparent[i].colour;
    filter(layer, colour);
    layer.scene = input.transparent[i].opacity;
    filter(layer, opacity);
    pool.for_each(height, [&](int y) {
      std::uint16_t* below = row<std::uint16_t>(result, y).data();
      lay_over({row<std::uint16_t>(colour, y).data(), row<std::uint16_t>(opacity, y).data(), width},
               input.profile.half_store, below, pool.isa());
      take_depths(row<std::uint16_t>(input.transparent[i].opacity, y).data(), width, below,
                  pool.isa());
    });
  }
}

}  // namespace softfocus
