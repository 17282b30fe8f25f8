#pragma once
// A scene's frame: its list of draws, the draws, and the parts that methods work from.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "dof/dof.h"
#include "raster/images/decoded_texture.h"
#include "raster/images/image.h"
#include "raster/numbers/profile.h"
#include "raster/pipeline/render_pass.h"
#include "raster/pipeline/state.h"
#include "raster/threads/parallel.h"
#include "scenes/draw/frame_matrices.h"
#include "scenes/draw/transparent_layers.h"
#include "scenes/scene.h"
#include "scenes/surfaces/shader_surface.h"
#include "scenes/surfaces/surface_stages.h"

namespace softfocus {

/// One object. The pointers are into the scene.
struct SurfaceDraw {
  DrawState state;
  SurfaceVertexInput input;
  const Texture* texture;  ///< none if the variant is not textured
  SurfaceOpacity opacity;
  SurfaceVariant variant;                   ///< the features of the material
  const SurfaceShaders* shaders = nullptr;  ///< a user's, in place of the usual ones
  ShaderSurfaceMatrices matrices{};         ///< for these
  std::optional<glm::vec3> colour{};        ///< in place of theirs
};

/// Whether a surface is blended with what lies behind it.
bool is_transparent(const Material& material, const Mesh& mesh);

/// Whether any of a scene's objects is.
bool has_transparent(const Scene& scene);

/// Whether any of its materials has shaders of a user's.
bool has_shaders(const Scene& scene);

/// One for each of the scene's objects, in the order of drawing. Those of opacity 0 show nothing:
/// callers leave them out.
std::vector<SurfaceDraw> surface_draws(const Scene& scene, const CameraMatrices& camera,
                                       double frame);

// From a scene to draw calls.

struct SceneShadows;  // shadowed_layers.h

/// The background at the far distance: a picture's colour where nothing is drawn.
glm::vec4 clear_colour(const Scene& scene);

/// Draws one frame into an RGBA16F image of any size: linear colour, and in alpha the
/// depth in metres along the axis (the camera's far distance where nothing was drawn).
/// Transparent surfaces are blended (transparent_layers.h, which says whose depth alpha is).
/// The same bits for any number of threads.
Image draw_scene(const Scene& scene, const CameraMatrices& camera, double frame, int width,
                 int height, const Profile& profile, ThreadPool& pool);

/// The edges of a picture, as EdgeSurfaces has them.
struct EdgePictures {
  int samples = 1;  ///< of a pixel, besides its centre: 4 or 8; 1: there are no edges
  Image other{}, coverage{};
};

/// Draws some objects of a scene otherwise than as triangles
/// (relief/impostors/scene_impostors.h).
struct StandIns {
  /// Makes them ready for a view. Returns what they stand for: an entry for each of the scene's
  /// objects, not 0 if its triangles are not drawn.
  std::function<std::vector<std::uint8_t>(const CameraMatrices& camera, double frame, int width,
                                          int height, ThreadPool& pool)>
      prepare;
  /// Lays them into pictures of that view, from which the objects were left out: opaque layers, the
  /// nearest first, as draw_layers() has them, with the first one's edges if there are any. Sets
  /// `changed`, an entry for each pixel, where the first layer shows them.
  std::function<void(std::span<Image* const> layers, EdgePictures* edges,
                     std::span<std::uint8_t> changed, ThreadPool& pool)>
      lay;
};

/// How often a pixel reads its surface's texture (texture_read_places()), if edges are found from
/// so many samples. Half as many reads as samples: more would cost more than they bring.
constexpr int texture_reads_of(int samples) { return samples == 1 ? 1 : samples / 2; }

/// A scene made ready for many frames: decoded textures, and memory to use again.
struct PreparedScene {
  const Scene* scene = nullptr;
  bool has_transparent = false;
  std::vector<DecodedTexture> textures{};  ///< decoded, for drawing in lanes
  RenderPass pass{};
  Image depth{};
  std::vector<Image> depths_behind{};       ///< of the layers behind the first
  Image sampled_colour{}, sampled_depth{};  ///< of several samples a pixel
  // If the scene has transparent surfaces.
  RenderPass transparent_pass{};
  TransparentTargets transparent{};
  /// If a light of the scene has shadows.
  std::shared_ptr<SceneShadows> shadows{};
  std::shared_ptr<const StandIns> stand_ins{};  ///< if any
  /// Objects that are not drawn, though they cast shadows: an entry each, or none at all.
  std::vector<std::uint8_t> hidden{};
  bool keeps_depth = false;   ///< `depth` is wanted once the scene is drawn
  int texture_reads = 1;      ///< of a pixel, as texture_reads_of()
  std::size_t triangles = 0;  ///< of the objects that draw_layers() has drawn as such
  /// Told how many points of soft lights have been drawn by; may be empty.
  std::function<void(int points)> on_light_points = {};
  /// Told where shadows begin to be made ready for the lights, and where they are; may be empty.
  std::function<void(bool are_placed)> on_shadows = {};
};

/// Opaque surfaces of more chunks (kChunkTriangles) are drawn in several passes, the same bits: a
/// pass keeps its triangles, here a million and a half, until its tiles are drawn.
constexpr std::size_t kPassChunks = 1536;

std::size_t chunks_of_scene(const Scene& scene);

/// The scene must outlive the result. `pool` is the one that will draw.
PreparedScene prepare_scene(const Scene& scene, const Profile& profile, ThreadPool& pool);

/// For record_surfaces() alone, which reads no textures but opacities.
PreparedScene prepare_surfaces(const Scene& scene, const Profile& profile, ThreadPool& pool);

/// As above, into an RGBA16F picture.
void draw_scene(PreparedScene& prepared, const CameraMatrices& camera, double frame, Image& picture,
                ThreadPool& pool);

/// The nearest opaque surfaces of each pixel, by depth peeling: `picture` as draw_scene() has it
/// but for what is transparent, behind[0] the next surface, and so on. The background is all that
/// lies behind the last surface, again and again. Up to kMaxLayers - 1 behind, of the picture's
/// size and format. With `behind_before_m` they may show the background behind what is as far as
/// that or farther, and cost less: no method looks behind what is in focus. With `edges` these are
/// those of the picture; softpipe's profile has none. Scenes whose materials have shaders, or that
/// are drawn in several passes, have those between depths alone (find_edges()).
void draw_layers(PreparedScene& prepared, const CameraMatrices& camera, double frame,
                 Image& picture, std::span<Image> behind, ThreadPool& pool,
                 std::optional<double> behind_before_m = {}, EdgePictures* edges = nullptr);

/// As above, `layers` new pictures, 1 to kMaxLayers, the nearest first.
std::vector<Image> draw_layers(const Scene& scene, const CameraMatrices& camera, double frame,
                               int width, int height, std::size_t layers, const Profile& profile,
                               ThreadPool& pool);

/// The transparent surfaces before a picture that draw_layers() has just drawn of the same frame,
/// as depth of field takes them: the nearest layer first, and none that is empty.
std::vector<TransparentPicture> draw_transparent(PreparedScene& prepared,
                                                 const CameraMatrices& camera, double frame,
                                                 const Image& picture, ThreadPool& pool);

/// Records the clearing and the opaque draws of a frame into a pass, which has its targets, and the
/// profile and isa of prepare_scene(). Depths are kept if the scene has transparent surfaces.
void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass);

