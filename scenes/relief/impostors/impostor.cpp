#include "scenes/relief/impostors/impostor.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "raster/numbers/vector_math.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {
namespace {

/// A relief with fewer texels a side has no coarser level.
constexpr int kLeastLevelSize = 16;

/// Half the height of the view, a metre before the camera.
double half_view(const CameraMatrices& camera) { return 1.0 / std::fabs(camera.eye_to_clip[1][1]); }

glm::dvec3 middle_of_plane(const ReliefTexture& relief) {
  const ReliefCamera& plane = relief.camera;
  return (plane.origin + plane.a * (0.5 * (relief.width - 1))) +
         plane.b * (0.5 * (relief.height - 1));
}

/// A texel's width as the eye sees it, over its distance.
double texel_tangent(const ReliefTexture& relief, glm::dvec3 eye) {
  const ReliefCamera& plane = relief.camera;
  const double texel_m = std::max(length_of(plane.a), length_of(plane.b));
  return texel_m / length_of(middle_of_plane(relief) - eye);
}

const ReliefTexture& texture_of(const DrawnRelief& relief, std::size_t level) {
  return level == 0 ? relief.texture : relief.coarser[level - 1].texture;
}

}  // namespace

double pixels_across(double pixels, double size_m, double distance_m, double half_view_tangent) {
  return pixels * size_m / (2.0 * distance_m * half_view_tangent);
}

ReliefView impostor_view(const ReliefMaker& maker, const CameraMatrices& camera,
                         const ImpostorSettings& settings, glm::dvec3 up) {
  ReliefView view{camera.eye, up, settings.projection};
  if (view.projection == ReliefProjection::perspective && !can_project(maker, view)) {
    view.projection = ReliefProjection::orthographic;
  }
  return view;
}

ReliefForm impostor_form(const ReliefMaker& maker, const CameraMatrices& camera,
                         const ImpostorSettings& settings, glm::dvec3 up, int height_px) {
  // Two texels each way are margin; of any size, the camera's width and height are the object's.
  constexpr int kAny = 4;
  const ReliefCamera plane =
      relief_camera(maker, impostor_view(maker, camera, settings, up), kAny, kAny);
  const double distance = std::max(dot(plane.origin - camera.eye, plane.f), 1e-3 * maker.radius_m);
  const auto texels = [&](double size_m) {
    const double wanted =
        settings.texels_per_pixel * pixels_across(height_px, size_m, distance, half_view(camera));
    const double whole = std::ceil(std::fmin(wanted, kMostReliefSize - 2.0));
    return std::clamp(static_cast<int>(whole) + 2, kAny, kMostReliefSize);
  };
  return {texels(length_of(plane.a) * (kAny - 2)), texels(length_of(plane.b) * (kAny - 2)),
          settings.depth_bits, settings.lights != nullptr, settings.lights != nullptr};
}

double parallax_tangent(const ReliefTexture& relief, glm::dvec3 old_eye, glm::dvec3 new_eye) {
  double largest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const double u = (corner & 1) != 0 ? relief.width - 1 : 0;
    const double v = (corner & 2) != 0 ? relief.height - 1 : 0;
    const double code = (corner & 4) != 0 ? last_depth(relief.depth_bits) : 0;
    const glm::dvec3 point = relief_point(relief, u, v, code);
    const WarpedPlace seen = projected_place(relief, old_eye, u, v, code * depth_step(relief));
    const glm::dvec3 to_point = point - new_eye;
    const glm::dvec3 to_sprite = relief_point(relief, seen.u, seen.v, 0) - new_eye;
    const double along = dot(to_point, to_sprite);
    if (!(along > 0.0)) return HUGE_VAL;
    largest = std::max(largest, length_of(cross(to_point, to_sprite)) / along);
  }
  return largest;
}

