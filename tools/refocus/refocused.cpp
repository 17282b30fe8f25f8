#include "tools/refocus/refocused.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dof/circle_sizes.h"
#include "dof/show.h"
#include "tools/cli/errors.h"

namespace softfocus {
namespace {

/// The largest depth that a 16-bit float holds.
constexpr float kFarthestHalf_m = 65504.0f;

/// The nearest and farthest finite depths, apart.
struct DepthBounds {
  float near_m, far_m;
};
DepthBounds bounds_of(const DepthMap& depth) {
  DepthBounds bounds{1e30f, 0.0f};
  for (const float metres : depth.metres) {
    if (!std::isfinite(metres)) continue;
    bounds.near_m = std::min(bounds.near_m, metres);
    bounds.far_m = std::max(bounds.far_m, metres);
  }
  if (bounds.far_m == 0.0f) bounds = {1.0f, 2.0f};
  if (!(bounds.near_m < bounds.far_m)) bounds.far_m = 2.0f * bounds.near_m;
  return bounds;
}

Image filtered(const Image& picture, const RefocusOptions& options, const UsedRefocus& used,
               ThreadPool& pool) {
  if (options.arithmetic != Arithmetic::floats) {
    check_arithmetic(options.arithmetic, used.settings);
    Image result = make_image(picture.format, picture.width, picture.height);
    two_pass_in(options.arithmetic, {picture, used.settings, options.profile}, result, pool);
    return result;
  }
  return apply(*used.method,
               {.scene = picture, .settings = used.settings, .profile = options.profile}, pool);
}

}  // namespace

Image refocused(Image colour, const DepthMap& depth, const RefocusOptions& options,
                UsedRefocus& used, ThreadPool& pool) {
  used.method = options.method.filter;
  used.settings.coc = used.lens.coc;
  used.settings.leak = options.leak;
  used.settings.budget = options.budget;
  DepthMap seen = depth;
  if (used.lens.range) move_range_into_focus(seen, *used.lens.range);
  // (z - focus) / z is NaN at infinity, and NaN has the largest circle. The horizon has its own.
  for (float& metres : seen.metres) metres = std::min(metres, kFarthestHalf_m);
  put_in_alpha(seen.metres, colour);
  const CircleSizes sizes = circle_sizes(colour, used.settings.coc, 0.0f, pool);
  used.largest_circle_px = sizes.largest_px;
  used.settings.max_coc_px = options.max_coc_px.value_or(std::ceil(sizes.largest_px));
  if (options.show == RefocusShow::coc) {
    return show_coc(colour, used.settings.coc, std::max(used.settings.max_coc_px, 1e-3f));
  }
  if (options.show == RefocusShow::depth) {
    const DepthBounds bounds = bounds_of(depth);
    return show_depth(colour, bounds.near_m, bounds.far_m);
  }
  if (options.method.is_auto()) {
    used.choice = auto_filter(colour, used.settings.coc, options.goal, options.max_coc_px, pool);
    used.method = find_method(used.choice->method);
    if (!is_sharp(*used.choice)) used.settings.max_coc_px = used.choice->radius_px;
  }
  Image result = filtered(colour, options, used, pool);
  put_in_alpha(depth.metres, result);
  return result;
}

}  // namespace softfocus
