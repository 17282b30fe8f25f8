#include "scenes/relief/impostors/relief_box.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "raster/images/texel.h"
#include "raster/numbers/vector_math.h"

namespace softfocus {
namespace {

/// From the middle out through a face.
glm::dvec3 face_direction(std::size_t face) {
  glm::dvec3 out{0.0};
  out[static_cast<int>(face / 2)] = face % 2 == 0 ? 1.0 : -1.0;
  return out;
}

ReliefView face_view(const ReliefMaker& maker, std::size_t face) {
  const glm::dvec3 up = face / 2 == 1 ? glm::dvec3{0.0, 0.0, -1.0} : glm::dvec3{0.0, 1.0, 0.0};
  return {maker.middle + face_direction(face) * (2.0 * maker.radius_m), up};
}

/// The object's extent across a face, and down.
struct FaceSize {
  double across_m, along_m;
};
FaceSize face_size(const ReliefMaker& maker, const ReliefView& view) {
  constexpr int kAny = 4;  // two of them margin
  const ReliefCamera camera = relief_camera(maker, view, kAny, kAny);
  return {std::sqrt(dot(camera.a, camera.a)) * (kAny - 2),
          std::sqrt(dot(camera.b, camera.b)) * (kAny - 2)};
}

bool can_be_warped(const BoxFace& face, glm::dvec3 eye) {
  return warped_extent(face.texture, face.extent, eye).has_value();
}

double texel_side(const ReliefTexture& relief) {
  return std::sqrt(
      std::max(dot(relief.camera.a, relief.camera.a), dot(relief.camera.b, relief.camera.b)));
}

std::vector<std::size_t> in_order(const ReliefBox& box, unsigned seen, glm::dvec3 eye) {
  std::vector<std::size_t> order;
  order.reserve(kBoxFaces);
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    if ((seen >> i & 1u) != 0) order.push_back(i);
  }
  const auto height_of = [&](std::size_t face) {
    const ReliefCamera& camera = box.faces[face]->texture.camera;
    return dot(camera.origin - eye, camera.f);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return height_of(a) > height_of(b); });
  return order;
}

/// Cosine from which two normals belong to one surface.
constexpr double kAlikeCosine = 0.9;

glm::dvec3 texel_normal(std::uint32_t packed) {
  const auto part = [&](int shift) {
    return (static_cast<int>(packed >> shift & 255u) - 128) / 127.0;
  };
  return normalize(glm::dvec3{part(0), part(8), part(16)});
}

/// Whether one of the four texels about a point shows a point near to it, and `accepts` it.
template <class Accepts>
bool any_near(const ReliefTexture& relief, glm::dvec3 point, double away_m,
              const Accepts& accepts) {
  const ReliefCamera& camera = relief.camera;
  const glm::dvec3 from_first = point - camera.origin;
  const double width_m = dot(camera.a, camera.a), height_m = dot(camera.b, camera.b);
  const double u = dot(from_first, camera.a) / width_m, v = dot(from_first, camera.b) / height_m;
  if (!(u > -1.0 && v > -1.0 && u < relief.width && v < relief.height)) return false;
  const double most = kHasTexels * texel_side(relief) + away_m;
  const auto left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
  for (int y = std::max(top, 0); y < std::min(top + 2, relief.height); ++y) {
    for (int x = std::max(left, 0); x < std::min(left + 2, relief.width); ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
                             static_cast<std::size_t>(x);
      if (relief.colours[at] == 0) continue;
      const glm::dvec3 way = relief_point(relief, x, y, relief.depths[at]) - point;
      if (dot(way, way) <= most * most && accepts(at)) return true;
    }
  }
  return false;
}

