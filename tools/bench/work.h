#pragma once
// What a bench has both contenders do: a frame, with all that it takes made beforehand.

#include <cstddef>
#include <optional>
#include <string>

#include "dof/dof.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/scene.h"
#include "tools/bench/options.h"

namespace softfocus {

struct BenchWork {
  std::string name;            ///< of the scene; "spheres" and "picture" for those made here
  std::optional<Scene> scene;  ///< none: `picture` is filtered
  Image picture;
  CameraMatrices view{};
  double frame = 0.0;
  PictureSize size;
  const Method* method = nullptr;
  DofSettings settings;
  Profile profile;
  std::string profile_name;
};

/// Loads or makes what is to be measured. Throws UsageError for a lens that cannot be,
/// SceneError for a scene.
BenchWork make_work(const BenchOptions& options);

}  // namespace softfocus
