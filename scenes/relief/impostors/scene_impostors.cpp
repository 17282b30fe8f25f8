#include "scenes/relief/impostors/scene_impostors.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "scenes/draw/shadowed_layers.h"

namespace softfocus {
namespace {

constexpr int kLaidRows = 32;

ReliefForm form_of(const SceneImpostors& impostors, const ImpostorChoice& choice,
                   const CameraMatrices& camera, int height_px) {
  CameraMatrices from = camera;
  from.eye = choice.view.eye;
  ImpostorSettings settings;
  settings.projection = choice.view.projection;
  settings.texels_per_pixel = choice.texels_per_pixel;
  settings.depth_bits = 16;
  return impostor_form(impostors.maker, from, settings, choice.view.up, height_px);
}

std::optional<KeptRelief> new_relief(SceneImpostors& impostors, const ImpostorChoice& choice,
                                     const CameraMatrices& camera, double frame, int height_px,
                                     ThreadPool& pool) {
  ReliefMaker& maker = impostors.maker;
  const ImpostorObject& object = impostors.objects.all[choice.cell.object];
  maker.frame = frame;
  maker.points.clear();
  add_points(impostors.objects, object, maker.points);
  maker.chunks = chunks_of(maker.points);
  maker.middle = object.middle;
  maker.radius_m = object.radius_m;
  maker.prepared.hidden.assign(maker.scene->objects.size(), 1);
  for (std::size_t i = object.first; i < object.end; ++i) maker.prepared.hidden[i] = 0;
  const ReliefForm form = form_of(impostors, choice, camera, height_px);
  ReliefTexture relief =
      begin_relief(maker, relief_camera(maker, choice.view, form.width, form.height), form);
  draw_layers(maker.prepared,
              relief_matrices(relief.camera, form.width, form.height, choice.view.eye), frame,
              maker.picture, {}, pool);
  read_relief(maker, form, choice.view.eye, relief, pool);
  const std::optional<ReliefExtent> extent = relief_extent(relief);
  if (!extent) return {};
  return KeptRelief{std::move(relief), *extent};
}

std::size_t bytes_of(const SceneImpostors::Kept& kept) {
  std::size_t bytes = sizeof kept;
  if (!kept.relief) return bytes;
  const ReliefTexture& texture = kept.relief->texture;
  return bytes + texture.depths.size() * sizeof texture.depths[0] +
         texture.colours.size() * sizeof texture.colours[0];
}

/// Those that were used longest ago go, but none of this view.
void drop_old_reliefs(SceneImpostors& impostors) {
  const double most = impostors.maker.scene->impostors.memory_mb * 1e6;
  std::size_t sum = 0;
  for (const auto& [cell, kept] : impostors.kept) sum += bytes_of(kept);
  while (static_cast<double>(sum) > most) {
    auto oldest = impostors.kept.end();
    for (auto at = impostors.kept.begin(); at != impostors.kept.end(); ++at) {
      if (at->second.used == impostors.views) continue;
      if (oldest == impostors.kept.end() || at->second.used < oldest->second.used) oldest = at;
    }
    if (oldest == impostors.kept.end()) break;
    sum -= bytes_of(oldest->second);
    impostors.kept.erase(oldest);
  }
  impostors.counts.bytes = sum;
}

ThreadPool& alone(SceneImpostors::Worker& worker, Isa isa) {
  if (worker.alone == nullptr) worker.alone = std::make_unique<ThreadPool>(1, isa);
  return *worker.alone;
}

/// Warps the reliefs of a view.
void warp_all(SceneImpostors& impostors, std::span<const KeptRelief* const> reliefs,
              const CameraMatrices& camera, int width, int height, ThreadPool& pool) {
  impostors.shown_count = reliefs.size();
  if (impostors.shown.size() < reliefs.size()) impostors.shown.resize(reliefs.size());
  for_each_with(impostors.workers, pool, static_cast<int>(reliefs.size()),
                [&](int number, SceneImpostors::Worker& worker) {
                  const auto i = static_cast<std::size_t>(number);
                  const KeptRelief& relief = *reliefs[i];
                  SceneImpostors::Shown& shown = impostors.shown[i];
                  const PlaneRectangle place =
                      *warped_extent(relief.texture, relief.extent, camera.eye);
                  warp_relief(relief.texture, relief.extent, camera.eye, place, WarpRule{},
                              shown.warped, alone(worker, pool.isa()));
                  shown.mapping = plane_mapping(relief.texture, camera, place, width, height);
                });
}

std::vector<std::uint8_t> prepare_view(SceneImpostors& impostors, const CameraMatrices& camera,
                                       double frame, int width, int height, ThreadPool& pool) {
  ++impostors.views;
  if (impostors.shadows_move && impostors.frame != frame) impostors.kept.clear();
  impostors.frame = frame;
  ImpostorChoices choices = impostor_choices(impostors.objects, camera, frame, height);
  ImpostorCounts& counts = choices.counts;
  std::vector<const KeptRelief*> reliefs;
  for (const ImpostorChoice& choice : choices.chosen) {
    const auto [place, is_new] = impostors.kept.try_emplace(choice.cell);
    SceneImpostors::Kept& kept = place->second;
    kept.used = impostors.views;
    if (is_new) {
      kept.relief = new_relief(impostors, choice, camera, frame, height, pool);
      ++counts.renewed;
      counts.renewed_texels += choice.texels;
      counts.renewed_triangles +=
          static_cast<double>(impostors.objects.all[choice.cell.object].triangles);
    }
    if (!kept.relief) continue;
    if (warped_extent(kept.relief->texture, kept.relief->extent, camera.eye)) {
      reliefs.push_back(&*kept.relief);
    } else {
      leave_as_geometry(impostors.objects, choice, choices);
    }
  }
  counts.shown = static_cast<int>(reliefs.size());
  impostors.counts = counts;
  drop_old_reliefs(impostors);
  warp_all(impostors, reliefs, camera, width, height, pool);
  return std::move(choices.hidden);
}

// --- laying them into layers ---

Rectangle rows_of(const Rectangle& area, int first, int end) {
  return {area.x_begin, std::max(area.y_begin, first), area.x_end, std::min(area.y_end, end)};
}

std::uint16_t* texel_at(Image& image, int x, int y) {
  return row<std::uint16_t>(image, y).data() + kTexelHalves * static_cast<std::size_t>(x);
}

/// Where an impostor's share of the pixel ends, what lay there before shows, and the other way
/// round where its share is the smaller. Returns whether the impostor has the pixel's centre.
bool set_edge(const std::uint16_t* texel, float share, const std::uint16_t* first,
              EdgePictures& edges, int x, int y) {
  const bool has_centre = share >= 0.5f;
  const bool is_nearer = texel[3] < first[3];
  if (!is_nearer) return has_centre;
  std::uint8_t& coverage = row<std::uint8_t>(edges.coverage, y)[static_cast<std::size_t>(x)];
  const float others = has_centre ? 1.0f - share : share;
  const auto byte = static_cast<std::uint8_t>(others * 255.0f + 0.5f);
  if (!has_centre && byte <= coverage) return false;
  coverage = byte;
  std::copy_n(has_centre ? first : texel, kTexelHalves, texel_at(edges.other, x, y));
  return has_centre;
}

/// Puts a pixel among the layers, by its depth. Returns whether it is the first.
bool insert_pixel(const std::uint16_t* texel, std::span<Image* const> layers, int x, int y) {
  std::array<std::uint16_t, kTexelHalves> carried;
  std::copy_n(texel, kTexelHalves, carried.begin());
  bool is_in = false, is_first = false;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    std::uint16_t* at = texel_at(*layers[i], x, y);
    // Depths are positive halves, whose bits have their order.
    if (!is_in && carried[3] >= at[3]) continue;
    is_first = is_first || (!is_in && i == 0);
    is_in = true;
    for (std::size_t c = 0; c < kTexelHalves; ++c) std::swap(carried[c], at[c]);
  }
  return is_first;
}

/// What a view's impostors are laid into.
struct LaidInto {
  std::span<Image* const> layers;
  EdgePictures* edges;
  std::span<std::uint8_t> changed;
  std::uint16_t far;  ///< a half: scratch that shows nothing
};

/// Lays an area of one of them by way of the scratch.
void lay_area(SceneImpostors& impostors, const SceneImpostors::Shown& shown,
              const PlaneMapping& mapping, const LaidInto& into, ThreadPool& pool) {
  const Rectangle& area = mapping.area;
  Image& scratch = impostors.scratch;
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) texel_at(scratch, x, y)[3] = into.far;
  }
  map_relief(shown.warped, mapping, scratch, pool,
             into.edges != nullptr ? &impostors.shares : nullptr);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    for (int x = area.x_begin; x < area.x_end; ++x) {
      const std::uint16_t* texel = texel_at(scratch, x, y);
      if (texel[3] == into.far) continue;
      if (into.edges != nullptr) {
        const float share = row<float>(impostors.shares, y)[static_cast<std::size_t>(x)];
        const std::uint16_t* first = texel_at(*into.layers[0], x, y);
        if (!set_edge(texel, share, first, *into.edges, x, y)) continue;
      }
      if (!insert_pixel(texel, into.layers, x, y) || into.changed.empty()) continue;
      into.changed[static_cast<std::size_t>(y) * static_cast<std::size_t>(scratch.width) +
                   static_cast<std::size_t>(x)] = 1;
    }
  }
}

