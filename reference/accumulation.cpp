#include "reference/accumulation.h"

#include <cassert>

#include "reference/lens_view.h"
#include "reference/take_samples.h"

namespace softfocus {

SampledPicture accumulation(const SceneMethodInput& input, ThreadPool& pool) {
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  const auto add_samples = [&](int begin, int end, SampleSums& sums) {
    add_views(buffer, input, begin, end, sums, pool);
  };
  return take_samples(input, add_samples, pool);
}

AccumulationBuffer make_accumulation_buffer(const SceneMethodInput& input, ThreadPool& pool) {
  const Sampling& sampling = input.sampling;
  return {lens_points(sampling.aperture, sampling.samples),
          pixel_offsets(sampling.jitter, sampling.samples),
          prepare_scene(input.scene, input.profile, pool),
          {}};
}

void add_views(AccumulationBuffer& buffer, const SceneMethodInput& input, int begin, int end,
               SampleSums& sums, ThreadPool& pool) {
  const int width = input.pinhole.width, height = input.pinhole.height;
  const auto count = static_cast<std::size_t>(end - begin);
  assert(static_cast<std::size_t>(end) <= buffer.points.size());
  while (buffer.pictures.size() < count) {
    buffer.pictures.push_back(make_image(Format::rgba16f, width, height));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t sample = static_cast<std::size_t>(begin) + i;
    const View view = lens_view(input.view, buffer.points[sample] * input.aperture_radius_m,
                                input.focus_m, buffer.offsets[sample], width, height);
    draw_scene(buffer.prepared, view, input.frame, buffer.pictures[i], pool);
  }
  add_pictures({buffer.pictures.data(), count}, sums, pool);
}

}  // namespace softfocus
