#include "dof/pipelines/pipeline.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "dof/pipelines/picture_codes.h"
#include "dof/pipelines/pipeline_textures.h"
#include "raster/images/texel.h"
#include "raster/passes/draw_mipmaps.h"
#include "raster/threads/loops.h"

namespace softfocus {

struct PipelinePrograms {
  struct Compiled {
    std::size_t pass = 0;
    std::vector<std::uint32_t> words{};
    std::shared_ptr<const ShaderProgram> program{};
  };
  static constexpr std::size_t kMost = 256;
  std::mutex mutex{};
  std::vector<Compiled> all{};
  std::vector<Image> spare{};  ///< memory of the last run's pictures
};

namespace {

[[noreturn]] void fail(const PipelinePass& pass, const std::string& why) {
  throw ShaderError(pass.where + ": " + why);
}

// --- numbers ---

using Values = std::vector<double>;

double& value_in(Values& values, PipelineValue which) {
  return values[static_cast<std::size_t>(which)];
}

Values values_of(const Pipeline& pipeline, const DofInput& input) {
  Values values(kPipelineValues.size());
  const auto set = [&](PipelineValue which, double value) { value_in(values, which) = value; };
  const DofSettings& settings = input.settings;
  set(PipelineValue::width, input.scene.width);
  set(PipelineValue::height, input.scene.height);
  set(PipelineValue::radius_at_infinity_px, double{settings.coc.radius_at_infinity_px});
  set(PipelineValue::focus_m, double{settings.coc.focus_m});
  set(PipelineValue::max_coc_px, double{settings.max_coc_px});
  set(PipelineValue::leak, double{settings.leak});
  set(PipelineValue::aperture_radius_m, settings.frame.aperture_radius_m);
  set(PipelineValue::near_m, settings.frame.near_m);
  set(PipelineValue::far_m, settings.frame.far_m);
  set(PipelineValue::frame, settings.frame.number);
  set(PipelineValue::seconds, settings.frame.number / kFramesPerSecond);
  for (const PipelineParameter& parameter : pipeline.parameters) values.push_back(parameter.value);
  return values;
}

std::vector<std::uint32_t> words_of(const PipelinePass& pass, const Values& values) {
  std::vector<std::uint32_t> words = pass.shader.uniforms.words;
  for (const PipelineUniform& uniform : pass.uniforms) {
    const ShaderUniform& of = pass.shader.uniforms.all[uniform.number];
    const std::size_t count = uniform.values.size();
    for (std::uint32_t i = 0; i < of.words; ++i) {
      const std::size_t at = count == 1 ? 0 : count == of.words ? i : i % of.rows;
      const double value = at < count ? evaluate(uniform.values[at], values) : 0.0;
      const std::optional<std::uint32_t> word = uniform_word(of, value);
      if (!word) {
        fail(pass, "the uniform '" + of.name + "' is " + std::to_string(value) +
                       "; a whole number of 32 bits" + (of.is_signed ? "" : ", not below 0,") +
                       " would be right");
      }
      words[of.first + i] = *word;
    }
  }
  return words;
}

/// A whole number from 1 to `most`.
int count_of(const PipelinePass& pass, const Expression& expression, const Values& values,
             const char* what, int most) {
  const double value = evaluate(expression, values);
  if (!(value >= 1.0 && value <= most) || value != std::floor(value)) {
    fail(pass, std::string{what} + " is " + std::to_string(value) + "; a whole number from 1 to " +
                   std::to_string(most) + " would be right");
  }
  return static_cast<int>(value);
}

std::shared_ptr<const ShaderProgram> program_of(const Pipeline& pipeline, std::size_t number,
                                                std::vector<std::uint32_t> words) {
  PipelinePrograms& programs = *pipeline.programs;
  const std::lock_guard lock(programs.mutex);
  for (const PipelinePrograms::Compiled& of : programs.all) {
    if (of.pass == number && of.words == words) return of.program;
  }
  const PipelinePass& pass = pipeline.passes[number];
  auto program =
      std::make_shared<const ShaderProgram>(compile_shader(pass.shader, words, {}, true));
  if (programs.all.size() >= PipelinePrograms::kMost) programs.all.clear();
  programs.all.push_back({number, std::move(words), program});
  return program;
}

// --- textures ---

/// Of zeros, or, unless they are wanted, of what it held before.
Image take_image(const Pipeline& pipeline, Format format, int width, int height, bool of_zeros) {
  Image found;
  {
    const std::lock_guard lock(pipeline.programs->mutex);
    std::vector<Image>& spare = pipeline.programs->spare;
    const auto at = std::find_if(spare.begin(), spare.end(), [&](const Image& of) {
      return of.format == format && of.width == width && of.height == height;
    });
    if (at == spare.end()) return make_image(format, width, height);
    found = std::move(*at);
    spare.erase(at);
  }
  if (of_zeros) std::fill(found.bytes.begin(), found.bytes.end(), std::byte{0});
  return found;
}

void copy_rows(const ConstImageView& from, const ImageView& to, ThreadPool& pool) {
  constexpr int kRows = 32;
  for_each_band(pool, from.height, kRows, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      const auto texels = row<std::uint16_t>(from, y);
      std::copy(texels.begin(), texels.end(), row<std::uint16_t>(to, y).begin());
    }
  });
}

