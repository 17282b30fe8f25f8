#pragma once
// Relief textures of a scene's opaque surfaces, drawn by the pipeline.

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/point_extents.h"
#include "scenes/relief/relief_texture.h"

namespace softfocus {

enum class ReliefProjection : std::uint8_t { orthographic, perspective };

struct NamedProjection {
  std::string_view name;
  ReliefProjection projection;
};
inline constexpr std::array kReliefProjections{
    NamedProjection{"orthographic", ReliefProjection::orthographic},
    NamedProjection{"perspective", ReliefProjection::perspective}};

/// The view of a relief: from the eye at the middle of the object.
struct ReliefView {
  glm::dvec3 eye{0.0, 0.0, 3.0};  ///< highlights are this eye's
  glm::dvec3 up{0.0, 1.0, 0.0};   ///< not along the way to the middle
  ReliefProjection projection = ReliefProjection::orthographic;
};

struct ReliefForm {
  int width = 256, height = 256;  ///< 4 to kMostReliefSize
  int depth_bits = 8;             ///< or 16
  bool with_normals = false;
  bool unlit = false;  ///< light can be laid on it anew; needs normals
};

/// A scene made ready to be drawn as reliefs at one frame. The scene must outlive it.
struct ReliefMaker {
  const Scene* scene;
  double frame;
  PreparedScene prepared;
  std::vector<glm::dvec3> points;          ///< of all meshes, in the world
  std::vector<PointChunk> chunks;          ///< chunks_of() them
  glm::dvec3 middle;                       ///< of the box along the world's axes that holds them
  double radius_m;                         ///< from the middle to the farthest
  std::vector<std::uint8_t> code_of_half;  ///< linear_to_srgb8() of each half
  Image picture;
  std::vector<Material> unlit;  ///< the scene's, with neither light nor highlight
  /// make_relief()'s work, if it is not the pipeline's: trace_relief().
  std::function<ReliefTexture(const ReliefMaker& maker, const ReliefView& view,
                              const ReliefForm& form, ThreadPool& pool)>
      trace = {};
};

/// Without points: middle and radius are for the caller to set. `pool` is the one that will draw.
ReliefMaker relief_maker(const Scene& scene, ThreadPool& pool);

/// Needs a scene with a triangle. `pool` is the one that will draw.
ReliefMaker prepare_relief(const Scene& scene, double frame, ThreadPool& pool);

/// Whether a perspective view's eye sees all of the object: all points lie before the eye, and the
/// farthest is not more than kMostSpan times as far along the axis as the nearest. So d stays below
/// n, even for the empty code.
bool can_project(const ReliefMaker& maker, const ReliefView& view);
inline constexpr double kMostSpan = 64.0;

/// The camera that holds all of the object from border to border, but for a margin of a texel, and
/// from the first depth to the last but for a share of kDepthMargin. A perspective view needs
/// can_project().
ReliefCamera relief_camera(const ReliefMaker& maker, const ReliefView& view, int width, int height);
inline constexpr double kDepthMargin = 1e-4;

/// Surfaces as draw_scene() has them without shadows, colours cut to 0..1. The same bits for any
/// number of threads. An unlit one has its unlit colours as `colours` until light_relief(), and
/// needs kMostReliefMaterials materials at most.
ReliefTexture make_relief(ReliefMaker& maker, const ReliefView& view, const ReliefForm& form,
                          ThreadPool& pool);

/// As make_relief(), by any camera that has the object between its first depth and its last.
ReliefTexture draw_relief(ReliefMaker& maker, const ReliefCamera& camera, glm::dvec3 eye,
                          const ReliefForm& form, ThreadPool& pool);

// make_relief() in parts, so that other work can be done between them; the same bits. In this
// order: begin_relief(), draw_relief_part() of each part, read_relief(). A maker draws one relief
// at a time.

/// The relief's camera; it has no texels yet.
ReliefTexture begin_relief(ReliefMaker& maker, const ReliefCamera& camera, const ReliefForm& form);

/// Draws one of `parts` parts of the triangles.
void draw_relief_part(ReliefMaker& maker, const ReliefTexture& relief, const ReliefForm& form,
                      glm::dvec3 eye, int part, int parts, ThreadPool& pool);

/// Reads the texels of the drawn parts.
void read_relief(ReliefMaker& maker, const ReliefForm& form, glm::dvec3 eye, ReliefTexture& relief,
                 ThreadPool& pool);

/// Makes a relief whose colours are unlit, and whose normals have the materials' numbers, ready for
/// light_relief().
void keep_unlit(ReliefTexture& relief, const Scene& scene);

/// The matrices that draw a relief: the texel (x, y) is the pixel (x, y), and the buffer's depth
/// is d / depth_m. Clip w is 1, or the distance from a perspective camera's eye along f. `eye` is
/// the one whose highlights are seen.
CameraMatrices relief_matrices(const ReliefCamera& camera, int width, int height, glm::dvec3 eye);

/// Draws the nearest surfaces' normals by these matrices: RGBA16F, alpha 1 + the material's number
/// where something is.
Image draw_normals(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                   int height, ThreadPool& pool);

}  // namespace softfocus
