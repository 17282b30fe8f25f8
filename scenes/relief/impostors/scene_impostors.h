#pragma once
// Objects of a scene that are drawn once and warped, among geometry (chapters 4 and 9 of Clua
// 2004).
//
// A relief is drawn for an eye on a grid about its object: shells of distance, each kShellRatio
// times as far as the one before, and on each the cells of an octahedral map. A view takes the
// relief of its eye's cell. So a frame depends on its own camera alone, not on the frames before:
// what is kept from frame to frame, or between the points of a lens, saves time and changes no bit.
//
// Cells are so wide that, within one, what lies an object's radius behind comes to lie about
// `tolerance_px` beside. An object is drawn as geometry
//
//   - near its relief: less than kNearestRadii of its radius away, cut by the near plane, or as far
//     as the background's half
//   - if the tolerance wants more cells than there are, or if neighbours in its relief come farther
//     apart in this view than kMostErrors tolerances, in the mean of regions (5.6)
//   - if its reliefs do not fit into the memory, those that save the least first
//   - under ImpostorUse::where_cheaper, if its triangles are predicted to cost less
//   - always, if it is transparent or has a user's shaders
//
// Reliefs are drawn with their shadows, and the triangles cast all of them. Colours are cut to
// 0..1. Of several surfaces of a pixel an impostor has the first alone.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/impostors/impostor.h"

namespace softfocus {

inline constexpr double kNearestRadii = 1.3;
inline constexpr double kShellRatio = 1.125;
inline constexpr double kMostErrors = 8.0;

/// Whether any object is to be an impostor.
bool has_impostors(const Scene& scene);

/// An object, or the parts of a model.
struct ImpostorObject {
  std::size_t first, end;  ///< of the scene's objects
  ImpostorUse use;
  std::vector<glm::dvec3> corners;  ///< of the boxes of its meshes
  glm::dvec3 middle;
  double radius_m;
  std::size_t triangles;
};

/// Which relief of an object.
struct ReliefCell {
  std::size_t object;
  int shell, cells, u, v;  ///< `cells` each way
  float pixel_tangent;     ///< that its texels are made for

  bool operator<(const ReliefCell& other) const {
    return std::tie(object, shell, cells, u, v, pixel_tangent) <
           std::tie(other.object, other.shell, other.cells, other.u, other.v, other.pixel_tangent);
  }
};

/// What a frame's objects became.
struct ImpostorCounts {
  int shown = 0, renewed = 0, as_geometry = 0, out_of_view = 0;
  double predicted_ms = 0.0;  ///< with two threads
  double triangles = 0.0;     ///< drawn as geometry
  double texels = 0.0;        ///< of the reliefs shown, about
  double renewed_triangles = 0.0, renewed_texels = 0.0;
  double tolerance_px = 0.0;  ///< that the milliseconds allowed
  std::size_t bytes = 0;      ///< of all reliefs that are kept
};

struct SceneImpostors {
  const Scene* scene = nullptr;
  std::vector<ImpostorObject> objects;
  /// Of each of the scene's meshes that an impostor has: the corners of boxes that hold its points,
  /// kChunkPoints each.
  std::vector<std::vector<glm::dvec3>> mesh_corners;
  ReliefMaker maker{};  ///< its points and what it hides are those of the object that is drawn

  struct Kept {
    std::optional<DrawnRelief> relief;  ///< none: nothing of it is seen
    std::uint64_t used;
  };
  std::map<ReliefCell, Kept> kept;
  std::uint64_t views = 0;
  bool shadows_move = false;
  double frame = 0.0;  ///< of the reliefs, if so

  /// Of the last view.
  struct Shown {
    const ReliefTexture* relief;
    WarpedRelief warped;
    PlaneMapping mapping;
  };
  std::vector<Shown> shown;
  std::size_t shown_count = 0;  ///< the others are memory
  Image scratch, shares;
  struct Worker {
    std::unique_ptr<ThreadPool> alone;
  };
  ScratchShelf<Worker> workers;
  ImpostorCounts counts;
};

/// The scene must outlive it. `pool` is the one that will draw.
std::shared_ptr<SceneImpostors> make_scene_impostors(const Scene& scene, ThreadPool& pool);

std::shared_ptr<const StandIns> stand_ins_of(const std::shared_ptr<SceneImpostors>& impostors);

}  // namespace softfocus
