#include "scenes/lens_views/accumulation.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <utility>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/lens_views/few_pixel_offsets.h"
#include "scenes/lens_views/lens_points.h"
#include "scenes/lens_views/samples_by_tile.h"
#include "scenes/lens_views/shutter_times.h"

namespace softfocus {

CameraMatrices lens_camera(const CameraMatrices& pinhole, glm::dvec2 lens_point_m, double focus_m,
                           glm::dvec2 offset_px, int width_px, int height_px) {
  CameraMatrices moved = pinhole;
  const double size_px[] = {static_cast<double>(width_px), static_cast<double>(height_px)};
  for (int axis = 0; axis < 2; ++axis) {
    moved.world_to_eye[3][axis] -= lens_point_m[axis];
    const double shear = pinhole.eye_to_clip[axis][axis] * lens_point_m[axis] / focus_m -
                         2.0 * offset_px[axis] / size_px[axis];
    moved.eye_to_clip[2][axis] -= shear;  // w = -z_eye
    // Rows of the matrix are the camera's axes in the world.
    for (int i = 0; i < 3; ++i) moved.eye[i] += pinhole.world_to_eye[i][axis] * lens_point_m[axis];
  }
  return moved;
}

namespace {

// Two sets of four points can agree by chance.
constexpr int kFirstComparison = 16;

bool is_power_of_two(int n) { return std::has_single_bit(static_cast<unsigned>(n)); }

}  // namespace

SampledPicture take_samples(const LensViewInput& input, const AddSamples& add_samples, int step,
                            ThreadPool& pool) {
  const Sampling& sampling = input.sampling;
  SampleSums own;
  SampleSums& sums = input.begun != nullptr ? *input.begun : own;
  if (sums.count == 0) sums = make_sample_sums(input.pinhole.width, input.pinhole.height);
  SampleSums first_half;
  SampledPicture result;
  while (sums.count < sampling.samples) {
    // Small steps up to the first comparison, which needs the first half.
    const int next = sums.count + (sums.count < kFirstComparison ? kSampleGroup : step);
    add_samples(sums.count, std::min(next, sampling.samples), sums);
    if (input.progress) input.progress(sums.count);
    if (!sampling.until || !is_power_of_two(sums.count)) continue;
    if (sums.count >= kFirstComparison) {
      result.half_set_rms = half_set_rms(first_half, sums, pool);
      if (*result.half_set_rms <= *sampling.until) break;
    }
    first_half = sums;
  }
  result.samples = sums.count;
  result.picture = mean_picture(sums, input.pinhole, input.profile, pool);
  return result;
}

namespace {

constexpr std::size_t kTileHalves = std::size_t{kTileSize} * kTileSize * kTexelHalves;

// A group of samples of one tile, each a row after the other.
struct TileSamples {
  std::vector<std::uint16_t> halves = std::vector<std::uint16_t>(kLensViewGroup * kTileHalves);
  TileMemory memory;
};

std::uint16_t* texels_of(TileSamples& samples, std::size_t i) {
  return samples.halves.data() + i * kTileHalves;
}

static_assert(kSumTile % kTileSize == 0);

void add_tile(TileSamples& samples, std::size_t first, std::size_t count, const Rectangle& tile,
              SampleSums& sums, Isa isa) {
  const int width = tile.x_end - tile.x_begin;
  std::array<const std::uint16_t*, kSampleGroup> rows{};
  for (std::size_t i = 0; i < count; ++i) rows[i] = texels_of(samples, first + i);
  for (int y = tile.y_begin; y < tile.y_end; ++y) {
    add_rows({rows.data(), count}, tile.x_begin, y, width, sums, isa);
    for (std::size_t i = 0; i < count; ++i) {
      rows[i] += kTexelHalves * static_cast<std::size_t>(width);
    }
  }
}

}  // namespace

SampledPicture accumulation(const LensViewInput& input, ThreadPool& pool) {
  LensViewMemory own;
  std::shared_ptr<AccumulationBuffer>& buffer =
      (input.memory != nullptr ? *input.memory : own).accumulation;
  if (!buffer) {
    buffer = std::make_shared<AccumulationBuffer>(make_accumulation_buffer(input, pool));
  }
  return accumulation(*buffer, input, pool);
}

SampledPicture accumulation(AccumulationBuffer& buffer, const LensViewInput& input,
                            ThreadPool& pool) {
  if (input.sampling.by_tile) return accumulation_by_tile(buffer, input, pool);
  place_views(buffer, input.sampling);
  const auto add_samples = [&](int begin, int end, SampleSums& sums) {
    add_lens_views(buffer, input, begin, end, sums, pool);
  };
  return take_samples(input, add_samples, kLensViewGroup, pool);
}

std::vector<glm::dvec2> view_points(const Sampling& sampling) {
  return sampling.until ? lens_points(sampling.aperture, sampling.samples)
                        : lens_points_for(sampling.aperture, sampling.samples);
}

void place_views(AccumulationBuffer& buffer, const Sampling& sampling) {
  buffer.points = view_points(sampling);
  buffer.offsets = sampling.until ? pixel_offsets(sampling.jitter, sampling.samples)
                                  : view_offsets(sampling.jitter, buffer.points);
  buffer.times.clear();
  if (sampling.shutter_frames == 0.0) return;
  buffer.times = times_in_frames(sampling.until ? shutter_sequence(sampling.samples)
                                                : shutter_times(buffer.points, buffer.offsets),
                                 sampling.shutter_frames);
}

std::vector<double> times_in_frames(std::vector<double> parts, double shutter_frames) {
  for (double& part : parts) part *= shutter_frames;
  return parts;
}

AccumulationBuffer make_accumulation_buffer(const LensViewInput& input, ThreadPool& pool) {
  const int width = input.pinhole.width, height = input.pinhole.height;
  const Sampling& sampling = input.sampling;
  AccumulationBuffer buffer{
      lens_points(sampling.aperture, sampling.samples),
      pixel_offsets(sampling.jitter, sampling.samples),
      sampling.shutter_frames == 0.0
          ? std::vector<double>{}
          : times_in_frames(shutter_sequence(sampling.samples), sampling.shutter_frames),
      input.prepared != nullptr ? std::move(*input.prepared)
                                : prepare_scene(input.scene, input.profile, pool),
      make_image(Format::rgba16f, width, height),
      make_image(Format::r32f, width, height),
      {},
      {},
      {},
      {},
      {},
      {}};
  buffer.prepared.stand_ins = input.stand_ins;
  return buffer;
}

namespace {

RenderPass& pass_of(std::vector<RenderPass>& passes, std::size_t i, const PreparedScene& prepared) {
  if (i == passes.size()) {
    passes.emplace_back();
    passes[i].profile = prepared.pass.profile;
    passes[i].isa = prepared.pass.isa;
  }
  return passes[i];
}

// Makes passes, targets and lists for the transparent surfaces of `count` views.
void make_transparent_passes(AccumulationBuffer& buffer, std::size_t count) {
  if (buffer.transparent.depth[0].width == 0) {
    buffer.transparent = make_transparent_targets(buffer.picture.width, buffer.picture.height);
  }
  for (std::size_t i = 0; i < count; ++i) {
    set_targets(buffer.transparent, pass_of(buffer.transparent_passes, i, buffer.prepared));
  }
  if (buffer.transparent_lists.size() < count) buffer.transparent_lists.resize(count);
}

// The pinhole camera at another time than the picture's.
CameraMatrices camera_at(const LensViewInput& input, double frame) {
  const Camera& camera = input.scene.camera;
  if (frame == input.frame || !moves(camera)) return input.camera;
  return camera_matrices(camera, frame, input.pinhole.width, input.pinhole.height);
}

// When and from where a sample sees the scene.
struct LensView {
  double frame;
  CameraMatrices camera;
};

LensView lens_view(const AccumulationBuffer& buffer, const LensViewInput& input,
                   std::size_t sample) {
  const double frame = input.frame + (buffer.times.empty() ? 0.0 : buffer.times[sample]);
  return {frame, lens_camera(camera_at(input, frame),
                             buffer.points[sample] * input.aperture_radius_m, input.focus_m,
                             buffer.offsets[sample], buffer.picture.width, buffer.picture.height)};
}

// A view's shadows are found from all of its pixels, and so are stand-ins.
bool is_drawn_whole(const PreparedScene& prepared) {
  return prepared.shadows != nullptr || prepared.stand_ins != nullptr;
}

// With stand-ins, and what is transparent before them.
bool has_transparent_passes(const PreparedScene& prepared) {
  return prepared.has_transparent && prepared.stand_ins == nullptr;
}

void draw_whole_views(AccumulationBuffer& buffer, const LensViewInput& input, std::size_t begin,
                      std::size_t count, ThreadPool& pool) {
  const int width = buffer.picture.width, height = buffer.picture.height;
  while (buffer.whole.size() < count) {
    buffer.whole.push_back(make_image(Format::rgba16f, width, height));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const LensView view = lens_view(buffer, input, begin + i);
    if (buffer.prepared.stand_ins != nullptr) {
      draw_scene(buffer.prepared, view.camera, view.frame, buffer.whole[i], pool);
    } else {
      draw_layers(buffer.prepared, view.camera, view.frame, buffer.whole[i], {}, pool);
    }
  }
}

void copy_tile(const Image& from, const Rectangle& area, std::byte* texels) {
  const std::size_t bytes =
      kTexelHalves * sizeof(std::uint16_t) * static_cast<std::size_t>(area.x_end - area.x_begin);
  for (int y = area.y_begin; y < area.y_end; ++y, texels += bytes) {
    std::memcpy(
        texels,
        row<std::uint16_t>(from, y).data() + kTexelHalves * static_cast<std::size_t>(area.x_begin),
        bytes);
  }
}

}  // namespace

void sort_lens_views(AccumulationBuffer& buffer, const LensViewInput& input, int begin, int end,
                     ThreadPool& pool) {
  const auto count = static_cast<std::size_t>(end - begin);
  assert(end - begin <= kLensViewGroup);
  assert(static_cast<std::size_t>(end) <= buffer.points.size());
  assert(buffer.times.empty() || static_cast<std::size_t>(end) <= buffer.times.size());
  const bool has_transparent = has_transparent_passes(buffer.prepared);
  const bool is_whole = is_drawn_whole(buffer.prepared);
  if (is_whole) {
    draw_whole_views(buffer, input, static_cast<std::size_t>(begin), count, pool);
  }
  for (std::size_t i = 0; i < count; ++i) pass_of(buffer.passes, i, buffer.prepared);
  if (has_transparent) make_transparent_passes(buffer, count);
  if (buffer.tile_lists.size() < count) buffer.tile_lists.resize(count);
  const std::span passes = std::span{buffer.passes}.first(count);
  const std::span tile_lists = std::span{buffer.tile_lists}.first(count);
  pool.for_each(static_cast<int>(count), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    passes[i].targets.colour[0] = &buffer.picture;  // the buffer may have moved
    passes[i].targets.depth = &buffer.depth;
    const auto& [frame, camera] = lens_view(buffer, input, static_cast<std::size_t>(begin) + i);
    // What is transparent is blended tile by tile, by the depths of what is not.
    if (!is_whole || has_transparent) record_scene(buffer.prepared, camera, frame, passes[i]);
    if (!has_transparent) return;
    record_transparent(buffer.prepared, camera, frame, buffer.transparent_passes[i]);
  });
  sort_into_tiles(passes, tile_lists, pool);
  if (!has_transparent) return;
  sort_into_tiles(std::span{buffer.transparent_passes}.first(count),
                  std::span{buffer.transparent_lists}.first(count), pool);
}

