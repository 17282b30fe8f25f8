#include "tools/refocus/refocused.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "dof/lens.h"
#include "dof/show.h"
#include "dof/unmix_edges.h"
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

Image filtered(Image& picture, const KeptPart& kept, const RefocusOptions& options,
               UsedRefocus& used, ThreadPool& pool) {
  if (options.arithmetic != Arithmetic::floats) {
    check_arithmetic(options.arithmetic, used.settings);
    Image result = make_image(picture.format, picture.width, picture.height);
    two_pass_in(options.arithmetic, {picture, used.settings, options.profile}, result, pool);
    return result;
  }
  UnmixedEdges edges;
  if (options.unmix) edges = unmix_edges(picture, used.settings, options.profile, pool);
  DofInput input{picture, used.settings, options.profile};
  input.kept = kept;
  if (edges.pixels > 0) input.edges = {edges.coverage, edges.other};
  used.unmixed_pixels = std::max(used.unmixed_pixels, edges.pixels);
  return apply(*used.method, input, pool);
}

/// Colour and opacity, each filtered.
PictureOnItsWay both_filtered(PictureOnItsWay source, const KeptPart& kept,
                              const RefocusOptions& options, UsedRefocus& used, ThreadPool& pool) {
  PictureOnItsWay result{filtered(source.picture, kept, options, used, pool)};
  if (!is_transparent(source.opacity)) {
    result.opacity = std::move(source.opacity);
    return result;
  }
  source.picture = opacity_picture(source.opacity, source.picture);
  result.opacity = opacity_of(filtered(source.picture, kept, options, used, pool));
  return result;
}

// Pixels that are not square are repeated along their longer side until there are as many as square
// ones would be, filtered, and the repeated ones averaged again: what is sharp keeps its bits, and
// any method's circles become ellipses of the pixels' ratio.

/// The pixel of `few` that is repeated at each of `many`.
std::vector<int> repeated(int few, int many) {
  std::vector<int> from;
  from.reserve(static_cast<std::size_t>(many));
  for (int i = 0; i < many; ++i) {
    from.push_back(static_cast<int>((2 * std::int64_t{i} + 1) * few / (2 * std::int64_t{many})));
  }
  return from;
}

struct SquarePixels {
  int few_columns, few_rows;       ///< as they are in the file
  std::vector<int> columns, rows;  ///< repeated()
};

SquarePixels square_pixels(int width, int height, double aspect) {
  const auto longer = [](int side, double by) {
    const double length = std::floor(side * by + 0.5);
    if (length > kMaxImageSize) {
      throw UsageError("with a pixel aspect of its own the picture would have a side of " +
                       short_number(length) + " square pixels; give one of at most " +
                       std::to_string(kMaxImageSize));
    }
    return static_cast<int>(length);
  };
  return {width, height, repeated(width, longer(width, std::max(aspect, 1.0))),
          repeated(height, longer(height, std::max(1.0 / aspect, 1.0)))};
}

int size_of(const std::vector<int>& places) { return static_cast<int>(places.size()); }

PictureOnItsWay with_repeated(const PictureOnItsWay& source, const SquarePixels& square) {
  PictureOnItsWay result{
      make_image(Format::rgba16f, size_of(square.columns), size_of(square.rows))};
  for (int y = 0; y < result.picture.height; ++y) {
    const int from_y = square.rows[static_cast<std::size_t>(y)];
    const auto from = row<std::uint16_t>(source.picture, from_y);
    auto to = row<std::uint16_t>(result.picture, y).begin();
    for (const int x : square.columns) to = std::copy_n(from.begin() + 4 * x, 4, to);
    if (source.opacity.empty()) continue;
    const auto first = source.opacity.begin() + std::ptrdiff_t{from_y} * square.few_columns;
    for (const int x : square.columns) result.opacity.push_back(first[x]);
  }
  return result;
}

/// Their mean; of equal ones their own bits, for at most 16 halves have an exact sum.
PictureOnItsWay without_repeated(const PictureOnItsWay& source, const SquarePixels& square) {
  const auto pixels =
      static_cast<std::size_t>(square.few_columns) * static_cast<std::size_t>(square.few_rows);
  std::vector<float> sums(4 * pixels, 0.0f), counts(pixels, 0.0f);
  for (int y = 0; y < source.picture.height; ++y) {
    const auto from = row<std::uint16_t>(source.picture, y);
    const std::size_t first = static_cast<std::size_t>(square.rows[static_cast<std::size_t>(y)]) *
                              static_cast<std::size_t>(square.few_columns);
    for (std::size_t x = 0; x < square.columns.size(); ++x) {
      const std::size_t at = first + static_cast<std::size_t>(square.columns[x]);
      for (std::size_t c = 0; c < 3; ++c) sums[4 * at + c] += half_to_float(from[4 * x + c]);
      if (!source.opacity.empty()) {
        sums[4 * at + 3] += source.opacity[static_cast<std::size_t>(y) * square.columns.size() + x];
      }
      counts[at] += 1.0f;
    }
  }
  PictureOnItsWay result{make_image(Format::rgba16f, square.few_columns, square.few_rows)};
  for (std::size_t at = 0; at < pixels; ++at) {
    const auto columns = static_cast<std::size_t>(square.few_columns);
    std::uint16_t* const to =
        row<std::uint16_t>(result.picture, static_cast<int>(at / columns)).data() +
        4 * (at % columns);
    for (std::size_t c = 0; c < 3; ++c) {
      to[c] = float_to_half(sums[4 * at + c] / counts[at], HalfRounding::nearest_even);
    }
    if (!source.opacity.empty()) result.opacity.push_back(sums[4 * at + 3] / counts[at]);
  }
  return result;
}

