#pragma once
// Relief textures by ray tracing, in place of the pipeline: a ray through each texel's centre, by
// Embree, against the triangles that are drawn, lit and textured by the same functions. A build
// without Embree lacks it.

#include <cstdint>
#include <string_view>

#include "scenes/relief/make_relief.h"

namespace softfocus {

/// Empty if this build can trace rays, else what is missing.
std::string_view traced_relief_missing();

/// As make_relief(), by the same camera, unlit too. The same bits for any number of threads, but
/// not on every machine: Embree's intersections differ in their last bits from one vector unit to
/// the next. Throws std::runtime_error if Embree is missing or fails.
ReliefTexture trace_relief(const ReliefMaker& maker, const ReliefView& view, const ReliefForm& form,
                           ThreadPool& pool);

/// Texels of two reliefs of one camera and form.
struct ReliefDifferences {
  std::int64_t shown = 0;          ///< by either
  std::int64_t by_one = 0;         ///< that one of them shows and the other not
  std::int64_t by_one_inside = 0;  ///< of these, with no empty neighbour in either: no outline
  std::int64_t code = 0;           ///< with depths of one code apart
  std::int64_t codes = 0;          ///< more than one code
  /// Of these, off steps: neighbours are at most kStepCodes apart.
  std::int64_t codes_off_step = 0;
  std::int64_t colour = 0;  ///< with colours more than one code of 255 apart
  std::int64_t colour_off_step = 0;
};
inline constexpr int kStepCodes = 8;  ///< of 255; of 16 bits 256 times as many

ReliefDifferences relief_differences(const ReliefTexture& one, const ReliefTexture& other);

}  // namespace softfocus