void draw_view_tile(AccumulationBuffer& buffer, std::size_t i, int tile, TileMemory& memory,
                    std::byte* texels) {
  const bool is_whole = is_drawn_whole(buffer.prepared);
  const bool has_transparent = has_transparent_passes(buffer.prepared);
  if (!is_whole || has_transparent) {
    draw_tile_aside(buffer.passes[i], buffer.tile_lists[i], tile, memory, texels);
  }
  if (is_whole) copy_tile(buffer.whole[i], tile_area(buffer.tile_lists[i], tile), texels);
  if (!has_transparent) return;
  const RenderPass& pass = buffer.transparent_passes[i];
  const std::size_t layers = draw_transparent_tile(pass, buffer.transparent_lists[i], tile,
                                                   buffer.depth, buffer.transparent, memory);
  const Rectangle area = tile_area(buffer.tile_lists[i], tile);
  blend_transparent_tile(
      buffer.transparent, layers, buffer.depth, area,
      depths_in_metres(buffer.prepared.scene->camera), pass.profile, pass.isa, texels,
      kTexelHalves * sizeof(std::uint16_t) * static_cast<std::size_t>(area.x_end - area.x_begin));
}

void clear_lens_views(AccumulationBuffer& buffer) {
  for (RenderPass& pass : buffer.passes) pass.draws.clear();
  for (RenderPass& pass : buffer.transparent_passes) pass.draws.clear();
}