/// BoxFace::better.
std::vector<std::uint8_t> better_faces(const ReliefBox& box, std::size_t face) {
  const ReliefTexture& relief = box.faces[face]->texture;
  std::vector<std::uint8_t> better(relief.depths.size());
  for (int y = 0; y < relief.height; ++y) {
    for (int x = 0; x < relief.width; ++x) {
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.width) +
                             static_cast<std::size_t>(x);
      if (relief.colours[at] == 0) continue;
      const glm::dvec3 normal = texel_normal(relief.normals[at]);
      if (dot(normal, face_direction(face)) >= kSteepCosine) continue;
      const glm::dvec3 point = relief_point(relief, x, y, relief.depths[at]);
      for (std::size_t i = 0; i < kBoxFaces; ++i) {
        if (!box.faces[i] || dot(normal, face_direction(i)) < kSteepCosine) continue;
        const ReliefTexture& other = box.faces[i]->texture;
        const auto is_alike = [&](std::size_t texel) {
          return dot(texel_normal(other.normals[texel]), normal) > kAlikeCosine;
        };
        if (any_near(other, point, 0.0, is_alike)) {
          better[at] = static_cast<std::uint8_t>(better[at] | 1u << i);
        }
      }
    }
  }
  return better;
}

/// A face without the texels that a seen one shows better; none if that is all of them. If it is
/// marched, they stay where they are: a ray that passed through them would come out in any hollow
/// behind.
std::optional<BoxFace> left_of(const BoxFace& face, unsigned seen, bool marches) {
  BoxFace left = face;
  ReliefTexture& relief = left.texture;
  relief.normals = {};
  left.better = {};
  for (std::size_t at = 0; at < face.better.size(); ++at) {
    if ((face.better[at] & seen) == 0) continue;
    relief.colours[at] = marches ? kStopsRays : 0;
    if (!marches) relief.depths[at] = empty_depth(relief.depth_bits);
  }
  const std::optional<ReliefExtent> extent = relief_extent(relief);
  if (!extent) return std::nullopt;
  left.extent = *extent;
  return left;
}

std::size_t bytes_of(const BoxFace& face) {
  return face.texture.depths.size() * sizeof(std::uint16_t) +
         (face.texture.colours.size() + face.texture.normals.size()) * sizeof(std::uint32_t) +
         face.better.size();
}

}  // namespace

ReliefBox draw_relief_box(ReliefMaker& maker, const BoxForm& form, ThreadPool& pool) {
  assert(form.texels >= 4 && form.texels <= kMostReliefSize);
  std::array<FaceSize, kBoxFaces> sizes{};
  double longest = 0.0;
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    sizes[i] = face_size(maker, face_view(maker, i));
    longest = std::max({longest, sizes[i].across_m, sizes[i].along_m});
  }
  const auto texels = [&](double size_m) {
    const double wanted = std::ceil((form.texels - 2) * size_m / longest);
    return std::clamp(static_cast<int>(wanted) + 2, 4, form.texels);
  };
  ReliefBox box;
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    const ReliefForm of_face{texels(sizes[i].across_m), texels(sizes[i].along_m), form.depth_bits,
                             true};
    ReliefTexture texture = make_relief(maker, face_view(maker, i), of_face, pool);
    if (const std::optional<ReliefExtent> extent = relief_extent(texture)) {
      box.faces[i] = BoxFace{std::move(texture), *extent, {}};
    }
  }
  pool.for_each(static_cast<int>(kBoxFaces), [&](int i) {
    const auto face = static_cast<std::size_t>(i);
    if (box.faces[face]) box.faces[face]->better = better_faces(box, face);
  });
  for (std::optional<BoxFace>& face : box.faces) {
    if (face && !form.with_normals) face->texture.normals = {};
  }
  return box;
}

std::size_t bytes_of(const ReliefBox& box) {
  std::size_t bytes = 0;
  for (const std::optional<BoxFace>& face : box.faces) bytes += face ? bytes_of(*face) : 0;
  return bytes;
}

std::size_t bytes_of(const BoxMemory& memory) {
  std::size_t bytes = memory.warped.colours.size() * (sizeof(std::uint32_t) + sizeof(float));
  for (const std::optional<BoxFace>& face : memory.left) bytes += face ? bytes_of(*face) : 0;
  return bytes;
}

unsigned faces_seen(const ReliefBox& box, glm::dvec3 eye) {
  unsigned seen = 0;
  for (std::size_t i = 0; i < kBoxFaces; ++i) {
    if (box.faces[i] && can_be_warped(*box.faces[i], eye)) seen |= 1u << i;
  }
  return seen;
}

