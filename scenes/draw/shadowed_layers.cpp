#include "scenes/draw/shadowed_layers.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstring>
#include <utility>

#include "raster/threads/loops.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/draw/light_points.h"
#include "scenes/shadows/shadow_truth.h"

namespace softfocus {
namespace {

bool mirrors(const glm::dmat4& m) {
  return dot(glm::dvec3{m[0]}, cross(glm::dvec3{m[1]}, glm::dvec3{m[2]})) < 0.0;
}

bool has_cut_outs(const Material& material, const Mesh& mesh) {
  return material.opacity_texture && !mesh.uvs.empty() && material.cut_out;
}

// Another kind of shadows' dark sides, alone.
ProjectedShadows without_triangles(const Facets& facets, const ShadowLight& light) {
  return {lit_sides(facets, light), std::vector<std::size_t>(facets.receivers.size() + 1), {}};
}

bool is_projected(const SceneShadows& shadows, ShadowKind kind) {
  return kind == ShadowKind::projected && !shadows.by_rays;
}

// Of one light, that has come or has moved; projected onto what the view shows, or onto all.
void place_light(SceneShadows& shadows, std::size_t i, ShadowKind kind, const ShadowLight& light,
                 bool is_of_view, ThreadPool& pool) {
  // Set last: if memory runs out in between, the next frame makes all of it again.
  shadows.placed[i].reset();
  for (std::vector<KeptBits>& of_layer : shadows.kept_bits) of_layer[i] = {};
  if (!is_projected(shadows, kind)) {
    shadows.projected[i] = without_triangles(shadows.facets, light);
  } else if (is_of_view) {
    shadows.projected[i] = project_onto(*shadows.wanted, shadows.facets, light, pool);
  } else {
    shadows.projected[i] = project_by_grid(shadows.facets, light, pool);
  }
  shadows.maps[i] = {};
  shadows.volumes[i] = {};
  if (kind == ShadowKind::volumes) {
    shadows.volumes[i] = make_shadow_volumes(shadows.facets, shadows.joined, light);
  }
  shadows.placed[i] = light;
}

// Draws projected shadows, dark sides and volumes of the lights that have moved, and takes the
// others' bits of the frame before.
void draw_bits(SceneShadows& shadows, std::size_t layer, const ShadowView& view, glm::dvec3 eye,
               ThreadPool& pool) {
  std::vector<std::uint8_t>& mask = shadows.masks[layer];
  std::vector<KeptBits>& kept = shadows.kept_bits[layer];
  std::vector<const ProjectedShadows*> moved(kept.size());
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (kept[i].mask.empty()) moved[i] = &shadows.projected[i];
  }
  draw_shadow_mask(cut_shadows(shadows.facets, moved, shadows.seen[layer], view, pool), view, mask,
                   pool);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    const auto bit = static_cast<std::uint8_t>(1u << i);
    if (moved[i] != nullptr && !shadows.volumes[i].casters.empty()) {
      kept[i].rays = draw_volume_mask(shadows.facets, shadows.joined, shadows.volumes[i],
                                      shadows.projected[i].lit, bit, shadows.seen[layer], view, eye,
                                      shadows.volume_count, mask, pool);
    }
    shadows.volume_rays += kept[i].rays;
    const bool is_costly =
        !shadows.projected[i].triangles.empty() || !shadows.volumes[i].casters.empty();
    const bool is_kept = moved[i] != nullptr && shadows.view_stays && is_costly;
    if (moved[i] != nullptr && !is_kept) continue;
    if (is_kept) kept[i].mask.resize(mask.size());
    pool.for_each(view.height, [&](int y) {
      const std::size_t begin = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width);
      for (std::size_t p = begin; p < begin + static_cast<std::size_t>(view.width); ++p) {
        if (is_kept) {
          kept[i].mask[p] = mask[p] & bit;
        } else {
          mask[p] |= kept[i].mask[p];
        }
      }
    });
  }
}

bool has_terminators(std::span<const Light> lights, const SceneShadows& shadows) {
  return std::any_of(shadows.lights.begin(), shadows.lights.end(), [&](std::size_t number) {
    return lights[number].terminator != Terminator::facets;
  });
}

std::vector<const ProjectedShadows*> pointers_to(const std::vector<ProjectedShadows>& projected) {
  std::vector<const ProjectedShadows*> of_lights;
  of_lights.reserve(projected.size());
  for (const ProjectedShadows& of_light : projected) of_lights.push_back(&of_light);
  return of_lights;
}