/// What passes read and have made.
class Drawn {
 public:
  Drawn(const Pipeline& pipeline, const DofInput& input, ThreadPool& pool)
      : pipeline_(pipeline), input_(input) {
    passes.resize(pipeline.passes.size());
    if (pipeline.by_codes) {
      picture_ = make_texture(codes_of(input.scene));
    } else {
      const ConstImageView& from = input.scene;
      picture_ =
          make_texture(take_image(pipeline, Format::rgba16f, from.width, from.height, false));
      copy_rows(from, picture_.levels[0], pool);
    }
  }

  /// Keeps the memory of all for the next run.
  void give_back() {
    std::vector<Image> spare;
    const auto add = [&](std::vector<Texture>& textures) {
      for (Texture& texture : textures) spare.push_back(std::move(texture.levels[0]));
      textures.clear();
    };
    for (std::vector<Texture>& made : passes) add(made);
    if (!pipeline_.by_codes) spare.push_back(std::move(picture_.levels[0]));
    const std::lock_guard lock(pipeline_.programs->mutex);
    pipeline_.programs->spare = std::move(spare);
  }

  std::vector<std::vector<Texture>> passes{};  ///< by their targets
  const Texture* previous = nullptr;

  const Texture* texture_of(const PipelineInput& of) {
    switch (of.source) {
      case PipelineSource::previous: return previous != nullptr ? previous : &picture_;
      case PipelineSource::picture: return &picture_;
      case PipelineSource::depth: return &made(depth_, of.source);
      case PipelineSource::buffer_depth: return &made(buffer_depth_, of.source);
      case PipelineSource::texture: return &pipeline_.textures[of.number];
      case PipelineSource::pass: break;
    }
    if (passes[of.number].empty()) return previous != nullptr ? previous : &picture_;
    return &passes[of.number][of.output];
  }

 private:
  const Pipeline& pipeline_;
  const DofInput& input_;
  Texture picture_{}, depth_{}, buffer_depth_{};

  const Texture& made(Texture& texture, PipelineSource source) {
    if (texture.levels.empty()) texture = make_texture(source_image(pipeline_, input_, source));
    return texture;
  }
};

std::vector<Texture> draw_pass(const Pipeline& pipeline, std::size_t number, const PassRun& run,
                               std::size_t turn, Drawn& drawn, const Profile& profile,
                               const ImageView* result, ThreadPool& pool) {
  const PipelinePass& pass = pipeline.passes[number];
  const auto program = program_of(pipeline, number, run.words[turn]);
  std::vector<ShaderTexture> textures(pass.shader.uniforms.texture_count);
  std::vector<Texture> with_levels;
  with_levels.reserve(pass.inputs.size());
  for (const PipelineInput& input : pass.inputs) {
    const Texture* texture = drawn.texture_of(input);
    if (input.sampler.filter == Filter::trilinear && texture->levels.size() == 1) {
      generate_mipmaps_as(with_levels.emplace_back(*texture), profile);
      texture = &with_levels.back();
    }
    textures[input.texture] = {.texture = texture, .sampler = input.sampler};
  }
  std::vector<Texture> made;
  std::vector<ImageView> targets;
  made.reserve(pass.targets.size());
  targets.reserve(pass.targets.size());
  // What a shader discards stays 0.
  const bool of_zeros = program->killed.is_there;
  for (const Format format : pass.targets) {
    if (result != nullptr) {
      targets.push_back(*result);
      continue;
    }
    made.push_back(make_texture(take_image(pipeline, format, run.width, run.height, of_zeros)));
    targets.push_back(made.back().levels[0]);
  }
  run_shader(*program, {.textures = textures, .targets = targets, .profile = profile}, pool);
  return made;
}

