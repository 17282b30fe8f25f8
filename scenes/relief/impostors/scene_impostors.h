#pragma once
// Objects of a scene that are drawn once and warped, among geometry (chapters 4 and 9 of Clua
// 2004).
//
// impostor_choices.h says which, for which eyes. So a frame depends on its own camera alone, not on
// the frames before: what is kept from frame to frame, or between the points of a lens, saves time
// and changes no bit.
//
// Reliefs are drawn with their shadows, and the triangles cast all of them. Colours are cut to
// 0..1. Of several surfaces of a pixel an impostor has the first alone.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "raster/threads/loops.h"
#include "scenes/draw/draw_scene.h"
#include "scenes/relief/impostors/impostor.h"
#include "scenes/relief/impostors/impostor_choices.h"

namespace softfocus {

/// Whether any object is to be an impostor.
bool has_impostors(const Scene& scene);

/// A relief, and which of its texels show something.
struct KeptRelief {
  ReliefTexture texture;
  ReliefExtent extent;
};

struct SceneImpostors {
  ImpostorObjects objects;
  ReliefMaker maker{};  ///< its points and what it hides are those of the object that is drawn

  struct Kept {
    std::optional<KeptRelief> relief;  ///< none: nothing of it is seen
    std::uint64_t used;
  };
  std::map<ReliefCell, Kept> kept;
  std::uint64_t views = 0;
  bool shadows_move = false;
  double frame = 0.0;  ///< of the reliefs, if so

  /// Of the last view.
  struct Shown {
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
