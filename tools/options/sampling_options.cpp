#include "tools/options/sampling_options.h"

#include <array>

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

constexpr std::array kOptions{"--samples", "--jitter", "--until", "--aperture-blades"};

}  // namespace

void add_sampling_options(CLI::App& parser, Sampling& sampling) {
  add_value(parser, "--samples", "N",
            "Of accumulation and ray-traced: points on the lens, 1 to 65536 (default: " +
                std::to_string(sampling.samples) + ", with --until 65536)",
            [&sampling](const std::string& text) {
              sampling.samples =
                  parse_whole("--samples", text, 1, kMostSamples, "a whole number from 1 to 65536");
            });
  add_flag(parser, "--jitter",
           "Of the same: look from all over each pixel, not from its centre alone",
           sampling.jitter);
  add_value(parser, "--until", "ERROR",
            "Of the same: stop when two half-sets of samples differ by this RMS of linear values",
            [&sampling](const std::string& text) {
              sampling.until =
                  parse_number("--until", text, 1e-9, 1e9, "an error above 0, such as 0.001");
            });
  add_value(parser, "--aperture-blades", "N",
            "Of the same: an aperture of 3 to 64 straight blades, 0 = round (default: 0)",
            [&blades = sampling.aperture.blades](const std::string& text) {
              constexpr const char* kWanted = "0 for a disc or a whole number from 3 to 64";
              blades = parse_whole("--aperture-blades", text, 0, kMostBlades, kWanted);
              if (blades == 1 || blades == 2) {
                throw UsageError("--aperture-blades '" + text + "': give " + kWanted);
              }
            });
}

void complete_sampling(Sampling& sampling, const CLI::App& parser) {
  if (sampling.until && !is_given(parser, "--samples")) sampling.samples = kMostSamples;
}

void refuse_sampling_options(const CLI::App& parser, std::string_view method) {
  for (const char* option : kOptions) {
    if (!is_given(parser, option)) continue;
    throw UsageError(std::string{option} + ": the method " + std::string{method} +
                     " does not sample the lens; give --method " + names_of(lens_view_methods()));
  }
}

}  // namespace softfocus