void draw_box(const ReliefBox& box, const CameraMatrices& camera, const BoxRule& rule,
              BoxMemory& memory, Image& picture, ThreadPool& pool,
              std::vector<std::uint8_t>* shown) {
  const unsigned seen = faces_seen(box, camera.eye);
  const bool marches = rule.march.has_value();
  if (memory.seen != seen || memory.marches != marches) {
    memory.seen = seen;
    memory.marches = marches;
    pool.for_each(static_cast<int>(kBoxFaces), [&](int i) {
      const auto face = static_cast<std::size_t>(i);
      memory.left[face].reset();
      if ((seen >> i & 1u) != 0) memory.left[face] = left_of(*box.faces[face], seen, marches);
    });
  }
  const std::vector<std::size_t> order = in_order(box, seen, camera.eye);
  const auto depth_at = [&](std::size_t pixel) {
    const auto width = static_cast<std::size_t>(picture.width);
    return row<std::uint16_t>(picture, static_cast<int>(pixel / width))[4 * (pixel % width) + 3];
  };
  std::vector<std::uint16_t> before(shown != nullptr ? shown->size() : 0);
  for (const std::size_t i : order) {
    if (!memory.left[i]) continue;
    const BoxFace& face = *memory.left[i];
    const std::optional<PlaneRectangle> place =
        warped_extent(face.texture, face.extent, camera.eye);
    if (!place) continue;
    for (std::size_t pixel = 0; pixel < before.size(); ++pixel) before[pixel] = depth_at(pixel);
    const float behind_m =
        i == order[0] ? 0.0f : static_cast<float>(kHasTexels * texel_side(face.texture));
    if (rule.march) {
      MarchMapping march =
          march_mapping(face.texture, face.extent, camera, picture.width, picture.height);
      march.mapping.behind_m = behind_m;
      march_relief(face.texture, march,
                   {rule.march->slices, rule.march->bisections, /*passes_behind=*/false}, picture,
                   pool);
    } else {
      warp_relief(face.texture, face.extent, camera.eye, *place, rule.warp, memory.warped, pool);
      PlaneMapping mapping =
          plane_mapping(face.texture, camera, *place, picture.width, picture.height);
      mapping.behind_m = behind_m;
      map_relief(memory.warped, mapping, picture, pool);
    }
    if (shown == nullptr) continue;
    for (std::size_t pixel = 0; pixel < before.size(); ++pixel) {
      if (depth_at(pixel) != before[pixel]) (*shown)[pixel] = static_cast<std::uint8_t>(i);
    }
  }
}

bool has_point(const BoxFace& face, glm::dvec3 point, double away_m) {
  return any_near(face.texture, point, away_m, [](std::size_t) { return true; });
}

std::vector<FacePoint> unseen_pixels(const ReliefBox& box, const CameraMatrices& camera,
                                     const Image& drawn, float far_m, ThreadPool& pool) {
  const PixelRays rays = pixel_rays(camera, drawn.width, drawn.height);
  const unsigned seen = faces_seen(box, camera.eye);
  std::vector<FacePoint> unseen(static_cast<std::size_t>(drawn.width) *
                                static_cast<std::size_t>(drawn.height));
  pool.for_each(drawn.height, [&](int y) {
    for (int x = 0; x < drawn.width; ++x) {
      const float depth = load_texel<Format::rgba16f>(drawn, x, y).w;
      if (!(depth < far_m)) continue;
      const auto far = static_cast<double>(depth);
      const glm::dvec3 point = camera.eye + rays.at(x, y) * far;
      FacePoint had = FacePoint::by_none;
      for (std::size_t i = 0; i < kBoxFaces && had != FacePoint::by_seen; ++i) {
        if (!box.faces[i] || !has_point(*box.faces[i], point, far * 0x1p-11)) continue;
        had = (seen >> i & 1u) != 0 ? FacePoint::by_seen : FacePoint::by_unseen;
      }
      const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(drawn.width) +
                             static_cast<std::size_t>(x);
      unseen[at] = had;
    }
  });
  return unseen;
}

}  // namespace softfocus