void add_lens_views(AccumulationBuffer& buffer, const LensViewInput& input, int begin, int end,
                    SampleSums& sums, ThreadPool& pool, std::span<const int> tiles,
                    const LookAtTile& look) {
  assert(begin % kSampleGroup == 0);
  sort_lens_views(buffer, input, begin, end, pool);
  const auto count = static_cast<std::size_t>(end - begin);
  const std::vector<TileLists>& tile_lists = buffer.tile_lists;
  const int drawn = tiles.empty() ? tile_count(tile_lists[0]) : static_cast<int>(tiles.size());
  for_each_with<TileSamples>(pool, drawn, [&](int number, auto& samples) {
    const int tile = tiles.empty() ? number : tiles[static_cast<std::size_t>(number)];
    const Rectangle area = tile_area(tile_lists[0], tile);
    for (std::size_t i = 0; i < count; ++i) {
      draw_view_tile(buffer, i, tile, samples.memory,
                     reinterpret_cast<std::byte*>(texels_of(samples, i)));
    }
    if (look) {
      std::array<const std::uint16_t*, kLensViewGroup> views{};
      for (std::size_t i = 0; i < count; ++i) views[i] = texels_of(samples, i);
      look(tile, area, {views.data(), count});
    }
    // The first group fetches the sums from memory; the second finds them in the cache.
    for (std::size_t first = 0; first < count; first += kSampleGroup) {
      add_tile(samples, first, std::min<std::size_t>(count - first, kSampleGroup), area, sums,
               pool.isa());
    }
  });
  clear_lens_views(buffer);
  sums.count += end - begin;
}

}  // namespace softfocus