std::size_t bytes_of(const DrawnRelief& relief) {
  const auto bytes = [](const ReliefTexture& texture) {
    return texture.depths.size() * sizeof(std::uint16_t) +
           (texture.colours.size() + texture.normals.size() + texture.unlit.size()) *
               sizeof(std::uint32_t);
  };
  std::size_t sum =
      bytes(relief.texture) + relief.critical.regions.size() * sizeof(relief.critical.regions[0]);
  for (const ReliefLevel& level : relief.coarser) sum += bytes(level.texture);
  return sum;
}

bool can_serve(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
               double pixel_tangent) {
  if (!sees_front(relief.texture, eye)) return false;
  // A relief of one resolution is kept as fine as it was drawn.
  const bool has_levels = settings.levels > 1;
  const double wide =
      texel_tangent(relief.texture, eye) * (has_levels ? 1.0 : settings.texels_per_pixel);
  const double least = settings.fineness / static_cast<double>(1 << (settings.levels - 1));
  return wide <= settings.sharpness * pixel_tangent && wide >= least * pixel_tangent &&
         warped_extent(relief.texture, relief.extent, eye).has_value();
}

std::size_t level_for(const DrawnRelief& relief, glm::dvec3 eye, double pixel_tangent) {
  std::size_t level = 0;
  while (level < relief.coarser.size() &&
         texel_tangent(relief.coarser[level].texture, eye) <= pixel_tangent) {
    ++level;
  }
  return level;
}

double impostor_error(const DrawnRelief& relief, glm::dvec3 eye) {
  return mean_critical_error(relief.texture, relief.critical, eye);
}

double pixel_tangent_of(const CameraMatrices& camera, int height_px) {
  return 2.0 * half_view(camera) / height_px;
}

bool is_fresh(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
              double pixel_tangent) {
  return can_serve(relief, settings, eye, pixel_tangent) &&
         impostor_error(relief, eye) <= settings.tolerance_texels;
}

bool can_be_recalled(const DrawnRelief& relief, const ImpostorSettings& settings, glm::dvec3 eye,
                     double pixel_tangent) {
  return is_fresh(relief, settings, eye, pixel_tangent) &&
         error_bound(relief.texture, relief.critical, eye) <=
             kMostRecalledBound * settings.tolerance_texels;
}

void keep_stale(Impostor& impostor, const ImpostorSettings& settings, glm::dvec3 eye) {
  if (!impostor.drawn) return;
  std::vector<DrawnRelief>& cache = impostor.cache;
  cache.push_back(std::move(*impostor.drawn));
  impostor.drawn.reset();
  const auto bytes = [&] {
    std::size_t sum = 0;
    for (const DrawnRelief& relief : cache) sum += bytes_of(relief);
    return sum;
  };
  while (!cache.empty() && bytes() > settings.cache_bytes) {
    std::size_t farthest = 0;
    for (std::size_t i = 1; i < cache.size(); ++i) {
      if (length_of(cache[i].eye - eye) > length_of(cache[farthest].eye - eye)) farthest = i;
    }
    cache.erase(cache.begin() + static_cast<std::ptrdiff_t>(farthest));
  }
}

std::optional<DrawnRelief> known_relief(ReliefTexture texture, const ImpostorSettings& settings,
                                        glm::dvec3 eye, ThreadPool& pool) {
  const std::optional<ReliefExtent> extent = relief_extent(texture);
  if (!extent) return std::nullopt;
  CriticalRegions critical =
      critical_regions(texture, *extent, settings.regions, settings.regions, &pool);
  DrawnRelief drawn{std::move(texture), *extent, std::move(critical), eye, {}};
  for (int i = 1; i < settings.levels; ++i) {
    const ReliefTexture& finer = texture_of(drawn, drawn.coarser.size());
    if (finer.width < kLeastLevelSize || finer.height < kLeastLevelSize) break;
    ReliefTexture coarser = coarser_relief(finer);
    const std::optional<ReliefExtent> shown = relief_extent(coarser);
    if (!shown) break;
    drawn.coarser.push_back({std::move(coarser), *shown});
  }
  return drawn;
}