ShadowView shadow_view(const CameraMatrices& camera, int width, int height,
                       const Profile& profile) {
  return {multiply(camera.eye_to_clip, camera.world_to_eye), width, height, profile};
}

void draw_masks_by_rays(SceneShadows& shadows, const ShadowView& view, glm::dvec3 eye,
                        ThreadPool& pool) {
  shadows.masks.resize(shadows.seen.size());
  for (std::size_t layer = 0; layer < shadows.seen.size(); ++layer) {
    shadows.masks[layer].assign(shadows.seen[layer].size(), 0);
  }
  for (std::size_t light = 0; light < shadows.lights.size(); ++light) {
    const ShadowTruth truth{shadows.facets, *shadows.placed[light], view, eye, true};
    for (std::size_t layer = 0; layer < shadows.seen.size(); ++layer) {
      const std::vector<std::uint8_t> is_dark =
          dark_pixels(truth, shadows.seen[layer], view.width, view.height, pool);
      for (std::size_t i = 0; i < is_dark.size(); ++i) {
        shadows.masks[layer][i] |= static_cast<std::uint8_t>(is_dark[i] << light);
      }
    }
  }
}

// Shares of a light whose terminator has a rule are 255ths, those of its map's kernel too.
constexpr int kWholeOfTerminator = 255;

int share_whole(const Light& light) {
  if (light.terminator != Terminator::facets) return kWholeOfTerminator;
  return light.shadows == ShadowKind::map ? light.map.kernel * light.map.kernel : 1;
}

// Such a light's shares, made ready for soften_terminators().
std::span<std::uint8_t> terminator_shares(std::vector<std::uint8_t>& shares, std::size_t pixels,
                                          const Light& light) {
  if (light.shadows != ShadowKind::map || light.map.kernel == 1 || shares.size() != pixels) {
    shares.assign(pixels, 0);
    return shares;
  }
  const int texels = light.map.kernel * light.map.kernel;
  for (std::uint8_t& share : shares) {
    share = static_cast<std::uint8_t>((2 * kWholeOfTerminator * share + texels) / (2 * texels));
  }
  return shares;
}

void soften_layer(SceneShadows& shadows, std::span<const Light> lights, std::size_t layer,
                  const ShadowView& view, glm::dvec3 eye, ThreadPool& pool) {
  std::vector<TerminatorLight> softened;
  for (std::size_t i = 0; i < shadows.lights.size(); ++i) {
    const Light& light = lights[shadows.lights[i]];
    if (light.terminator == Terminator::facets) continue;
    softened.push_back(
        {light.terminator, *shadows.placed[i], static_cast<int>(i),
         terminator_shares(shadows.shares[layer][i], shadows.seen[layer].size(), light)});
  }
  soften_terminators(shadows.facets, shadows.surfaces, softened, shadows.seen[layer], view, eye,
                     shadows.masks[layer], pool);
}

void draw_masks(SceneShadows& shadows, const Scene& scene, std::span<const Light> lights,
                const CameraMatrices& camera, int width, int height, const Profile& profile,
                ThreadPool& pool) {
  const ShadowView view = shadow_view(camera, width, height, profile);
  if (shadows.by_rays) {
    draw_masks_by_rays(shadows, view, camera.eye, pool);
    return;
  }
  draw_maps(shadows, lights, map_camera(scene, camera), profile, pool);
  shadows.masks.resize(shadows.seen.size());
  shadows.volume_rays = 0;
  const bool softens = has_terminators(lights, shadows);
  for (std::size_t i = 0; i < shadows.seen.size(); ++i) {
    shadows.masks[i].resize(shadows.seen[i].size());
    draw_bits(shadows, i, view, camera.eye, pool);
    look_up_maps(shadows, i, view, camera.eye, pool);
    if (softens) soften_layer(shadows, lights, i, view, camera.eye, pool);
  }
}

// Calls use(texels of the image's row, masks, count) for each row of a tile.
template <class Use>
void for_each_tile_row(const Rectangle& area, int width, std::span<const std::uint8_t> mask,
                       const Use& use) {
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
    use(y, mask.subspan(row + static_cast<std::size_t>(area.x_begin),
                        static_cast<std::size_t>(area.x_end - area.x_begin)));
  }
}

