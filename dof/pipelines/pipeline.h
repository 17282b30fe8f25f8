#pragma once
// A user's passes on a picture with depth: shaders one after the other, with what each reads, its
// size, its format and its uniforms. scenes/load/pipeline_file.h reads one from a file.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "dof/pipelines/expression.h"
#include "raster/images/sampler.h"
#include "raster/shaders/shader.h"
#include "raster/shaders/shader_error.h"

namespace softfocus {

/// What expressions know by name, before the parameters.
enum class PipelineValue : std::uint8_t {
  width,  ///< of the picture, pixels
  height,
  pass_width,  ///< of what the pass draws
  pass_height,
  radius_at_infinity_px,  ///< PixelCoc's
  focus_m,
  max_coc_px,  ///< DofSettings'
  leak,
  aperture_radius_m,  ///< FrameValues'
  near_m,
  far_m,
  frame,
  seconds,
  turn,  ///< of a pass that is repeated, from 0
};
inline constexpr std::array<std::string_view, 14> kPipelineValues{"width",
                                                                  "height",
                                                                  "pass_width",
                                                                  "pass_height",
                                                                  "radius_at_infinity_px",
                                                                  "focus_m",
                                                                  "max_coc_px",
                                                                  "leak",
                                                                  "aperture_radius_m",
                                                                  "near_m",
                                                                  "far_m",
                                                                  "frame",
                                                                  "seconds",
                                                                  "turn"};

inline constexpr double kFramesPerSecond = 60.0;

/// A number that the user may set.
struct PipelineParameter {
  std::string name{}, summary{};
  double least = 0.0, most = 0.0;
  bool is_whole = false;
  double value = 0.0;
};

enum class PipelineSource : std::uint8_t {
  previous,      ///< what was drawn last; first the picture
  picture,       ///< colour, and the depth in metres in alpha
  depth,         ///< R32F: metres
  buffer_depth,  ///< R32F: 0 at near_m, 1 at far_m, as a depth buffer has it
  texture,       ///< Pipeline::textures
  pass,          ///< an output of a pass before
};

struct PipelineInput {
  std::uint32_t texture = 0;  ///< the shader's number of it
  PipelineSource source{};
  std::size_t number = 0, output = 0;
  Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
};

/// A uniform's numbers: one for each of its words, one for all, or one for each row of a vector.
struct PipelineUniform {
  std::size_t number = 0;  ///< of ShaderUniforms::all
  std::vector<Expression> values{};
};

struct PipelinePass {
  std::string name{};
  std::string where{};  ///< what errors begin with: "mine.toml:12"
  UserShader shader{};
  std::string text{};  ///< its GLSL, for drivers
  std::vector<PipelineInput> inputs{};
  /// A later one of the same number counts.
  std::vector<PipelineUniform> uniforms{};
  Expression width{}, height{};  ///< pixels
  Expression turns = constant_expression(1.0);
  std::vector<Format> targets{};            ///< by location
  std::vector<std::string> target_names{};  ///< for inputs of later passes; may be empty
};

/// Compiled shaders, by what their uniforms are.
struct PipelinePrograms;

struct Pipeline {
  std::string name{}, summary{};
  std::vector<PipelineParameter> parameters{};
  std::vector<Texture> textures{};
  std::vector<std::string> texture_names{};
  std::vector<PipelinePass> passes{};
  /// Whether pictures are sRGB codes of 8 bits, opaque, the lowest row first, as a browser has
  /// them; otherwise they are RGBA16F, linear, with the depth in alpha, the highest row first.
  bool by_codes = false;
  std::uint64_t hash = 0;  ///< of all that it was read from
  std::shared_ptr<PipelinePrograms> programs{};
};

/// The names that expressions may use: kPipelineValues, then the parameters.
std::vector<std::string> value_names(const Pipeline& pipeline);

/// Where texels come from by that name; nothing if there is none. And all such names.
std::optional<PipelineInput> source_named(const Pipeline& pipeline, std::string_view name);
std::vector<std::string> source_names(const Pipeline& pipeline);

/// Adds a pass for a fragment shader, of the picture's size and format, with the uniforms that have
/// the name of a value or a parameter, or one that other programs give to such a number
/// (iResolution, cameraNear). Throws ShaderError for a shader of another stage.
PipelinePass& add_pass(Pipeline& pipeline, std::string where, UserShader shader);

/// Several textures are left without a source.
struct UnnamedTextures : ShaderError {
  using ShaderError::ShaderError;
};

/// Where what has no input yet gets its texels: from what has its name (a pass, a texture,
/// "picture", "depth", "buffer_depth"); the one that is left from what was drawn last. Compiles
/// everything once. Throws ShaderError, and UnnamedTextures: `how_to_name` says what to do.
void finish_pipeline(Pipeline& pipeline, std::string_view how_to_name);

/// Whether anything depends on the lens.
bool reads_lens(const Pipeline& pipeline);

// What another device needs to run a pipeline.

/// A pass as it runs.
struct PassRun {
  int width = 0, height = 0;
  std::vector<std::vector<std::uint32_t>> words{};  ///< of its uniforms, turn by turn
};

/// In the order of passes. Throws ShaderError for a number that cannot be.
std::vector<PassRun> pass_runs(const Pipeline& pipeline, const DofInput& input);

/// What passes read as `picture`, `depth` or `buffer_depth`.
Image source_image(const Pipeline& pipeline, const DofInput& input, PipelineSource source);

/// What the last pass drew, of its first target, as run_pipeline()'s result of the same size.
void store_result(const Pipeline& pipeline, const DofInput& input, const Image& drawn,
                  const ImageView& result, ThreadPool& pool);

/// Told what a pass made, after each of its turns.
using OnPass = std::function<void(std::size_t pass, std::span<const Texture> made)>;

/// Writes every pixel of `result`, with the depths of input.scene: the first target of the last
/// pass. Throws ShaderError if that has another size, or for a number that cannot be.
void run_pipeline(const Pipeline& pipeline, const DofInput& input, const ImageView& result,
                  ThreadPool& pool, const OnPass& on_pass = {});

}  // namespace softfocus
