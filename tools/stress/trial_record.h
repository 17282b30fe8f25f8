#pragma once
// `stress`'s record of a trial: its pictures, small enough for a page with hundreds, and the key of
// all that it measured.

#include <string>

#include "raster/images/image.h"
#include "raster/threads/parallel.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// By which pictures are brightened: brings a dark truth's brightest light to 0.8, and leaves
/// others as they are.
double display_gain(const Image& truth);

/// Brightened and reduced.
std::string stress_picture(const Image& picture, double gain);

/// The map of FLIP between two brightened pictures, as colours.
std::string stress_error_picture(const Image& truth, const Image& result, double gain,
                                 ThreadPool& pool);

/// A line that differs whenever a value could, but for the methods' own pictures: version, case,
/// severity, views; of each frame its size, settings and hash, that of its calculated truth and of
/// its first views; and a hash of what the measures give for a wrong answer.
std::string trial_key(const StressCase& of, double severity, const StressTrial& trial, int views,
                      ThreadPool& pool);

}  // namespace softfocus