using MaskSet = std::bitset<256>;

struct Tiles {
  int across;
  std::vector<MaskSet> masks;  // that a tile's pixels have, in any layer
};

Rectangle area_of(const Tiles& tiles, int tile, int width, int height) {
  const int x = tile % tiles.across * kTileSize, y = tile / tiles.across * kTileSize;
  return {x, y, std::min(x + kTileSize, width), std::min(y + kTileSize, height)};
}

Tiles find_masks(const SceneShadows& shadows, int width, int height, ThreadPool& pool) {
  Tiles tiles{(width + kTileSize - 1) / kTileSize, {}};
  const int down = (height + kTileSize - 1) / kTileSize;
  tiles.masks.resize(static_cast<std::size_t>(tiles.across) * static_cast<std::size_t>(down));
  pool.for_each(static_cast<int>(tiles.masks.size()), [&](int tile) {
    MaskSet& found = tiles.masks[static_cast<std::size_t>(tile)];
    for (const auto& mask : shadows.masks) {
      for_each_tile_row(area_of(tiles, tile, width, height), width, mask,
                        [&](int, std::span<const std::uint8_t> row) {
                          std::uint8_t last = 0;
                          for (const std::uint8_t m : row) {
                            if (m != last) found.set(m);
                            last = m;
                          }
                        });
    }
  });
  return tiles;
}

// The lights less what the mask's shadows take away.
std::vector<Light> lights_left(std::span<const Light> lights, const SceneShadows& shadows,
                               std::size_t mask) {
  std::vector<Light> left;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto bit = std::find(shadows.lights.begin(), shadows.lights.end(), i);
    const bool is_out =
        bit != shadows.lights.end() && (mask >> (bit - shadows.lights.begin()) & 1u) != 0;
    if (is_out && lights[i].shadow_darkness == 1.0f) continue;
    left.push_back(lights[i]);
    if (is_out) left.back().colour *= 1.0f - lights[i].shadow_darkness;
  }
  return left;
}

// Finds the triangles that pixels with the mask show, and those that other layers show there: a
// nearer layer decides what is seen in the next.
void list_triangles(SceneShadows& shadows, const Scene& scene, std::size_t mask, const Tiles& tiles,
                    std::span<const int> of_tiles, int width, int height) {
  std::vector<std::uint8_t> is_listed(shadows.facets.facets.size());
  const auto list_row = [&](std::size_t first, std::span<const std::uint8_t> row) {
    for (std::size_t x = 0; x < row.size(); ++x) {
      if (row[x] != mask) continue;
      for (const std::vector<SeenFacet>& layer : shadows.seen) {
        const SeenFacet seen = layer[first + x];
        if (shows_facet(seen)) is_listed[facet_of(seen)] = 1;
      }
    }
  };
  for (const std::vector<std::uint8_t>& masks : shadows.masks) {
    for (const int tile : of_tiles) {
      const Rectangle area = area_of(tiles, tile, width, height);
      for_each_tile_row(area, width, masks, [&](int y, std::span<const std::uint8_t> row) {
        list_row(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(area.x_begin),
                 row);
      });
    }
  }
  shadows.indices_of_objects.resize(scene.objects.size());
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const std::vector<std::uint32_t>& indices = scene.meshes[scene.objects[i].mesh].indices;
    std::vector<std::uint32_t>& listed = shadows.indices_of_objects[i];
    listed.clear();
    const std::uint8_t* is_there = is_listed.data() + shadows.numbered.meshes[i].first_facet;
    for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
      if (is_there[k / 3] != 0) listed.insert(listed.end(), &indices[k], &indices[k] + 3);
    }
  }
}

void copy_pixels(const Image& from, Image& to, const Rectangle& area,
                 std::span<const std::uint8_t> mask, std::size_t of) {
  constexpr std::size_t kTexelBytes = 8;
  for_each_tile_row(area, to.width, mask, [&](int y, std::span<const std::uint8_t> row_mask) {
    const std::size_t first = static_cast<std::size_t>(y) * to.stride_bytes +
                              kTexelBytes * static_cast<std::size_t>(area.x_begin);
    for (std::size_t i = 0; i < row_mask.size(); ++i) {
      if (row_mask[i] != of) continue;
      const std::size_t at = first + kTexelBytes * i;
      std::memcpy(to.bytes.data() + at, from.bytes.data() + at, kTexelBytes);
    }
  });
}