void size_scratch(SceneImpostors& impostors, int width, int height) {
  if (impostors.scratch.width == width && impostors.scratch.height == height) return;
  impostors.scratch = make_image(Format::rgba16f, width, height);
  impostors.shares = make_image(Format::r32f, width, height);
}

void lay(SceneImpostors& impostors, std::span<Image* const> layers, EdgePictures* edges,
         std::span<std::uint8_t> changed, ThreadPool& pool) {
  const int width = layers[0]->width, height = layers[0]->height;
  const bool is_direct = layers.size() == 1 && edges == nullptr && changed.empty();
  if (!is_direct) size_scratch(impostors, width, height);
  const LaidInto into{
      layers, edges, changed,
      float_to_half(clear_colour(*impostors.maker.scene).w, HalfRounding::nearest_even)};
  const int bands = (height + kLaidRows - 1) / kLaidRows;
  for_each_with(impostors.workers, pool, bands, [&](int band, SceneImpostors::Worker& worker) {
    const int first = band * kLaidRows, end = std::min(first + kLaidRows, height);
    ThreadPool& one = alone(worker, pool.isa());
    for (std::size_t i = 0; i < impostors.shown_count; ++i) {
      const SceneImpostors::Shown& shown = impostors.shown[i];
      PlaneMapping mapping = shown.mapping;
      mapping.area = rows_of(mapping.area, first, end);
      if (mapping.area.y_begin >= mapping.area.y_end) continue;
      if (is_direct) {
        map_relief(shown.warped, mapping, *layers[0], one);
      } else {
        lay_area(impostors, shown, mapping, into, one);
      }
    }
  });
}

}  // namespace