/// The same, lit by other lights than the scene's. They must outlive the draws.
void record_scene(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                  RenderPass& pass, std::span<const Light> lights);

/// The same, of each object the triangles of these indices alone, which must outlive the draws; of
/// one with shaders, which may look at a triangle's number, all or none.
void record_triangles(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                      RenderPass& pass, std::span<const Light> lights,
                      std::span<const std::vector<std::uint32_t>> indices_of_objects);

/// One of `parts` parts of record_scene(), each for a pass of its own on the same targets, whose
/// depths are kept. The first clears. Part after part they draw what record_scene() draws, in its
/// order: the same bits. With `materials` they stand for the scene's, one each, with its textures;
/// they must outlive finish().
void record_scene_part(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                       int part, int parts, RenderPass& pass,
                       std::span<const Material> materials = {});

/// Records the transparent draws of a frame into a pass that has set_targets().
void record_transparent(const PreparedScene& prepared, const CameraMatrices& camera, double frame,
                        RenderPass& pass);

/// Records the opaque draws of a frame, without the clearing, with materials of the caller's in
/// place of the scene's: one for each object, unlit and without texture. The same pixels, at the
/// same depths: what is cut out stays so. The materials must outlive finish().
void record_surfaces(const PreparedScene& prepared, std::span<const Material> of_objects,
                     const CameraMatrices& camera, double frame, RenderPass& pass);

// A frame in the parts that a depth-of-field method reads: what is opaque, the surfaces behind it,
// and the transparent ones before it.

struct FrameParts {
  Image opaque;                                 ///< draw_layers()'s first
  std::vector<Image> behind;                    ///< and its others
  std::vector<TransparentPicture> transparent;  ///< before `opaque`
  Image blended;                                ///< these over it; none if nothing is transparent
  EdgePictures edges{};                         ///< of `opaque`

  /// All of it, as draw_scene() has it. Needs blend().
  const Image& picture() const { return transparent.empty() ? opaque : blended; }
};

/// Draws a frame, with `layers` - 1 opaque surfaces behind the first, as draw_layers(), into the
/// memory of `parts` as far as it has the size; without blend(). 0 layers: draw_scene() alone. With
/// 4 or 8 `samples` it has edges.
void draw_parts(PreparedScene& prepared, const CameraMatrices& camera, double frame, int width,
                int height, std::size_t layers, FrameParts& parts, ThreadPool& pool,
                std::optional<double> behind_before_m = {}, int samples = 1);

void blend(FrameParts& parts, const Profile& profile, ThreadPool& pool);

/// Calls `use(DofInput)` with a frame's parts as a method reads them. With `radii_px`, which are of
/// one picture, that is the blended picture alone.
template <class Use>
auto with_dof_input(const FrameParts& parts, const DofSettings& settings, const Profile& profile,
                    std::span<const std::uint16_t> objects, std::span<const float> radii_px,
                    const Use& use) {
  const std::vector<ConstImageView> behind{parts.behind.begin(), parts.behind.end()};
  const bool is_one = parts.transparent.empty() || !radii_px.empty();
  EdgeSurfaces edges;
  if (parts.edges.samples > 1 && radii_px.empty()) {
    edges = {parts.edges.coverage, parts.edges.other};
  }
  const std::vector<TransparentLayer> transparent =
      is_one ? std::vector<TransparentLayer>{} : views_of(parts.transparent);
  return use(DofInput{.scene = is_one ? parts.picture() : parts.opaque,
                      .settings = settings,
                      .profile = profile,
                      .objects = objects,
                      .behind = behind,
                      .transparent = transparent,
                      .edges = edges,
                      .radii_px = radii_px});
}

/// A frame by a method, with all that the method reads of the scene. `picture` is draw_scene()'s.
Image filtered_frame(const Method& method, const Scene& scene, const CameraMatrices& camera,
                     double frame, const Image& picture, const DofSettings& settings,
                     const Profile& profile, ThreadPool& pool,
                     std::shared_ptr<const StandIns> stand_ins = {});

}  // namespace softfocus