void copy_area(const Image& from, Image& to, const Rectangle& area) {
  const auto first = 4 * static_cast<std::ptrdiff_t>(area.x_begin);
  const auto count = 4 * static_cast<std::ptrdiff_t>(area.x_end - area.x_begin);
  for (int y = area.y_begin; y < area.y_end; ++y) {
    const auto source = row<std::uint16_t>(from, y).begin() + first;
    std::copy(source, source + count, row<std::uint16_t>(to, y).begin() + first);
  }
}

void set_targets(SceneShadows& shadows, std::size_t layers, int width, int height) {
  if (shadows.layers.size() < layers) {
    shadows.layers.resize(layers);
    shadows.depths.resize(layers);
  }
  RenderTargets& targets = shadows.pass.targets;
  targets.behind = {};
  for (std::size_t i = 0; i < layers; ++i) {
    if (shadows.layers[i].width != width || shadows.layers[i].height != height) {
      shadows.layers[i] = make_image(Format::rgba16f, width, height);
      shadows.depths[i] = make_image(Format::r32f, width, height);
    }
    if (i > 0) targets.behind[i - 1] = {&shadows.layers[i], &shadows.depths[i]};
  }
  targets.colour[0] = shadows.layers.data();
  targets.depth = shadows.depths.data();
}

// Tiles with shares, for each light with shadows.
std::vector<std::vector<int>> tiles_with_shares(const SceneShadows& shadows, const Tiles& tiles,
                                                int width, int height) {
  std::vector<std::vector<int>> found(shadows.maps.size());
  for (std::size_t light = 0; light < found.size(); ++light) {
    for (std::size_t tile = 0; tile < tiles.masks.size(); ++tile) {
      const Rectangle area = area_of(tiles, static_cast<int>(tile), width, height);
      const bool has_any =
          std::any_of(shadows.shares.begin(), shadows.shares.end(), [&](const auto& of_layer) {
            return !of_layer[light].empty() && has_shares(of_layer[light], width, area);
          });
      if (has_any) found[light].push_back(static_cast<int>(tile));
    }
  }
  return found;
}

void keep_unshadowed(SceneShadows& shadows, std::span<const std::vector<int>> with_shares,
                     const Tiles& tiles, std::span<Image* const> layers) {
  if (std::all_of(with_shares.begin(), with_shares.end(),
                  [](const std::vector<int>& of_light) { return of_light.empty(); })) {
    return;
  }
  shadows.unshadowed.resize(layers.size());
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const auto [width, height] = std::pair{layers[i]->width, layers[i]->height};
    Image& kept = shadows.unshadowed[i];
    if (kept.width != width || kept.height != height) {
      kept = make_image(Format::rgba16f, width, height);
    }
    for (const std::vector<int>& of_light : with_shares) {
      for (const int tile : of_light) {
        copy_area(*layers[i], kept, area_of(tiles, tile, width, height));
      }
    }
  }
}

}  // namespace

bool has_shadows(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return light.shadows != ShadowKind::none; });
}

void set_shadows(Scene& scene, ShadowKind kind) {
  for (Light& light : scene.lights) light.shadows = kind;
}

std::vector<std::string> shadow_warnings(const Scene& scene) {
  if (!has_shadows(scene)) return {};
  std::vector<std::string> warnings;
  const auto any = [&](const auto& is) {
    return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
      return is(scene.materials[object.material], scene.meshes[object.mesh]);
    });
  };
  if (any(has_cut_outs)) warnings.emplace_back("shadows: cut-out surfaces cast none");
  if (any(is_transparent)) {
    warnings.emplace_back("shadows: transparent surfaces cast none and are fully lit");
  }
  return warnings;
}

Facets scene_facets(const Scene& scene, double frame) {
  std::vector<Facet> facets;
  for (const Object& object : scene.objects) {
    const Mesh& mesh = scene.meshes[object.mesh];
    const Material& material = scene.materials[object.material];
    const glm::dmat4 to_world = object_matrix(object, frame);
    const bool swaps = mirrors(to_world);
    const bool casts = !is_transparent(material, mesh) && !has_cut_outs(material, mesh);
    std::vector<glm::dvec3> positions;
    positions.reserve(mesh.positions.size());
    for (const glm::vec3& position : mesh.positions) {
      const glm::dvec3 p{position};
      positions.emplace_back(((to_world[0] * p.x + to_world[1] * p.y) + to_world[2] * p.z) +
                             to_world[3]);
    }
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      Facet facet{{positions[mesh.indices[i]], positions[mesh.indices[i + 1]],
                   positions[mesh.indices[i + 2]]},
                  material.two_sided,
                  casts};
      if (swaps) std::swap(facet.corners[1], facet.corners[2]);
      facets.push_back(facet);
    }
  }
  return make_facets(std::move(facets));
}

