#pragma once
// The cases that are drawn twice and compared, by stage of the pipeline. A new case goes into its
// stage's file; a new stage also into this list.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "raster/numbers/profile.h"
#include "raster/numbers/random_bits.h"
#include "raster/threads/parallel.h"
#include "scenes/scene.h"
#include "tools/crosscheck/tally.h"
#include "tools/gl/driver/context.h"
#include "tools/gl/shaders.h"

namespace softfocus {

/// The two sides of a comparison.
struct Bench {
  const GlContext& gl;
  const Shaders& shaders;
  const Profile& profile;
  ThreadPool& pool;
};

struct Case {
  std::string stage;
  std::string name;
  bool quick;     ///< part of --quick
  bool slow_too;  ///< small enough for a driver that is slow
  std::function<void(const Bench&, Tally&)> run;
  bool has_samples = false;  ///< for drivers that draw several samples a pixel
};

/// All cases, in the order of the pipeline's stages.
std::vector<Case> crosscheck_cases();
/// The quick ones that any driver draws, WebGL2's too; if there are to be few, each shader's
/// cheapest or so: the first of a stage, and what has shaders that it lacks.
std::vector<Case> quick_cases(bool few);

// One function a file.
/// Of a pipeline's method: pass by pass, and the result. `stage` is its file's name.
void add_pipeline_cases(const std::string& method, std::vector<Case>& cases);
void add_store_cases(std::vector<Case>& cases);
void add_texture_cases(std::vector<Case>& cases);
void add_triangle_cases(std::vector<Case>& cases);
void add_scene_cases(std::vector<Case>& cases);
void add_peel_cases(std::vector<Case>& cases);
void add_blend_cases(std::vector<Case>& cases);
void add_kernel_cases(std::vector<Case>& cases);
void add_effect_cases(std::vector<Case>& cases);
void add_motion_cases(std::vector<Case>& cases);
void add_temporal_cases(std::vector<Case>& cases);
void add_filter_cases(std::vector<Case>& cases);
void add_shadow_cases(std::vector<Case>& cases);
void add_shadow_map_cases(std::vector<Case>& cases);
void add_shadow_volume_cases(std::vector<Case>& cases);
void add_relief_cases(std::vector<Case>& cases);
void add_polygon_cases(std::vector<Case>& cases);

/// A scene that comes along, or one of the two that scene_cases.cpp makes. Making a scene's
/// textures takes longer than drawing it small: each is loaded once.
const Scene& loaded_scene(const std::string& name);

/// Random numbers for making cases up.
struct RandomNumbers {
  RandomSequence sequence;
  explicit RandomNumbers(unsigned seed) : sequence{seed} {}

  std::uint32_t word() { return static_cast<std::uint32_t>(next_bits(sequence) >> 32); }
  /// From `least` up to `most`.
  float between(float least, float most) {
    return static_cast<float>(
        next_between(sequence, static_cast<double>(least), static_cast<double>(most)));
  }
  /// 0 to count - 1.
  int below(int count) { return static_cast<int>(word() % static_cast<std::uint32_t>(count)); }
};

}  // namespace softfocus
