#pragma once
// --samples, --jitter, --until and --aperture-blades: how the methods that draw the scene
// themselves sample the lens.

#include "scenes/lens_views/lens_view_method.h"
#include "tools/cli/parser.h"

namespace softfocus {

void add_sampling_options(CLI::App& parser, Sampling& sampling);

/// Once all options are read: --until without --samples may take kMostSamples.
void complete_sampling(Sampling& sampling, const CLI::App& parser);

/// Throws UsageError if one of them was given, for a filter does not sample the lens.
void refuse_sampling_options(const CLI::App& parser, std::string_view method);

}  // namespace softfocus