CurvedSurfaces curved_surfaces(const Scene& scene, double frame) {
  CurvedSurfaces surfaces;
  // A matrix of any camera: normals are of the world.
  const std::vector<SurfaceDraw> draws = surface_draws(scene, CameraMatrices{}, frame);
  for (std::size_t number = 0; number < draws.size(); ++number) {
    const SurfaceVertexInput& input = draws[number].input;
    std::vector<glm::vec3> normals;
    for (const glm::vec3& normal : input.mesh->normals) {
      normals.push_back(normalize(transform_direction(input.normal_to_world, normal)));
    }
    const bool swaps = draws[number].state.front_face == FrontFace::clockwise;
    const std::vector<std::uint32_t>& indices = input.mesh->indices;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      std::array<glm::vec3, 3> corners{normals[indices[i]], normals[indices[i + 1]],
                                       normals[indices[i + 2]]};
      if (swaps) std::swap(corners[1], corners[2]);
      surfaces.normals.push_back(corners);
      surfaces.object_of.push_back(static_cast<std::uint32_t>(number));
    }
  }
  return surfaces;
}

ShadowLight shadow_light(const Light& light) {
  const glm::dvec3 place{light.position_or_direction};
  if (light.kind == LightKind::point) return {place, 1.0};
  return {normalize(place), 0.0};
}

std::shared_ptr<SceneShadows> make_scene_shadows(const Scene& scene, const Profile& profile,
                                                 ThreadPool& pool) {
  auto shadows = std::make_shared<SceneShadows>();
  shadows->numbered = number_triangles(scene, profile, pool.isa());
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    if (scene.lights[i].shadows != ShadowKind::none) shadows->lights.push_back(i);
  }
  shadows->moves = std::any_of(scene.objects.begin(), scene.objects.end(),
                               [](const Object& object) { return moves(object); });
  shadows->pass.profile = profile;
  shadows->pass.isa = pool.isa();
  return shadows;
}

void forget(SceneShadows& shadows, bool all) {
  shadows.seen_from.reset();
  if (all) shadows.frame.reset();
}

namespace {

void set_facets(SceneShadows& shadows, const Scene& scene, std::span<const Light> lights,
                double frame) {
  const bool has_facets = shadows.frame && (*shadows.frame == frame || !shadows.moves);
  if (has_facets) return;
  shadows.frame.reset();
  shadows.placed.clear();
  shadows.facets = scene_facets(scene, frame);
  if (has_terminators(lights, shadows)) shadows.surfaces = curved_surfaces(scene, frame);
  const bool has_volumes = std::any_of(
      shadows.lights.begin(), shadows.lights.end(),
      [&](std::size_t number) { return lights[number].shadows == ShadowKind::volumes; });
  if (has_volumes) shadows.joined = join_facets(shadows.facets);
  shadows.frame = frame;
}

// Lights that have moved are projected onto the receivers that `view` shows, or onto all. A light
// that stays while these change is projected onto all, once.
void place_lights(SceneShadows& shadows, std::span<const Light> lights,
                  const std::optional<ShadowView>& view, bool sees_others, ThreadPool& pool) {
  const std::size_t count = shadows.lights.size();
  shadows.placed.resize(count);
  shadows.projected.resize(count);
  shadows.maps.resize(count);
  shadows.volumes.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Light& light = lights[shadows.lights[i]];
    const ShadowLight placed = shadow_light(light);
    const bool stays = shadows.placed[i] == placed;
    if (stays && (shadows.projected[i].of_all || !sees_others)) continue;
    const bool is_of_view = view && !stays;
    if (is_of_view && !shadows.wanted && is_projected(shadows, light.shadows)) {
      shadows.wanted = seen_receivers(shadows.facets, shadows.seen, *view);
    }
    place_light(shadows, i, light.shadows, placed, is_of_view, pool);
  }
}

}  // namespace