/// Of any format.
void store_colours(const Image& drawn, const Profile& profile, const ImageView& result,
                   ThreadPool& pool) {
  if (drawn.format == Format::rgba16f) return copy_rows(drawn, result, pool);
  for_each_row(pool, result.height, 8, [&](int y) {
    for (int x = 0; x < result.width; ++x) {
      store_texel<Format::rgba16f>(result, x, y, load_texel(drawn, x, y), profile);
    }
  });
}

void keep_depths(const ConstImageView& picture, const ImageView& result, ThreadPool& pool) {
  for_each_row(pool, result.height, 32, [&](int y) {
    const auto from = row<std::uint16_t>(picture, y);
    const auto to = row<std::uint16_t>(result, y);
    for (std::size_t i = 3; i < to.size(); i += 4) to[i] = from[i];
  });
}

/// Whether the last pass can draw where the result goes. What a shader discards there would not
/// be 0.
bool draws_result(const Pipeline& pipeline, const PassRun& last, const ImageView& result) {
  return !pipeline.by_codes && last.words.size() == 1 && result.stride_bytes % 64 == 0 &&
         pipeline.passes.back().targets == std::vector{Format::rgba16f} &&
         !program_of(pipeline, pipeline.passes.size() - 1, last.words[0])->killed.is_there;
}

void check_result_size(const Pipeline& pipeline, const PassRun& last, const ImageView& result) {
  if (last.width == result.width && last.height == result.height) return;
  fail(pipeline.passes.back(), "the last pass draws " + std::to_string(last.width) + " x " +
                                   std::to_string(last.height) + " pixels; the picture's size, " +
                                   std::to_string(result.width) + " x " +
                                   std::to_string(result.height) + ", would be right");
}

// --- uniforms that are known by their names ---

struct UsualUniform {
  std::string_view name;
  std::vector<Expression> values;
};

Expression of(PipelineValue value) {
  return {{{.op = ExpressionOp::value, .value = static_cast<std::uint32_t>(value)}}};
}

Expression one_by(PipelineValue value) {
  Expression made = constant_expression(1.0);
  made.steps.push_back({.op = ExpressionOp::value, .value = static_cast<std::uint32_t>(value)});
  made.steps.push_back({.op = ExpressionOp::divide});
  return made;
}

std::vector<UsualUniform> usual_uniforms() {
  using enum PipelineValue;
  std::vector<UsualUniform> all;
  for (const std::string_view name : {"iResolution", "resolution", "u_resolution", "uResolution"}) {
    all.push_back({name, {of(pass_width), of(pass_height), constant_expression(1.0)}});
  }
  all.push_back({"iChannelResolution", {of(width), of(height), constant_expression(1.0)}});
  for (const std::string_view name : {"OutputSize", "FinalViewportSize"}) {
    all.push_back(
        {name, {of(pass_width), of(pass_height), one_by(pass_width), one_by(pass_height)}});
  }
  for (const std::string_view name : {"InputSize", "TextureSize", "SourceSize", "OriginalSize"}) {
    all.push_back({name, {of(width), of(height), one_by(width), one_by(height)}});
  }
  Expression ratio = of(width);
  ratio.steps.push_back({.op = ExpressionOp::value, .value = static_cast<std::uint32_t>(height)});
  ratio.steps.push_back({.op = ExpressionOp::divide});
  all.push_back({"ratio", {std::move(ratio)}});
  all.push_back({"iFrameRate", {constant_expression(kFramesPerSecond)}});
  for (const std::string_view name : {"iTime", "time", "u_time", "uTime"}) {
    all.push_back({name, {of(seconds)}});
  }
  for (const std::string_view name : {"iFrame", "u_frame", "FrameCount"}) {
    all.push_back({name, {of(frame)}});
  }
  all.push_back({"cameraNear", {of(near_m)}});
  all.push_back({"cameraFar", {of(far_m)}});
  return all;
}

/// Also a member of a block without a name of its own, as libretro's .slang have it.
bool has_name(const ShaderUniform& uniform, std::string_view name) {
  if (uniform.name == name) return true;
  return uniform.name.size() > name.size() && uniform.name.ends_with(name) &&
         uniform.name[uniform.name.size() - name.size() - 1] == '.';
}

}  // namespace

