#pragma once
// Refocusing a picture that need not fit into memory: read, filtered by two-pass's stream and
// written a band of rows at a time. The files have the bytes of the whole form.
//
//   1  if its encoding is to be believed, or goes by the least and largest code: the codes
//   2  the depths, from which the lens is settled and the largest circle follows
//   3  colour and depth, through the filter and into the file

#include <cstdint>

#include "raster/threads/parallel.h"
#include "tools/cli/progress.h"
#include "tools/refocus/report.h"

namespace softfocus {

/// The whole form with any other method than two-pass: the file, its colour as planes and as a
/// picture; then the picture, its depth, the result, and what the method keeps.
inline constexpr std::uint64_t kWholeBytesPerPixel = 64;

/// Why these options need the whole picture; empty if they do not.
std::string reason_for_whole(const RefocusOptions& options);

/// Makes the files, or returns nothing, with the reason in `why`, if what is in the files needs the
/// whole picture. Throws FileError, UsageError.
std::optional<Refocused> refocus_by_rows(const RefocusOptions& options, Progress& progress,
                                         ThreadPool& pool, std::string& why);

}  // namespace softfocus