void place_shadows(SceneShadows& shadows, const Scene& scene, std::span<const Light> lights,
                   double frame, ThreadPool& pool) {
  set_facets(shadows, scene, lights, frame);
  place_lights(shadows, lights, {}, true, pool);
}

MaskDraws cut_shadows(const SceneShadows& shadows, const CameraMatrices& camera, int width,
                      int height, ThreadPool& pool) {
  return cut_shadows(shadows.facets, pointers_to(shadows.projected), shadows.seen[0],
                     shadow_view(camera, width, height, shadows.pass.profile), pool);
}

void add_shadows(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 std::span<const Light> lights, std::span<Image* const> layers,
                 std::optional<float> behind_before, ThreadPool& pool) {
  SceneShadows& shadows = *prepared.shadows;
  const Scene& scene = *prepared.scene;
  const int width = layers[0]->width, height = layers[0]->height;
  SeenFrom from{camera, frame, width, height, layers.size(), behind_before, prepared.hidden};
  const bool sees_others = !shadows.seen_from || *shadows.seen_from != from;
  shadows.view_stays = !sees_others;
  if (sees_others) {
    shadows.seen_from.reset();
    shadows.wanted.reset();
    shadows.seen = draw_seen_facets(shadows.numbered, scene, camera, frame, width, height,
                                    layers.size(), pool, behind_before, prepared.hidden);
    shadows.kept_bits.assign(layers.size(), std::vector<KeptBits>(shadows.lights.size()));
  }
  if (prepared.on_shadows) prepared.on_shadows(false);
  set_facets(shadows, scene, lights, frame);
  place_lights(shadows, lights, shadow_view(camera, width, height, shadows.pass.profile),
               sees_others, pool);
  shadows.seen_from = std::move(from);
  if (prepared.on_shadows) prepared.on_shadows(true);
  draw_masks(shadows, scene, lights, camera, width, height, shadows.pass.profile, pool);
  const Tiles tiles = find_masks(shadows, width, height, pool);
  const std::vector<std::vector<int>> with_shares =
      tiles_with_shares(shadows, tiles, width, height);
  keep_unshadowed(shadows, with_shares, tiles, layers);
  set_targets(shadows, layers.size(), width, height);
  shadows.pass.behind_before = behind_before;
  // Draws what record(lights) has recorded.
  const auto redraw = [&](std::size_t mask, std::span<const int> of_tiles, const auto& record,
                          const auto& use) {
    const std::vector<Light> left = lights_left(lights, shadows, mask);
    record(left);
    TileLists lists;
    sort_into_tiles({&shadows.pass, 1}, {&lists, 1}, pool);
    const auto count = static_cast<int>(of_tiles.size());
    for_each_with<TileMemory>(pool, count, [&](int number, auto& memory) {
      const int tile = of_tiles[static_cast<std::size_t>(number)];
      draw_tile(shadows.pass, lists, tile, memory);
      for (std::size_t i = 0; i < layers.size(); ++i) use(i, tile_area(lists, tile));
    });
    shadows.pass.draws.clear();
  };

  for (std::size_t mask = 1; mask < MaskSet{}.size(); ++mask) {
    std::vector<int> with_mask;
    for (std::size_t tile = 0; tile < tiles.masks.size(); ++tile) {
      if (tiles.masks[tile].test(mask)) with_mask.push_back(static_cast<int>(tile));
    }
    if (with_mask.empty()) continue;
    list_triangles(shadows, scene, mask, tiles, with_mask, width, height);
    redraw(
        mask, with_mask,
        [&](std::span<const Light> left) {
          record_triangles(prepared, camera, frame, shadows.pass, left, shadows.indices_of_objects);
        },
        [&](std::size_t i, const Rectangle& area) {
          copy_pixels(shadows.layers[i], *layers[i], area, shadows.masks[i], mask);
        });
  }
  for (std::size_t light = 0; light < with_shares.size(); ++light) {
    if (with_shares[light].empty()) continue;
    const int whole = share_whole(lights[shadows.lights[light]]);
    redraw(
        std::size_t{1} << light, with_shares[light],
        [&](std::span<const Light> left) {
          record_scene(prepared, camera, frame, shadows.pass, left);
        },
        [&](std::size_t i, const Rectangle& area) {
          take_shares(shadows.shares[i][light], whole, area, shadows.unshadowed[i],
                      shadows.layers[i], *layers[i], shadows.pass.profile);
        });
  }
}

}  // namespace softfocus
