#pragma once
// What the parts of a random scene are put on: the scene so far, its random numbers, and the
// camera, by whose picture everything is placed. Lengths are metres.

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "raster/numbers/random_bits.h"
#include "scenes/make/procedural_texture.h"
#include "scenes/scene.h"

namespace softfocus {

/// The floor is y = 0. The camera looks along -z, and down on the subject.
struct Stage {
  Scene scene;
  std::vector<ProceduralTexture> textures;  ///< the scene's, which are made at the end
  RandomSequence random;
  double subject_m = 1.0;       ///< the subject's distance along the axis
  double subject_height = 0.3;  ///< it stands on the floor, in the middle of the picture
  double tangent = 0.36;        ///< of half the field of view
  double backdrop_m = 1e9;      ///< nothing is seen behind this
  double nearest_m = 1e9;       ///< of all parts, roughly
  glm::dvec3 right{1.0, 0.0, 0.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  glm::dvec3 forwards{0.0, 0.0, -1.0};
};

inline double between(Stage& stage, double low, double high) {
  return next_between(stage.random, low, high);
}

/// Even in its logarithm: as likely from 1 to 2 as from 2 to 4.
double log_between(Stage& stage, double low, double high);

/// From `low` to `high`, both included.
int count_between(Stage& stage, int low, int high);

inline bool happens(Stage& stage, double share) { return between(stage, 0.0, 1.0) < share; }

/// Arguments of a function are evaluated in any order: draw each number in a statement of its
/// own, or in braces.
template <class List>
auto one_of(Stage& stage, const List& list) {
  return list[next_bits(stage.random) % list.size()];
}

/// The point seen at a place of the picture, which is 2 high, 0 in the middle, y upwards.
glm::dvec3 seen_at(const Stage& stage, glm::dvec2 place, double depth_m);

/// The size of `pixels` of 1024 rows at a depth.
inline double pixels_at(const Stage& stage, double pixels, double depth_m) {
  return pixels * 2.0 * stage.tangent * depth_m / 1024.0;
}

/// Notes that a part comes so near.
void reach_to(Stage& stage, double depth_m);

/// Linear, of any hue; `brightness` bounds each channel.
glm::vec3 any_colour(Stage& stage, double brightness);

struct TextureChoice {
  bool textured = true;
  int cells = 6;
  int size = 128;  ///< texels along a side
};

/// Lit, with or without a texture made by formula, dull or with highlights.
std::uint32_t any_material(Stage& stage, const TextureChoice& choice);

std::uint32_t add_material(Stage& stage, const Material& material);
std::uint32_t add_mesh(Stage& stage, Mesh mesh);

/// A mesh of the stage at a place, turned and scaled.
struct Placement {
  glm::dvec3 position{0.0};
  glm::dvec3 rotation_degrees{0.0};
  glm::dvec3 scale{1.0};
};
void add_object(Stage& stage, std::uint32_t mesh, std::uint32_t material, const Placement& at);

glm::dvec3 any_rotation(Stage& stage);

// The parts of random scenes, from the back to the front. Each draws what it needs from the
// stage's random numbers.

// --- backdrops.cpp: set Stage::backdrop_m ---

void add_wall(Stage& stage);
void add_room(Stage& stage);
/// A sky, without anything in it.
void add_sky(Stage& stage);
void add_night(Stage& stage);
/// `cells` of the texture; the more, the finer.
void add_floor(Stage& stage, double fields_a_metre);

// --- things.cpp ---

/// One to three shapes, about the subject's place.
void add_still_life(Stage& stage);
/// Head and shoulders.
void add_bust(Stage& stage);
/// Boxes that stand on the floor, as furniture or houses do.
void add_blocks(Stage& stage, int count);
/// Small things at all depths, from `nearest` to `farthest` times the subject's distance.
void add_clutter(Stage& stage, int count, double nearest, double farthest);
/// Lamps of 1 to 100 times white, most of them behind the subject.
void add_lamps(Stage& stage, int count);
/// Thin rings and rods with highlights of up to 100 times white.
void add_bright_edges(Stage& stage, int count);

// --- foregrounds.cpp: return the distance along the axis at which they can be in focus, or 0 ---

double add_fence(Stage& stage);
double add_foliage(Stage& stage);
double add_near_things(Stage& stage);

}  // namespace softfocus