std::vector<std::string> value_names(const Pipeline& pipeline) {
  std::vector<std::string> names{kPipelineValues.begin(), kPipelineValues.end()};
  for (const PipelineParameter& parameter : pipeline.parameters) names.push_back(parameter.name);
  return names;
}

std::optional<PipelineInput> source_named(const Pipeline& pipeline, std::string_view name) {
  if (name == "picture") return PipelineInput{.source = PipelineSource::picture};
  if (name == "depth") return PipelineInput{.source = PipelineSource::depth};
  if (name == "buffer_depth") return PipelineInput{.source = PipelineSource::buffer_depth};
  if (name == "previous") return PipelineInput{.source = PipelineSource::previous};
  const auto& textures = pipeline.texture_names;
  if (const auto at = std::find(textures.begin(), textures.end(), name); at != textures.end()) {
    return PipelineInput{.source = PipelineSource::texture,
                         .number = static_cast<std::size_t>(at - textures.begin())};
  }
  for (std::size_t i = pipeline.passes.size(); i-- > 0;) {
    const PipelinePass& pass = pipeline.passes[i];
    if (pass.name == name) return PipelineInput{.source = PipelineSource::pass, .number = i};
    const auto& names = pass.target_names;
    if (const auto at = std::find(names.begin(), names.end(), name); at != names.end()) {
      return PipelineInput{.source = PipelineSource::pass,
                           .number = i,
                           .output = static_cast<std::size_t>(at - names.begin())};
    }
  }
  return {};
}

std::vector<std::string> source_names(const Pipeline& pipeline) {
  std::vector<std::string> names{"previous", "picture", "depth", "buffer_depth"};
  names.insert(names.end(), pipeline.texture_names.begin(), pipeline.texture_names.end());
  for (const PipelinePass& pass : pipeline.passes) {
    if (!pass.name.empty()) names.push_back(pass.name);
    names.insert(names.end(), pass.target_names.begin(), pass.target_names.end());
  }
  return names;
}

PipelinePass& add_pass(Pipeline& pipeline, std::string where, UserShader shader) {
  PipelinePass& pass = pipeline.passes.emplace_back();
  pass.where = std::move(where);
  pass.shader = std::move(shader);
  if (pass.shader.module->stage != ShaderStage::fragment) {
    fail(pass, "it is a vertex shader; a fragment shader would be right");
  }
  pass.width = of(PipelineValue::width);
  pass.height = of(PipelineValue::height);
  pass.targets = {pipeline.by_codes ? Format::rgba8 : Format::rgba16f};
  const std::vector<UsualUniform> usual = usual_uniforms();
  const std::vector<std::string> names = value_names(pipeline);
  for (std::size_t i = 0; i < pass.shader.uniforms.all.size(); ++i) {
    const ShaderUniform& uniform = pass.shader.uniforms.all[i];
    if (is_texture(uniform)) continue;
    for (const UsualUniform& known : usual) {
      if (has_name(uniform, known.name)) pass.uniforms.push_back({i, known.values});
    }
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (names[v] != uniform.name) continue;
      pass.uniforms.push_back(
          {i, {{{{.op = ExpressionOp::value, .value = static_cast<std::uint32_t>(v)}}}}});
    }
  }
  return pass;
}

void finish_pipeline(Pipeline& pipeline, std::string_view how_to_name) {
  pipeline.programs = std::make_shared<PipelinePrograms>();
  DofInput any;
  any.scene.width = any.scene.height = 64;
  Values values = values_of(pipeline, any);
  value_in(values, PipelineValue::pass_width) = value_in(values, PipelineValue::pass_height) = 64.0;
  for (std::size_t i = 0; i < pipeline.passes.size(); ++i) {
    PipelinePass& pass = pipeline.passes[i];
    bind_textures(pipeline, pass, *program_of(pipeline, i, words_of(pass, values)), how_to_name);
  }
}

