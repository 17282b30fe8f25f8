#include <array>

#include "raster/images/image.h"
#include "raster/numbers/hash.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/impostors/octahedral_atlas.h"
#include "scenes/relief/impostors/relief_box.h"
#include "scenes/relief/light_relief.h"
#include "scenes/relief/make_relief.h"
#include "scenes/relief/warp/map_relief.h"
#include "scenes/relief/warp/march_relief.h"
#include "scenes/relief/warp/resample.h"
#include "tools/golden/hashes.h"

namespace softfocus {
namespace {

template <class Numbers>
void add_all(Hash& hash, const Numbers& numbers) {
  for (const auto number : numbers) add_to_hash(hash, number);
}

std::uint64_t hash_of(const WarpedRelief& warped) {
  Hash hash;
  add_all(hash, warped.colours);
  // Empty texels have a depth without a meaning.
  for (std::size_t i = 0; i < warped.depths_m.size(); ++i) {
    if (warped.colours[i] != 0) add_to_hash(hash, warped.depths_m[i]);
  }
  return hash.value;
}

std::uint64_t hash_of(const ReliefTexture& relief) {
  Hash hash;
  add_all(hash, relief.depths);
  add_all(hash, relief.colours);
  add_all(hash, relief.normals);
  return hash.value;
}

}  // namespace

std::vector<NamedHash> relief_hashes(const GoldenScene& golden, ThreadPool& pool) {
  constexpr int kWidth = 61, kHeight = 43, kPicture = 64;
  const auto named = [&](std::string_view what) {
    return golden.name + " relief-" + std::string{what} + " ieee " + std::to_string(kWidth) + 'x' +
           std::to_string(kHeight);
  };
  std::vector<NamedHash> hashes;
  ReliefMaker maker = prepare_relief(golden.scene, 0.0, pool);
  const glm::dvec3 ahead{0.0, 0.0, 2.5 * maker.radius_m};
  const ReliefView view{.eye = maker.middle + ahead};
  const ReliefForm form{.width = kWidth, .height = kHeight, .with_normals = true};
  hashes.push_back(
      {named("16-bits"), hash_of(make_relief(maker, view, {kWidth, kHeight, 16, false}, pool))});
  const ReliefTexture relief = make_relief(maker, view, form, pool);
  hashes.push_back({named("8-bits"), hash_of(relief)});
  const ReliefExtent extent = relief_extent(relief).value();
  Camera camera = golden.scene.camera;
  camera.target = maker.middle;
  camera.position = maker.middle + ahead + glm::dvec3{0.5, 0.25, -0.25} * maker.radius_m;
  const PlaneRectangle place = warped_extent(relief, extent, camera.position).value();
  const CameraMatrices matrices = camera_matrices(camera, 0.0, kPicture, kPicture);
  WarpedRelief warped;
  for (const NamedResampling& of : kResamplings) {
    for (const PlaceNumbers numbers : {PlaceNumbers::floats, PlaceNumbers::fixed}) {
      warp_relief(relief, extent, camera.position, place, {of.resampling, numbers}, warped, pool);
      const std::string name{of.name};
      hashes.push_back(
          {named(numbers == PlaceNumbers::fixed ? name + "-fixed" : name), hash_of(warped)});
    }
  }
  Image picture = draw_scene(golden.scene, matrices, 0.0, kPicture, kPicture, Profile{}, pool);
  map_relief(warped, plane_mapping(relief, matrices, place, kPicture, kPicture), picture, pool);
  hashes.push_back({named("mapped"), hash_image(picture)});

  // Lit anew by a lamp and the scene's sun, which has turned.
  ReliefTexture unlit = make_relief(maker, view, {kWidth, kHeight, 8, true, true}, pool);
  Hash all;
  add_all(all, unlit.unlit);
  add_all(all, unlit.normals);
  hashes.push_back({named("unlit"), all.value});
  const glm::vec3 lamp{maker.middle + glm::dvec3{1.0, 2.0, 1.5} * maker.radius_m};
  const std::array lights{Light{LightKind::directional, {-0.5f, 0.25f, 1.0f}, {0.75f, 0.5f, 0.25f}},
                          Light{LightKind::point, lamp, {0.25f, 0.5f, 1.0f}}};
  light_relief(unlit, relief_lights(golden.scene.ambient_light, lights), camera.position, pool);
  Hash lit;
  add_all(lit, unlit.colours);
  hashes.push_back({named("lit"), lit.value});

  // Under a perspective camera, from before its eye and behind it: texels go in and out.
  ReliefView by_eye = view;
  by_eye.projection = ReliefProjection::perspective;
  const ReliefTexture perspective = make_relief(maker, by_eye, {kWidth, kHeight, 16, false}, pool);
  hashes.push_back({named("perspective"), hash_of(perspective)});
  const ReliefExtent shown = relief_extent(perspective).value();
  const auto warp_from = [&](glm::dvec3 eye, const WarpRule& rule) {
    const PlaneRectangle there = warped_extent(perspective, shown, eye).value();
    warp_relief(perspective, shown, eye, there, rule, warped, pool);
    return there;
  };
  warp_from(view.eye + glm::dvec3{0.5, 0.25, 1.0} * maker.radius_m,
            {Resampling::compensated, PlaceNumbers::fixed});
  hashes.push_back({named("perspective-outwards"), hash_of(warped)});
  const PlaneRectangle there = warp_from(camera.position, {});
  hashes.push_back({named("perspective-inwards"), hash_of(warped)});
  picture = draw_scene(golden.scene, matrices, 0.0, kPicture, kPicture, Profile{}, pool);
  map_relief(warped, plane_mapping(perspective, matrices, there, kPicture, kPicture), picture,
             pool);
  hashes.push_back({named("perspective-mapped"), hash_image(picture)});

  // Its rivals.
  const auto drawn = [&] {
    return draw_scene(golden.scene, matrices, 0.0, kPicture, kPicture, Profile{}, pool);
  };
  picture = drawn();
  march_relief(relief, march_mapping(relief, extent, matrices, kPicture, kPicture), {24, 5},
               picture, pool);
  hashes.push_back({named("marched"), hash_image(picture)});
  picture = drawn();
  BoxMemory memory;
  draw_box(draw_relief_box(maker, {48}, pool), matrices, {}, memory, picture, pool);
  hashes.push_back({named("six-faces"), hash_image(picture)});
  picture = drawn();
  const OctahedralForm atlas{.views = 4, .texels = 32, .distance_m = 2.5 * maker.radius_m};
  draw_octahedral(make_octahedral_atlas(maker, atlas, pool), matrices, 1, picture, pool);
  hashes.push_back({named("octahedral"), hash_image(picture)});
  return hashes;
}

}  // namespace softfocus
