#pragma once
// A scene drawn by a GL driver with the project's shaders: the same draws as
// scenes/draw/draw_scene.h gives the emulation.

#include <array>
#include <map>
#include <vector>

#include "scenes/scene.h"
#include "scenes/draw/surface_stages.h"
#include "scenes/draw/frame_matrices.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// A scene's meshes and textures on the driver. The scene must outlive it.
class GlScene {
 public:
  GlScene(const GlContext& context, const Shaders& shaders, const Scene& scene);

  /// Draws one frame into an RGBA16F target with depth, cleared first.
  void draw(const CameraMatrices& view, double frame, const GlTarget& target);

 private:
  struct Mesh {
    GlBuffer positions;
    GlBuffer normals;
    GlBuffer uvs;
    GlBuffer indices;
  };

  const GlContext& context_;
  Shaders shaders_;
  const Scene& scene_;
  std::vector<Mesh> meshes_;
  std::map<const Material*, GlTexture> textures_;  // a material has one sampler
  std::array<GlProgram, 8> programs_;              // by variant, made when first used

  const GlProgram& program(SurfaceVariant variant);
};

/// What `draw` draws into: RGBA16F, with a depth buffer.
GlTarget make_scene_target(int width, int height);

}  // namespace softfocus