bool reads_lens(const Pipeline& pipeline) {
  const auto is_of_lens = [](const Expression& expression) {
    return std::any_of(expression.steps.begin(), expression.steps.end(),
                       [](const Expression::Step& step) {
                         if (step.op != ExpressionOp::value) return false;
                         const auto value = static_cast<PipelineValue>(step.value);
                         return step.value < kPipelineValues.size() &&
                                value >= PipelineValue::radius_at_infinity_px &&
                                value <= PipelineValue::aperture_radius_m;
                       });
  };
  return std::any_of(pipeline.passes.begin(), pipeline.passes.end(), [&](const PipelinePass& pass) {
    return is_of_lens(pass.width) || is_of_lens(pass.height) || is_of_lens(pass.turns) ||
           std::any_of(
               pass.uniforms.begin(), pass.uniforms.end(), [&](const PipelineUniform& uniform) {
                 return std::any_of(uniform.values.begin(), uniform.values.end(), is_of_lens);
               });
  });
}

std::vector<PassRun> pass_runs(const Pipeline& pipeline, const DofInput& input) {
  constexpr int kMostTurns = 1024;
  Values values = values_of(pipeline, input);
  std::vector<PassRun> runs;
  runs.reserve(pipeline.passes.size());
  for (const PipelinePass& pass : pipeline.passes) {
    PassRun& run = runs.emplace_back();
    run.width = count_of(pass, pass.width, values, "the width", kMaxImageSize);
    run.height = count_of(pass, pass.height, values, "the height", kMaxImageSize);
    value_in(values, PipelineValue::pass_width) = run.width;
    value_in(values, PipelineValue::pass_height) = run.height;
    const int turns = count_of(pass, pass.turns, values, "the number of turns", kMostTurns);
    for (int turn = 0; turn < turns; ++turn) {
      value_in(values, PipelineValue::turn) = turn;
      run.words.push_back(words_of(pass, values));
    }
    value_in(values, PipelineValue::turn) = 0.0;
  }
  return runs;
}

Image source_image(const Pipeline& pipeline, const DofInput& input, PipelineSource source) {
  const ConstImageView& picture = input.scene;
  if (source == PipelineSource::picture) {
    if (pipeline.by_codes) return codes_of(picture);
    Image copy = make_image(picture.format, picture.width, picture.height);
    for (int y = 0; y < picture.height; ++y) {
      const auto texels = row<std::uint16_t>(picture, y);
      std::copy(texels.begin(), texels.end(), row<std::uint16_t>(copy, y).begin());
    }
    return copy;
  }
  Image depth = make_image(Format::r32f, picture.width, picture.height);
  const double near = input.settings.frame.near_m, far = input.settings.frame.far_m;
  for (int y = 0; y < picture.height; ++y) {
    const auto to = row<float>(depth, pipeline.by_codes ? picture.height - 1 - y : y);
    for (int x = 0; x < picture.width; ++x) {
      const auto z = static_cast<double>(load_texel<Format::rgba16f>(picture, x, y).w);
      const double buffer = far * (z - near) / (z * (far - near));
      to[static_cast<std::size_t>(x)] =
          static_cast<float>(source == PipelineSource::depth ? z : std::clamp(buffer, 0.0, 1.0));
    }
  }
  return depth;
}

void store_result(const Pipeline& pipeline, const DofInput& input, const Image& drawn,
                  const ImageView& result, ThreadPool& pool) {
  if (pipeline.by_codes) return store_codes(drawn, input.scene, result);
  store_colours(drawn, input.profile, result, pool);
  keep_depths(input.scene, result, pool);
}

void run_pipeline(const Pipeline& pipeline, const DofInput& input, const ImageView& result,
                  ThreadPool& pool, const OnPass& on_pass) {
  const std::vector<PassRun> runs = pass_runs(pipeline, input);
  check_result_size(pipeline, runs.back(), result);
  Drawn drawn{pipeline, input, pool};
  const std::size_t last = runs.size() - 1;
  const bool is_drawn_in_place = !on_pass && draws_result(pipeline, runs[last], result);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ImageView* const place = i == last && is_drawn_in_place ? &result : nullptr;
    for (std::size_t turn = 0; turn < runs[i].words.size(); ++turn) {
      std::vector<Texture> made =
          draw_pass(pipeline, i, runs[i], turn, drawn, input.profile, place, pool);
      if (place != nullptr) break;
      drawn.passes[i] = std::move(made);
      drawn.previous = &drawn.passes[i][0];
      if (on_pass) on_pass(i, drawn.passes[i]);
    }
  }
  if (is_drawn_in_place) {
    keep_depths(input.scene, result, pool);
  } else {
    store_result(pipeline, input, drawn.previous->levels[0], result, pool);
  }
  drawn.give_back();
}

}  // namespace softfocus
