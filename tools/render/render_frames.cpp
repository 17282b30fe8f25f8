#include "tools/render/render_frames.h"

#include <optional>

#include "scenes/draw/frame_matrices.h"
#include "scenes/load/pipeline_file.h"
#include "scenes/relief/impostors/scene_impostors.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/pictures/picture_notes.h"
#include "tools/render/options.h"
#include "tools/render/performance_report.h"
#include "tools/render/picture_files.h"
#include "tools/sequence/journal.h"

namespace softfocus {
namespace {

/// The outputs that each frame has one of.
struct FrameOutputs {
  FrameOutput picture;
  std::optional<FrameOutput> depth, report;
};

FrameOutputs outputs_of(const RenderOptions& options) {
  FrameOutputs outputs{FrameOutput{"-o", options.output}, {}, {}};
  if (options.depth_output) outputs.depth.emplace("--depth-output", *options.depth_output);
  if (options.report) outputs.report.emplace("--report", options.report->string());
  return outputs;
}

RenderOptions options_of(const RenderOptions& all, const FrameOutputs& outputs,
                         FrameNumber number) {
  RenderOptions options = all;
  options.frame = static_cast<double>(number);
  options.lens = at_frame(all.lens, options.frame);
  options.output = outputs.picture.at(number);
  if (outputs.depth) options.depth_output = outputs.depth->at(number);
  if (outputs.report) options.report = outputs.report->at(number);
  return options;
}

FrameWork work_of(const RenderOptions& options, FrameNumber number, const Scene& scene,
                  const std::string& settings) {
  FrameWork work{.number = number,
                 .file = options.output,
                 .settings = hash_of(settings + lens_text(options.lens))};
  work.inputs = scene.files;
  for (const auto& [name, text] : options.shaders.own) {
    work.inputs.push_back(options.shaders.folder / name);
  }
  if (options.method.filter != nullptr) {
    for (const std::string& file : files_of(*options.method.filter)) work.inputs.emplace_back(file);
  }
  if (options.output != "-") work.outputs = {options.output};
  if (const auto sidecar = sidecar_place(options)) work.outputs.push_back(*sidecar);
  for (std::size_t layer = 2; options.show != Show::image && layer <= layers_of(options); ++layer) {
    work.outputs.push_back(layer_place(options, layer));
  }
  if (options.depth_output) work.outputs.emplace_back(*options.depth_output);
  if (options.report) work.outputs.push_back(*options.report);
  return work;
}

/// Decoded, as each frame has them for itself.
std::uint64_t bytes_of_textures(const Scene& scene) {
  std::uint64_t texels = 0;
  for (const Texture& texture : scene.textures) {
    for (const Image& level : texture.levels) {
      texels += static_cast<std::uint64_t>(level.width) * static_cast<std::uint64_t>(level.height);
    }
  }
  return texels * 4 * sizeof(float);
}

}  // namespace

int render_frames(const RenderOptions& options, const CLI::App& parser, const Scene& scene,
                  const RenderFrame& render) {
  const FrameOutputs outputs = outputs_of(options);
  const bool depend = checked_effect_of_frames(options, scene).has_value();
  std::string settings = given_settings(parser, options.profile);
  if (depend) {
    const FrameSequence sequence = frame_sequence(options);
    settings += ", after frames from " + short_number(sequence.first) + " by " +
                short_number(sequence.step);
  }
  const bool needs_lens = options.show == Show::coc || has_depth_of_field(options);
  std::vector<FrameWork> frames;
  for (const FrameNumber number : chosen_frames(options.sequence, {})) {
    const RenderOptions frame = options_of(options, outputs, number);
    frames.push_back(work_of(frame, number, scene, settings));
    if (!needs_lens || options.autofocus || !options.sharp_depths.empty()) continue;
    try {
      check_lens(overruled(lens_at(scene.lens, frame.frame), frame.lens), frame.lens,
                 options.scene);
    } catch (const UsageError& error) {
      throw UsageError("frame " + std::to_string(number) + ": " + error.what());
    }
  }
  check_outputs_apart(frames);
  frames = of_shard(std::move(frames), options.sequence.shard);
  FrameRunOptions run = run_options(options.sequence, options.output, options.format, options.pool,
                                    options.json, options.verbose);
  run.quiet = options.quiet;
  // A driver belongs to one thread, and so do impostors that are kept from frame to frame. Frames
  // that depend on those before come in their order.
  if (options.gl == nullptr && !depend && !has_impostors(scene)) {
    run.at_once = frames_at_once(frames.size(), options.pool.threads,
                                 bytes_of_a_frame(options) + bytes_of_textures(scene),
                                 memory_bytes().value_or(0));
  }
  return run_frames(frames, run, [&](std::size_t frame, FrameRun& frame_run) {
    render(options_of(options, outputs, frames[frame].number), frame_run);
  });
}

}  // namespace softfocus
