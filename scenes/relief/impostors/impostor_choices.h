#pragma once
// Which objects of a scene are drawn as impostors in a view, and by which reliefs: an answer that
// depends on the scene and the view alone.
//
// A relief is drawn for an eye on a grid about its object: shells of distance, each kShellRatio
// times as far as the one before, and on each the cells of an octahedral map. A view takes the
// relief of its eye's cell. Cells are so wide that, within one, what lies an object's radius behind
// comes to lie about the tolerance beside. An object is drawn as geometry
//
//   - if the eye is less than kNearestRadii of its radius away, if the near plane cuts it, or if it
//     is as far as the background
//   - if the tolerance wants more cells than there are
//   - if the view's reliefs do not fit into the memory, those that save the least first
//   - under ImpostorUse::where_cheaper, if the relief is predicted to cost more than kMostCost of
//     what the triangles cost
//   - always, if it is transparent, moves, or has a user's shaders

#include <cstdint>
#include <tuple>
#include <vector>

#include "scenes/relief/make_relief.h"

namespace softfocus {

inline constexpr double kNearestRadii = 1.3;
inline constexpr double kShellRatio = 1.125;
/// An impostor errs, and where it is large its errors are seen most.
inline constexpr double kMostCost = 0.5;

/// An object, or the parts of a model.
struct ImpostorObject {
  std::size_t first, end;  ///< of the scene's objects
  ImpostorUse use;
  std::vector<glm::dvec3> corners;  ///< of the boxes of its meshes
  glm::dvec3 middle;
  double radius_m;
  std::size_t triangles;
};

struct ImpostorObjects {
  const Scene* scene = nullptr;
  std::vector<ImpostorObject> all;
  /// Of each of the scene's meshes that an impostor has: the corners of boxes that hold its points,
  /// kChunkPoints each.
  std::vector<std::vector<glm::dvec3>> mesh_corners;
};

/// Those that can be impostors. The scene must outlive the result.
ImpostorObjects impostor_objects(const Scene& scene);

/// Points in the world between which all of an object lies.
void add_points(const ImpostorObjects& objects, const ImpostorObject& object,
                std::vector<glm::dvec3>& to);

/// Which relief of an object.
struct ReliefCell {
  std::size_t object;      ///< of ImpostorObjects::all
  int shell, cells, u, v;  ///< `cells` each way
  float pixel_tangent;     ///< that its texels are made for

  bool operator<(const ReliefCell& other) const {
    return std::tie(object, shell, cells, u, v, pixel_tangent) <
           std::tie(other.object, other.shell, other.cells, other.u, other.v, other.pixel_tangent);
  }
};

/// A relief in place of an object, and what both would cost.
struct ImpostorChoice {
  ReliefCell cell;
  ReliefView view;
  double texels_per_pixel;
  double texels;  ///< about
  double cost_ns, geometry_ns;
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

struct ImpostorChoices {
  std::vector<ImpostorChoice> chosen;
  /// Of the scene's objects: not 0 if a relief stands for it, or if it is out of view.
  std::vector<std::uint8_t> hidden;
  ImpostorCounts counts;
};

/// By the scene's ImpostorBudget.
ImpostorChoices impostor_choices(const ImpostorObjects& objects, const CameraMatrices& camera,
                                 double frame, int height_px);

/// Takes one of them back, which cannot be warped for its view.
void leave_as_geometry(const ImpostorObjects& objects, const ImpostorChoice& choice,
                       ImpostorChoices& choices);

}  // namespace softfocus
