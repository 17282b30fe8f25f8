#include "reference/accumulation.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>
#include <vector>

#include "dof/scratch_shelf.h"
#include "reference/lens_view.h"
#include "reference/take_samples.h"

namespace softfocus {
namespace {

// A group of samples of one tile, a row after the other.
struct TileSamples {
  std::array<std::vector<std::uint16_t>, kSampleGroup> texels;
};

constexpr std::size_t kTexelHalves = 4;

static_assert(kSumTile % kTileSize == 0);

void keep_tile(const Image& picture, const Rectangle& tile, std::vector<std::uint16_t>& texels) {
  texels.resize(std::size_t{kTileSize} * kTileSize * kTexelHalves);
  const auto begin = kTexelHalves * static_cast<std::size_t>(tile.x_begin);
  const auto count = kTexelHalves * static_cast<std::size_t>(tile.x_end - tile.x_begin);
  auto to = texels.begin();
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    const auto from = row<std::uint16_t>(picture, y).subspan(begin, count);
    to = std::copy(from.begin(), from.end(), to);
  }
}

void add_tile(const TileSamples& samples, std::size_t count, const Rectangle& tile,
              SampleSums& sums, Isa isa) {
  const int width = tile.x_end - tile.x_begin;
  std::array<const std::uint16_t*, kSampleGroup> rows{};
  for (std::size_t i = 0; i < count; ++i) rows[i] = samples.texels[i].data();
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    add_rows({rows.data(), count}, tile.x_begin, y, width, sums, isa);
    for (std::size_t i = 0; i < count; ++i) {
      rows[i] += kTexelHalves * static_cast<std::size_t>(width);
    }
  }
}

}  // namespace

SampledPicture accumulation(const SceneMethodInput& input, ThreadPool& pool) {
  AccumulationBuffer buffer = make_accumulation_buffer(input, pool);
  const auto add_samples = [&](int begin, int end, SampleSums& sums) {
    add_views(buffer, input, begin, end, sums, pool);
  };
  return take_samples(input, add_samples, pool);
}

AccumulationBuffer make_accumulation_buffer(const SceneMethodInput& input, ThreadPool& pool) {
  const int width = input.pinhole.width, height = input.pinhole.height;
  const Sampling& sampling = input.sampling;
  return {lens_points(sampling.aperture, sampling.samples),
          pixel_offsets(sampling.jitter, sampling.samples),
          prepare_scene(input.scene, input.profile, pool),
          make_image(Format::rgba16f, width, height),
          make_image(Format::r32f, width, height),
          {}};
}

void add_views(AccumulationBuffer& buffer, const SceneMethodInput& input, int begin, int end,
               SampleSums& sums, ThreadPool& pool) {
  const auto count = static_cast<std::size_t>(end - begin);
  assert(static_cast<std::size_t>(end) <= buffer.points.size());
  while (buffer.passes.size() < count) buffer.passes.emplace_back(buffer.prepared.pass);
  std::vector<TileLists> views;
  for (std::size_t i = 0; i < count; ++i) {
    RenderPass& pass = buffer.passes[i];
    pass.targets.colour[0] = &buffer.picture;  // the buffer may have moved
    pass.targets.depth = &buffer.depth;
    const std::size_t sample = static_cast<std::size_t>(begin) + i;
    const View view =
        lens_view(input.view, buffer.points[sample] * input.aperture_radius_m, input.focus_m,
                  buffer.offsets[sample], buffer.picture.width, buffer.picture.height);
    record_scene(buffer.prepared, view, input.frame, pass);
    views.push_back(sort_into_tiles(pass, pool));
  }
  ScratchShelf<TileSamples> shelf;
  pool.for_each(static_cast<int>(views[0].tiles.size()), [&](int tile) {
    TileSamples samples = shelf.take();
    const Rectangle area = tile_area(views[0], tile);
    for (std::size_t i = 0; i < count; ++i) {
      draw_tile(buffer.passes[i], views[i], tile);
      keep_tile(buffer.picture, area, samples.texels[i]);
    }
    add_tile(samples, count, area, sums, pool.isa());
    shelf.put_back(std::move(samples));
  });
  for (std::size_t i = 0; i < count; ++i) buffer.passes[i].draws.clear();
  sums.count += end - begin;
}

}  // namespace softfocus
