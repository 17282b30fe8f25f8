#pragma once
// A scene drawn by a GL driver with the project's shaders: the same draws as
// scenes/draw/draw_scene.h gives the emulation.

#include <array>
#include <map>
#include <vector>

#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/surface_stages.h"
#include "scenes/scene.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// A scene's meshes and textures on the driver. The scene must outlive it.
class GlScene {
 public:
  GlScene(const GlContext& context, const Shaders& shaders, const Scene& scene);

  /// Draws one frame into an RGBA16F target with depth, cleared first.
  void draw(const CameraMatrices& view, double frame, const GlTarget& target);

  /// As softfocus::draw_layers(): a pass for each layer. Needs a scene of fewer than 2^24
  /// triangles.
  std::vector<Image> draw_layers(const CameraMatrices& view, double frame, int width, int height,
                                 std::size_t layers);

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
  std::vector<Mesh> unshared_meshes_;  // three vertices of its own for each triangle, to peel
  std::map<const Material*, GlTexture> textures_;  // a material has one sampler
  std::map<const Material*, GlTexture> opacities_;
  std::array<GlProgram, 32> programs_;  // by variant, and whether peeled; made when first used

  const GlProgram& program(SurfaceVariant variant, bool peeled);
  void make_unshared_meshes();
  // Into a cleared target. `before`: what the layer before shows, or null if nothing is peeled.
  void draw_surfaces(const CameraMatrices& view, double frame, const GlTexture* before);
};

/// What `draw` draws into: RGBA16F, with a depth buffer.
GlTarget make_scene_target(int width, int height);

}  // namespace softfocus
