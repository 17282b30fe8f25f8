#include "tools/render/warnings.h"

#include "scenes/draw/surface_draws.h"
#include "scenes/draw/transparent_layers.h"

namespace softfocus {

std::string until_warning(const RenderRecord& record) {
  const Sampling& sampling = record.frame.sampling;
  if (!record.frame.sampled || !sampling.until) return {};
  const auto reached = record.frame.sampled->half_set_rms;
  if (reached && *reached <= *sampling.until) return {};
  const std::string found = reached ? "the half-sets differ by " + short_number(*reached)
                                    : "half-sets are compared from 16 samples on";
  return "--until " + short_number(*sampling.until) + ": not reached with " +
         count_text(record.frame.sampled->samples, "sample") + ": " + found;
}

std::string goal_warning(const RenderOptions& options, const RenderRecord& record) {
  if (!record.frame.chosen || record.frame.chosen->choice.meets_goal) return {};
  const AutoMethod& choice = record.frame.chosen->choice;
  if (record.frame.chosen->measured_error) {
    return "--max-error " + short_number(options.goal.max_error) + ": not kept to; " +
           setting_text(choice) + " shows an error of " +
           short_number(*record.frame.chosen->measured_error);
  }
  return "--max-error " + short_number(options.goal.max_error) +
         ": no method is predicted to keep to it; " + setting_text(choice) +
         " comes nearest, with a predicted error of " + short_number(choice.predicted_error);
}

std::string transparent_warning(const Scene& scene, const FrameParts& parts,
                                const RenderOptions& options) {
  if (!has_transparent(scene)) return {};
  const bool filters = options.show == Show::image && options.method.filter != nullptr;
  if (options.show == Show::image && options.method.name() == "surface-splatting") {
    return "--method surface-splatting: surfaces of opacity 1/2 or more are drawn opaque, other "
           "transparent ones not at all";
  }
  if (filters && options.method.name() != "pinhole" &&
      (options.gl != nullptr || options.arithmetic != Arithmetic::floats ||
       !options.sharp_depths.empty())) {
    return std::string{options.gl != nullptr                      ? "--gl"
                       : options.arithmetic != Arithmetic::floats ? "--arithmetic"
                                                                  : "--sharp-depths"} +
           ": a transparent surface and what is seen through it are blurred by one circle";
  }
  if (parts.transparent.size() < kTransparentLayers) return {};
  return "there are pixels of " + std::to_string(kTransparentLayers) +
         " transparent surfaces; if there are more behind them, those are left out";
}

}  // namespace softfocus
