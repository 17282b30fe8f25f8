#pragma once
// Refocusing the frames of a sequence.

#include <functional>
#include <vector>

#include "tools/refocus/options.h"

namespace softfocus {

/// A frame's pictures and working memory while it is refocused: the colour as planes and as a
/// picture, the depth, the filtered picture and one between.
inline constexpr std::uint64_t kRefocusBytesPerPixel = 64;

/// COLOUR, DEPTH and --mask, those that are given.
std::vector<FrameFiles> frame_files(const RefocusOptions& options);

/// Whether many pictures are asked for.
bool is_sequence(const RefocusOptions& options, const std::vector<FrameFiles>& files);

/// Refocuses one picture.
using RefocusFrame = std::function<void(const RefocusOptions& options, FrameRun& run)>;

/// Refocuses the frames. Throws UsageError before any is begun; returns the exit status.
int refocus_frames(const RefocusOptions& options, const CLI::App& parser,
                   const std::vector<FrameFiles>& files, const RefocusFrame& refocus);

}  // namespace softfocus