std::optional<DrawnRelief> recalled(Impostor& impostor, const ImpostorSettings& settings,
                                    glm::dvec3 eye, double pixel_tangent) {
  std::optional<std::size_t> best;
  double least = HUGE_VAL;
  for (std::size_t i = 0; i < impostor.cache.size(); ++i) {
    const DrawnRelief& kept = impostor.cache[i];
    if (!can_be_recalled(kept, settings, eye, pixel_tangent)) continue;
    const double error = impostor_error(kept, eye);
    if (best && error >= least) continue;
    best = i;
    least = error;
  }
  if (!best) return std::nullopt;
  DrawnRelief relief = std::move(impostor.cache[*best]);
  impostor.cache.erase(impostor.cache.begin() + static_cast<std::ptrdiff_t>(*best));
  return relief;
}

ImpostorStep update_impostor(Impostor& impostor, ReliefMaker& maker,
                             const ImpostorSettings& settings, const CameraMatrices& camera,
                             glm::dvec3 up, int height_px, ThreadPool& pool) {
  const double pixel_tangent = pixel_tangent_of(camera, height_px);
  const glm::dvec3 eye = camera.eye;
  std::optional<DrawnRelief>& drawn = impostor.drawn;
  ImpostorStep step = ImpostorStep::warp;
  if (!drawn || !is_fresh(*drawn, settings, eye, pixel_tangent)) {
    std::optional<DrawnRelief> kept = recalled(impostor, settings, eye, pixel_tangent);
    keep_stale(impostor, settings, eye);
    if (kept) {
      step = ImpostorStep::recall;
      drawn = std::move(kept);
    } else {
      step = ImpostorStep::renew;
      const ReliefForm form = impostor_form(maker, camera, settings, up, height_px);
      drawn =
          known_relief(make_relief(maker, impostor_view(maker, camera, settings, up), form, pool),
                       settings, eye, pool);
    }
  } else if (settings.sprites &&
             parallax_tangent(drawn->texture, impostor.warped_for, eye) <= pixel_tangent) {
    return ImpostorStep::sprite;
  }
  warp_impostor(impostor, settings, eye, pixel_tangent, pool);
  return step;
}

void warp_impostor(Impostor& impostor, const ImpostorSettings& settings, glm::dvec3 eye,
                   double pixel_tangent, ThreadPool& pool) {
  impostor.warped.place = {0, 0, 0, 0};
  if (!impostor.drawn) return;
  DrawnRelief& drawn = *impostor.drawn;
  impostor.warped_level = level_for(drawn, eye, pixel_tangent);
  const std::size_t level = impostor.warped_level;
  ReliefTexture& texture = level == 0 ? drawn.texture : drawn.coarser[level - 1].texture;
  const ReliefExtent& extent = level == 0 ? drawn.extent : drawn.coarser[level - 1].extent;
  if (settings.lights != nullptr && !settings.lights_pixels) {
    light_relief(texture, *settings.lights, eye, pool);
  }
  const std::optional<PlaneRectangle> place = warped_extent(texture, extent, eye);
  if (!place) return;
  warp_relief(texture, extent, eye, *place, settings.warp, impostor.warped, pool);
  if (settings.lights_pixels) {
    std::vector<std::uint32_t> unlit = std::exchange(texture.colours, normals_as_colours(texture));
    warp_relief(texture, extent, eye, *place, settings.warp, impostor.warped_normals, pool);
    texture.colours = std::move(unlit);
  }
  impostor.warped_for = eye;
}

Rectangle draw_impostor(const Impostor& impostor, const CameraMatrices& camera, Image& picture,
                        ThreadPool& pool, PixelLights* lights) {
  if (!impostor.drawn || impostor.warped.place.width == 0) return {0, 0, 0, 0};
  const ReliefTexture& texture = texture_of(*impostor.drawn, impostor.warped_level);
  const PlaneMapping mapping =
      plane_mapping(texture, camera, impostor.warped.place, picture.width, picture.height);
  if (lights != nullptr) {
    draw_lit_pixels(texture, {impostor.warped, impostor.warped_normals}, mapping, camera, *lights,
                    picture, pool);
  } else {
    map_relief(impostor.warped, mapping, picture, pool);
  }
  return mapping.area;
}

}  // namespace softfocus
