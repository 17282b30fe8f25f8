#pragma once
// A scene as data, filled by the loaders and read by draw_scene.
// World units are metres, y points up, the coordinate system is right-handed.

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dof/lens.h"
#include "raster/effects/effect.h"
#include "raster/images/sampler.h"

namespace softfocus {

/// From `frame` on, and until the next key's, a value is on its way from `value`.
struct Keyframe {
  double frame = 0.0;
  double value = 0.0;
  bool operator==(const Keyframe&) const = default;
};

/// The way from key to key (draw/frame_matrices.h).
enum class Easing : std::uint8_t { linear, smooth };

/// Of x, y and z, at the same frames; all empty if there are none.
using PlaceKeys = std::array<std::vector<Keyframe>, 3>;

struct Camera {
  glm::dvec3 position{0.0, 0.0, 3.0};  ///< at frame 0, or at its first key
  glm::dvec3 target{0.0};
  PlaceKeys position_keys{}, target_keys{}, up_keys{};
  Easing easing = Easing::linear;
  glm::dvec3 up{0.0, 1.0, 0.0};
  double fov_y_degrees = 40.0;
  double near_m = 0.1;
  double far_m = 100.0;
  /// The camera's way around the target, about `up`, by frame.
  double orbit_degrees_per_frame = 0.0;
  /// How long the shutter is open, in frames, that the scene suggests (parameter::kShutter).
  double shutter_frames = 0.0;
};

/// The lens that the scene suggests; the command line can overrule every value.
struct SceneLens {
  ThinLens lens;  ///< at frame 0; lens_at() gives it at others
  /// If not empty: frames from 0 on, increasing.
  OfLensNumbers<std::vector<Keyframe>> keys{};
  Easing easing = Easing::linear;
  double coc_scale = 1.0;
  /// Largest CoC as a radius in pixels of a picture 1024 rows high; scaled with the
  /// height, so that a picture looks the same at every size.
  double max_coc_px_at_1024 = 16.0;
};

enum class LightKind : std::uint8_t { directional, point };

/// How a light's shadows are made (scenes/shadows).
enum class ShadowKind : std::uint8_t { none, projected, volumes, map };

/// Of a scene.
inline constexpr std::size_t kMostLights = 64;

/// Lights with shadows: a bit each in a stencil of 8.
inline constexpr int kMostShadowLights = 8;

/// How a shadow map is made and read (shadows/shadow_map.h).
struct ShadowMapSettings {
  int size = 1024;           ///< texels along an edge, kLeastMapSize to kMostMapSize
  double bias = 0.5;         ///< towards the light, in widths of what a look into the map reaches
  double slope_bias = 0.75;  ///< the same, times the tangent of the light's angle
  int kernel = 1;            ///< odd, 1 to kMostMapKernel: so many texels in square are compared
  int cascades = 1;          ///< 1 to kMostCascades; of a directional light with fits_camera
  bool fits_camera = true;   ///< the map holds what the camera can see, or else all casters
  bool operator==(const ShadowMapSettings&) const = default;
};
inline constexpr int kLeastMapSize = 16, kMostMapSize = 8192;
inline constexpr int kMostMapKernel = 9, kMostCascades = 4;
inline constexpr double kMostMapBias = 1000.0;

/// Where the light ends on a curved surface of few facets (shadows/terminators.h): where a facet
/// turns away; where the normals do; or at facets, faded towards them.
enum class Terminator : std::uint8_t { facets, normals, fade };

struct Light {
  LightKind kind = LightKind::directional;
  /// Of a directional light: towards the light, any length. Of a point light: where it is.
  glm::vec3 position_or_direction{0.0f, 1.0f, 0.0f};
  glm::vec3 colour{1.0f};
  ShadowKind shadows = ShadowKind::none;
  ShadowMapSettings map{};  ///< if they are made by a map
  /// The part of the light's share that a shadow takes away, 0 to 1.
  float shadow_darkness = 1.0f;
  Terminator terminator = Terminator::facets;
  // The size of a light with shadows (draw/light_points.h). A light of size 0 is a point.
  double radius_m = 0.0;                ///< of a point light, a ball; 0 to 1e6
  double angular_radius_degrees = 0.0;  ///< of a directional one, a disc in the sky; 0 to 90
};
inline constexpr double kMostAngularRadius = 90.0;

struct SurfaceShaders;  // surfaces/shader_surface.h

/// Blinn-Phong, evaluated at the vertices.
struct Material {
  std::string name;
  glm::vec3 ambient{0.2f};  ///< multiplies the scene's ambient light
  glm::vec3 diffuse{0.8f};
  glm::vec3 specular{0.0f};
  int shininess = 32;  ///< a whole number, 1 to 1024: a power by multiplication is exact
  std::optional<std::uint32_t> texture;  ///< multiplies ambient and diffuse; index into textures
  Sampler sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
  float opacity = 1.0f;  ///< 0 to 1: the share of what is behind that the surface hides
  /// Its red multiplies `opacity`; index into textures (see make/procedural_texture.h).
  std::optional<std::uint32_t> opacity_texture;
  Sampler opacity_sampler{Filter::trilinear, Wrap::repeat, Wrap::repeat};
  /// The surface is there where opacity_texture is 1/2 or more, nowhere else, and `opacity` alone
  /// says how much it hides. Loaders choose this where all texels are 0 or 1.
  bool cut_out = false;
  bool two_sided = false;  ///< drawn from both sides, lit on the side that is seen
  bool lit = true;         ///< false: the diffuse colour (times texture) as it is
  std::shared_ptr<const SurfaceShaders> shaders{};  ///< a user's, in place of the usual ones
};

/// Triangles, counter-clockwise seen from outside. One normal a vertex, unit length;
/// uvs one a vertex or none.
struct Mesh {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> uvs;
  std::vector<std::uint32_t> indices;
  std::vector<glm::vec3> colours{};  ///< multiply ambient and diffuse; one a vertex or none
};

/// Whether an object is drawn as a relief impostor (relief/impostors/scene_impostors.h): wherever
/// it can be, or where that is predicted to cost less than its triangles.
enum class ImpostorUse : std::uint8_t { never, wherever_possible, where_cheaper };

struct ImpostorBudget {
  double tolerance_px = 1.0;  ///< how far a pixel may lie from where geometry would have it
  double memory_mb = 256.0;   ///< of the reliefs
  double milliseconds = 0.0;  ///< predicted, a frame: it raises the tolerance; 0: any
};

struct NodeMotion;  // models/node_motion.h

/// A mesh put into the world: where its model moves it, then scaled, then turned about x, y and z
/// in that order, then moved.
struct Object {
  std::uint32_t mesh = 0;
  std::uint32_t material = 0;
  glm::dvec3 mesh_origin{0.0};  ///< what was subtracted from the mesh's positions
  glm::dvec3 position{0.0};
  glm::dvec3 rotation_degrees{0.0};
  glm::dvec3 scale{1.0};
  /// Turned so much more with every frame.
  glm::dvec3 spin_degrees_per_frame{0.0};
  /// Moved to and fro: + sway * sin(360 (frame / period + phase) degrees).
  glm::dvec3 sway{0.0};
  double sway_period_frames = 1.0;
  double sway_phase = 0.0;
  ImpostorUse impostor = ImpostorUse::never;
  std::uint32_t model = 0;  ///< parts of one model, one after the other, have one number; 0: alone
  std::shared_ptr<const NodeMotion> motion{};  ///< within its model; null: it stands still there
};

/// Whether it stands elsewhere at another frame.
inline bool moves(const Camera& camera) {
  return camera.orbit_degrees_per_frame != 0.0 || camera.position_keys[0].size() > 1 ||
         camera.target_keys[0].size() > 1 || camera.up_keys[0].size() > 1;
}
inline bool moves(const Object& object) {
  return object.motion != nullptr || object.spin_degrees_per_frame != glm::dvec3{0.0} ||
         object.sway != glm::dvec3{0.0};
}

/// What stands far behind the subject: objects whose positions are farther from `eye` than that
/// (make/backdrop.h moves it).
struct Backdrop {
  glm::dvec3 eye{0.0};
  double beyond_m = 0.0;
};

/// As many halves can be added in binary64 without a rounding (draw/light_points.h).
inline constexpr int kMostLightPoints = 4096;
inline constexpr int kUsualLightPoints = 16;

struct Scene {
  std::string name;
  std::string title;
  Camera camera;
  SceneLens lens;
  glm::vec3 background{0.0f};
  glm::vec3 ambient_light{0.2f};
  std::vector<Light> lights;
  int light_points = kUsualLightPoints;  ///< of lights with a size; 1 to kMostLightPoints
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Object> objects;
  std::optional<Backdrop> backdrop;  ///< one object at least is of it
  ImpostorBudget impostors;
  std::vector<ChosenEffect> effects;  ///< on the finished picture
  /// What was missing, a line each: a model's texture, say.
  std::vector<std::string> warnings;
  std::vector<std::string> notes{};  ///< what was chosen for it, a line each
  /// What it was read from: the scene's file, models, material libraries, textures.
  std::vector<std::filesystem::path> files;
};

std::size_t triangle_count(const Scene& scene);

}  // namespace softfocus
