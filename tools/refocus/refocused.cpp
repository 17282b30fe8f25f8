#include "tools/refocus/refocused.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dof/lens.h"
#include "dof/show.h"
#include "tools/cli/errors.h"
#include "tools/pictures/exr_file.h"
#include "tools/refocus/depth/mend_depth.h"
#include "tools/refocus/picture_with_depth.h"

namespace softfocus {
namespace {

/// The largest depth that a 16-bit float holds.
constexpr float kFarthestHalf = 65504.0f;

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

Image filtered(const Image& picture, const KeptPart& kept, const RefocusOptions& options,
               const UsedRefocus& used, ThreadPool& pool) {
  if (options.arithmetic != Arithmetic::floats) {
    check_arithmetic(options.arithmetic, used.settings);
    Image result = make_image(picture.format, picture.width, picture.height);
    two_pass_in(options.arithmetic, {picture, used.settings, options.profile}, result, pool);
    return result;
  }
  DofInput input{picture, used.settings, options.profile};
  input.kept = kept;
  return apply(*used.method, input, pool);
}

/// Colour and opacity, each filtered.
PictureOnItsWay both_filtered(PictureOnItsWay source, const KeptPart& kept,
                              const RefocusOptions& options, const UsedRefocus& used,
                              ThreadPool& pool) {
  PictureOnItsWay result{filtered(source.picture, kept, options, used, pool)};
  if (!is_transparent(source.opacity)) {
    result.opacity = std::move(source.opacity);
    return result;
  }
  source.picture = opacity_picture(source.opacity, source.picture);
  result.opacity = opacity_of(filtered(source.picture, kept, options, used, pool));
  return result;
}

/// Filters with pixels beyond the borders, as far as the largest circle reaches.
PictureOnItsWay filtered_in_border(PictureOnItsWay source, const RefocusOptions& options,
                                   const UsedRefocus& used, ThreadPool& pool) {
  const float reach_px = std::min(used.largest_circle_px, used.settings.max_coc_px);
  const int margin = static_cast<int>(std::ceil(reach_px));
  const int width = source.picture.width, height = source.picture.height;
  if (options.border == Border::by_method || margin == 0) {
    return both_filtered(std::move(source), {}, options, used, pool);
  }
  if (std::max(width, height) + 2 * margin > kMaxImageSize) {
    throw UsageError("--border: with a border of " + std::to_string(margin) +
                     " pixels the picture is larger than " + std::to_string(kMaxImageSize) +
                     "; give a smaller --max-coc, or no --border");
  }
  PictureOnItsWay wide{with_border(source.picture, margin, options.border)};
  if (!source.opacity.empty()) {
    wide.opacity = with_border(source.opacity, width, height, margin, options.border);
  }
  const bool has_opacity = !source.opacity.empty();
  source = {};
  PictureOnItsWay result =
      both_filtered(std::move(wide), {margin, margin, width, height}, options, used, pool);
  result.picture = without_border(result.picture, margin);
  if (has_opacity) {
    result.opacity =
        without_border(result.opacity, width + 2 * margin, height + 2 * margin, margin);
  }
  return result;
}

}  // namespace

void begin_settings(const RefocusOptions& options, UsedRefocus& used) {
  used.method = options.method.filter;
  used.settings.coc = used.lens.coc;
  used.settings.leak = options.leak;
  used.settings.budget = options.budget;
  used.settings.aperture = options.aperture;
}

void move_to_seen(DepthMap& map, const std::optional<SharpDepthRange>& range) {
  if (range) move_range_into_focus(map, *range);
  // (z - focus) / z is NaN at infinity, and NaN has the largest circle. The horizon has its own.
  for (float& metres : map.metres) metres = std::min(metres, kFarthestHalf);
}

void settle_largest_circle(const ConstImageView& picture, const RefocusOptions& options,
                           UsedRefocus& used, ThreadPool& pool) {
  const CircleSizes sizes = circle_sizes(picture, used.settings.coc, 0.0f, pool);
  used.largest_circle_px = sizes.largest_px;
  used.settings.max_coc_px = options.max_coc_px.value_or(std::ceil(sizes.largest_px));
}

void put_depth_in_alpha(const RefocusOptions& options, const PlaneValues& metres, Image& picture) {
  put_in_alpha(options.circles ? PlaneValues(metres.size(), 0.0f) : metres, picture);
}

PictureOnItsWay refocused(PictureOnItsWay source, const DepthMap& depth,
                          const RefocusOptions& options, UsedRefocus& used, ThreadPool& pool) {
  Image& colour = source.picture;
  begin_settings(options, used);
  DepthMap seen = depth;
  move_to_seen(seen, used.lens.range);
  put_in_alpha(seen.metres, colour);
  settle_largest_circle(colour, options, used, pool);
  if (options.show == RefocusShow::coc) {
    return {show_coc(colour, used.settings.coc, std::max(used.settings.max_coc_px, 1e-3f))};
  }
  if (options.show == RefocusShow::depth) {
    const DepthBounds bounds = bounds_of(depth);
    return {show_depth(colour, bounds.near_m, bounds.far_m)};
  }
  if (options.method.is_auto()) {
    used.choice = auto_filter(colour, used.settings.coc, options.goal, options.max_coc_px, pool);
    used.method = find_method(used.choice->method);
    if (!is_sharp(*used.choice)) used.settings.max_coc_px = used.choice->radius_px;
  }
  if (const std::optional<PixelCoc> finer = with_finer_depths(seen, used.settings.coc)) {
    used.settings.coc = *finer;
    put_in_alpha(seen.metres, colour);
  }
  seen = {};
  if (options.highlights) raise_highlights(*options.highlights, source.opacity, colour);
  PictureOnItsWay result = filtered_in_border(std::move(source), options, used, pool);
  if (options.highlights) {
    lower_highlights(*options.highlights, result.opacity, result.picture);
  }
  put_depth_in_alpha(options, depth.metres, result.picture);
  return result;
}

PlaneValues circle_radii(const DepthMap& depth, const UsedRefocus& used) {
  DepthMap map = depth;
  if (used.lens.range) move_range_into_focus(map, *used.lens.range);
  const float most = used.settings.max_coc_px;
  for (float& value : map.metres) {
    value = std::isinf(value) ? used.lens.coc.radius_at_infinity_px
                              : coc_radius_px(used.lens.coc, value);
    value = std::clamp(value, -most, most);
  }
  return std::move(map.metres);
}

bool is_of_exr(FileFormat format) {
  return format == FileFormat::exr || format == FileFormat::exr_float;
}

std::vector<std::size_t> kept_planes(const RefocusOptions& options, const PictureSources& sources) {
  const bool is_exr = sources.colour_file.reader == &kExrReader;
  return options.keep_layers && is_exr ? other_planes(sources) : std::vector<std::size_t>{};
}

std::vector<std::size_t> other_planes(const PictureSources& sources) {
  std::vector<std::size_t> others;
  const ColourLayer& colour = sources.colour;
  for (std::size_t i = 0; i < sources.colour_file.planes.size(); ++i) {
    const bool is_colour =
        i == colour.red || i == colour.green || i == colour.blue || i == colour.alpha;
    const bool is_depth = !sources.depth_file && i == sources.depth_plane;
    if (!is_colour && !is_depth) others.push_back(i);
  }
  return others;
}

bool keeps_alpha(FileFormat format) {
  return is_of_exr(format) || format == FileFormat::png || format == FileFormat::png_16;
}

Bytes refocused_file(const RefocusOptions& options, const PictureSources& sources,
                     const DepthMap& depth, const UsedRefocus& used, const PictureOnItsWay& result,
                     const PictureNotes& notes) {
  PictureExtras extras{.alpha = result.opacity};
  PlaneValues radii_px;
  std::vector<std::size_t> kept;
  if (is_of_exr(options.format) && options.show == RefocusShow::image) {
    radii_px = circle_radii(depth, used);
    extras.radii_px = radii_px;
    extras.depth_m = depth.metres;
    extras.has_depth = !options.circles;
    if (sources.colour_file.reader == &kExrReader) {
      kept = kept_planes(options, sources);
      extras.source = &sources.colour_file;
      extras.kept = kept;
    }
  }
  return encode_with_notes(result.picture, options.format, notes, extras);
}

}  // namespace softfocus
