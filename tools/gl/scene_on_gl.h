#pragma once
// A scene drawn by a GL driver with the project's shaders: the same draws as
// scenes/draw/draw_scene.h gives the emulation.

#include <array>
#include <map>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/velocity.h"
#include "scenes/scene.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// A scene's meshes and textures on the driver. The scene must outlive it.
class GlScene {
 public:
  GlScene(const GlContext& context, const Shaders& shaders, const Scene& scene);

  /// Draws one frame into an RGBA16F target with depth, cleared first. Transparent surfaces are
  /// peeled, a pass for each layer, and blended; then the scene has fewer than 2^24 triangles.
  void draw(const CameraMatrices& view, double frame, const GlTarget& target);

  /// As softfocus::draw_layers(): a pass for each layer. Needs a scene of fewer than 2^24
  /// triangles.
  std::vector<Image> draw_layers(const CameraMatrices& view, double frame, int width, int height,
                                 std::size_t layers);

  /// As softfocus::draw_velocity().
  Image draw_velocity(const Instant& shown, const MotionSpan& span, int width, int height);

 private:
  struct Mesh {
    GlBuffer positions;
    GlBuffer normals;
    GlBuffer uvs;
    GlBuffer colours;
    GlBuffer indices;
  };

  const GlContext& context_;
  Shaders shaders_;
  const Scene& scene_;
  std::vector<Mesh> meshes_;
  std::vector<Mesh> unshared_meshes_;  // three vertices of its own for each triangle, to peel
  std::map<const Material*, GlTexture> textures_;  // a material has one sampler
  std::map<const Material*, GlTexture> opacities_;
  // By variant, whether blended, and whether peeled; made when first used.
  std::array<GlProgram, 64> programs_;
  GlProgram blend_program_;

  const GlProgram& program(const SurfaceDraw& surface, bool peeled);
  void make_unshared_meshes();

  // How surfaces are peeled: behind the layer before, and transparent ones before what is opaque.
  struct Peeling {
    const GlTexture* before = nullptr;        // null if nothing is peeled
    const GlTexture* opaque_depth = nullptr;  // null for opaque surfaces
  };
  // Into a cleared target.
  void draw_surfaces(const CameraMatrices& view, double frame, const Peeling& peeling);
  GlTarget peel(const CameraMatrices& view, double frame, glm::vec4 clear, const Peeling& peeling,
                int width, int height);
  void draw_blended(const CameraMatrices& view, double frame, const GlTarget& target);
};

/// The target of `draw`: RGBA16F, with a depth buffer.
GlTarget make_scene_target(int width, int height);

}  // namespace softfocus