/// Filters with pixels beyond the borders, as far as the largest circle reaches.
PictureOnItsWay filtered_in_border(PictureOnItsWay source, const RefocusOptions& options,
                                   UsedRefocus& used, ThreadPool& pool) {
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

/// Of pixels of that width over their height.
PictureOnItsWay filtered_square(PictureOnItsWay source, double aspect,
                                const RefocusOptions& options, UsedRefocus& used,
                                ThreadPool& pool) {
  if (aspect == 1.0) return filtered_in_border(std::move(source), options, used, pool);
  if (options.unmix) {
    throw UsageError(
        "--unmix-edges: the picture's pixels are not square, and would be repeated; "
        "leave it out");
  }
  const SquarePixels square = square_pixels(source.picture.width, source.picture.height, aspect);
  UsedRefocus of_square = used;
  if (aspect < 1.0) {  // circles are in heights, of which a square pixel is a part
    const auto more = static_cast<float>(1.0 / aspect);
    of_square.settings.coc.radius_at_infinity_px *= more;
    of_square.largest_circle_px *= more;
    of_square.settings.max_coc_px = std::min(of_square.settings.max_coc_px * more, kLargestMaxCoc);
  }
  source = with_repeated(source, square);
  return without_repeated(filtered_in_border(std::move(source), options, of_square, pool), square);
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
    return {show_coc(colour, used.settings.coc, std::max(used.settings.max_coc_px, 1e-3f), pool)};
  }
  if (options.show == RefocusShow::depth) {
    const DepthBounds bounds = bounds_of(depth);
    return {show_depth(colour, bounds.near_m, bounds.far_m, pool)};
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
  const int light_power = source.light_power;
  HighlightCurve curve = options.highlights.value_or(HighlightCurve{});
  curve.threshold = std::ldexp(curve.threshold, -light_power);
  if (options.highlights) raise_highlights(curve, source.opacity, colour);
  PictureOnItsWay result =
      filtered_square(std::move(source), used.lens.pixel_aspect, options, used, pool);
  if (options.highlights) lower_highlights(curve, result.opacity, result.picture);
  result.light_power = light_power;
  put_depth_in_alpha(options, depth.metres, result.picture);
  return result;
}

void add_planes(const PictureOnItsWay& picture, const ColourLayer& colour,
                std::vector<ReplacedPlane>& planes) {
  const std::size_t first = planes.size();
  for (const std::size_t plane : {colour.red, colour.green, colour.blue}) planes.push_back({plane});
  const float light = std::ldexp(1.0f, picture.light_power);
  for (int y = 0; y < picture.picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture.picture, y);
    for (std::size_t i = 0; i < halves.size(); i += 4) {
      for (std::size_t c = 0; c < 3; ++c) {
        planes[first + c].values.push_back(half_to_float(halves[i + c]) * light);
      }
    }
  }
  if (colour.alpha && !picture.opacity.empty()) planes.push_back({*colour.alpha, picture.opacity});
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

bool keeps_data_window(const RefocusOptions& options, const PictureSources& sources) {
  return is_of_exr(options.format) && options.show == RefocusShow::image &&
         sources.colour_file.reader == &kExrReader;
}

void cut_to_shown(const PictureFile& file, PictureOnItsWay& picture, PlaneValues* depth) {
  const PictureBox from = box_of(file), &to = file.shown;
  if (from == to) return;
  Image cut = make_image(Format::rgba16f, to.width, to.height);
  for (int y = std::max(0, from.y); y < std::min(to.height, from.y + from.height); ++y) {
    const int left = std::max(0, from.x), right = std::min(to.width, from.x + from.width);
    if (left >= right) continue;
    const auto row_from = row<std::uint16_t>(picture.picture, y - from.y);
    std::copy_n(row_from.begin() + std::ptrdiff_t{4} * (left - from.x),
                std::ptrdiff_t{4} * (right - left),
                row<std::uint16_t>(cut, y).begin() + std::ptrdiff_t{4} * left);
  }
  picture.picture = std::move(cut);
  if (!picture.opacity.empty()) picture.opacity = moved(picture.opacity, from, to, 0.0f);
  if (depth != nullptr) *depth = moved(*depth, from, to, std::numeric_limits<float>::infinity());
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

std::span<const std::byte> kept_profile(const PictureFile& file) {
  if (file.to_srgb) return {};
  return file.icc;
}

bool keeps_profile(FileFormat format) {
  return format == FileFormat::png || format == FileFormat::png_16 || format == FileFormat::tiff;
}

bool keeps_alpha(FileFormat format) { return is_of_exr(format) || keeps_profile(format); }

Bytes refocused_file(const RefocusOptions& options, const PictureSources& sources,
                     const DepthMap& depth, const UsedRefocus& used, const PictureOnItsWay& result,
                     const PictureNotes& notes, std::span<const ReplacedPlane> views) {
  PictureExtras extras{.alpha = result.opacity,
                       .replaced = views,
                       .light_power = result.light_power,
                       .icc = kept_profile(sources.colour_file)};
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
      if (options.keep_layers) extras.view = sources.view;
    }
  }
  return encode_with_notes(result.picture, options.format, notes, extras);
}

}  // namespace softfocus