bool has_impostors(const Scene& scene) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [](const Object& object) { return object.impostor != ImpostorUse::never; });
}

std::shared_ptr<SceneImpostors> make_scene_impostors(const Scene& scene, ThreadPool& pool) {
  auto impostors = std::make_shared<SceneImpostors>();
  impostors->objects = impostor_objects(scene);
  impostors->maker = relief_maker(scene, pool);
  impostors->maker.prepared.keeps_depth = true;
  impostors->shadows_move =
      has_shadows(scene) && std::any_of(scene.objects.begin(), scene.objects.end(),
                                        [](const Object& object) { return moves(object); });
  return impostors;
}

std::shared_ptr<const StandIns> stand_ins_of(const std::shared_ptr<SceneImpostors>& impostors) {
  auto stand_ins = std::make_shared<StandIns>();
  stand_ins->prepare = [impostors](const CameraMatrices& camera, double frame, int width,
                                   int height, ThreadPool& pool) {
    return prepare_view(*impostors, camera, frame, width, height, pool);
  };
  stand_ins->lay = [impostors](std::span<Image* const> layers, EdgePictures* edges,
                               std::span<std::uint8_t> changed,
                               ThreadPool& pool) { lay(*impostors, layers, edges, changed, pool); };
  return stand_ins;
}

}  // namespace softfocus
