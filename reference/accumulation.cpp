#include "reference/accumulation.h"

#include <vector>

#include "reference/lens_view.h"
#include "reference/take_samples.h"
#include "scenes/draw_scene.h"

namespace softfocus {

SampledPicture accumulation(const SceneMethodInput& input, ThreadPool& pool) {
  const int width = input.pinhole.width, height = input.pinhole.height;
  const Sampling& sampling = input.sampling;
  const auto points = lens_points(sampling.aperture, sampling.samples);
  const auto offsets = pixel_offsets(sampling.jitter, sampling.samples);
  PreparedScene prepared = prepare_scene(input.scene, input.profile, pool);
  std::vector<Image> pictures;
  const auto add_samples = [&](int begin, int end, SampleSums& sums) {
    const auto count = static_cast<std::size_t>(end - begin);
    while (pictures.size() < count) pictures.push_back(make_image(Format::rgba16f, width, height));
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t sample = static_cast<std::size_t>(begin) + i;
      const View view = lens_view(input.view, points[sample] * input.aperture_radius_m,
                                  input.focus_m, offsets[sample], width, height);
      draw_scene(prepared, view, input.frame, pictures[i], pool);
    }
    add_pictures({pictures.data(), count}, sums, pool);
  };
  return take_samples(input, add_samples, pool);
}

}  // namespace softfocus
