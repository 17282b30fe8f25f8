#pragma once
// A user's pipeline (dof/pipelines) run by a GL driver, with the GLSL of its files.

#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "dof/pipelines/pipeline.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// Links and makes what a pipeline needs for pictures of one size and one lens, to be run many
/// times. It refers to the pipeline.
class PipelineOnGl {
 public:
  /// Throws ShaderError for what the driver refuses, DriverError for what no driver is given:
  /// SPIR-V, uniform blocks, inputs that are no vectors.
  PipelineOnGl(const GlContext& context, const Pipeline& pipeline, const DofInput& input);

  /// Told what a pass made, after each of its turns.
  using OnPass = std::function<void(std::size_t pass, const GlTarget& made)>;

  /// `picture` as source_image() has it.
  void run(const GlTexture& picture, const OnPass& on_pass = {});

  /// What the last pass made: its first colour is the result.
  const GlTarget& result() const { return *last_; }

 private:
  struct Pass {
    GlProgram program;
    PassRun run;
    std::vector<GlTarget> targets;  ///< two of one that is repeated: it reads what it drew before
  };

  const Pipeline& pipeline_;
  std::vector<Pass> passes_{};
  GlBuffer corners_{};
  std::vector<GlTexture> textures_{};
  std::map<PipelineSource, GlTexture> depths_{};
  std::vector<const GlTarget*> drawn_{};  ///< of each pass
  const GlTarget* last_ = nullptr;

  const GlTexture& texture_of(const PipelineInput& input, const GlTexture& picture) const;
  void draw(std::size_t number, std::size_t turn, const GlTexture& picture);
};

}  // namespace softfocus
