#pragma once
// Everything that `bench` is told.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dof/dof.h"
#include "dof/fixed_pictures/arithmetic.h"
#include "raster/effects/effect.h"
#include "raster/numbers/profile.h"
#include "tools/cli/option_values.h"
#include "tools/cli/parser.h"
#include "tools/gl/driver/driver.h"
#include "tools/options/lens_options.h"
#include "tools/options/method_options.h"
#include "tools/options/run_options.h"
#include "tools/sequence/frame_names.h"

namespace softfocus {

/// Exactly one of scene, triangles and image is given.
struct BenchOptions {
  std::string scene;                 ///< as `render` takes it
  std::optional<int> triangles;      ///< of a sphere field
  std::optional<PictureSize> image;  ///< nothing is drawn: a picture of that size is filtered
  std::vector<std::filesystem::path> scene_path;
  PictureSize size;
  int samples = 1;  ///< of a pixel
  double frame = 0.0;
  std::optional<FrameRange> frames;  ///< of a scene: timed one after the other as well
  MethodChoice method{.filter = find_method("two-pass")};
  std::vector<ChosenEffect> effects;  ///< these alone are timed, on the sharp picture
  bool all_effects = false;           ///< all that the subject is enough for
  Arithmetic arithmetic = Arithmetic::floats;
  Sampling sampling;  ///< of a method that draws the scene
  AutoGoal goal;      ///< of auto
  Verify verify = Verify::in_doubt;
  LensOptions lens;
  std::optional<float> max_coc_px;
  Profile profile;
  std::string profile_name = "ieee";
  PoolOptions pool;
  bool copies = false;  ///< --copy
  int runs = 15;
  const Driver* versus = nullptr;
  bool json = false;
  bool quiet = false;
};

void add_bench_options(CLI::App& parser, BenchOptions& options);

/// Throws UsageError for options that are missing or exclude each other; settles the size.
void complete(BenchOptions& options, const CLI::App& parser);

}  // namespace softfocus
