#include "tools/render/sharp_depths_option.h"

#include <algorithm>

#include "dof/parameters.h"
#include "tools/cli/errors.h"
#include "tools/options/lens_options.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

constexpr const char* kSharpDepthsOption = "--sharp-depths";
constexpr const char* kSharpDepthsWanted =
    "ranges of metres above 0 (at most 1e9) as NEAR:FAR[,NEAR:FAR...], NEAR before FAR, such as "
    "1:1.5,4:6";

[[noreturn]] void refuse(const std::string& text) {
  throw UsageError(std::string{kSharpDepthsOption} + " '" + text + "': give " + kSharpDepthsWanted);
}

SharpDepthRange parse_range(const std::string& range, const std::string& text) {
  const auto colon = range.find(':');
  if (colon == range.npos) refuse(text);
  const auto metres = [&](const std::string& number) {
    try {
      return parse_parameter(kSharpDepthsOption, number, parameter::kFocus);
    } catch (const UsageError&) {  // which knows a part of the value alone
      refuse(text);
    }
  };
  const SharpDepthRange depths{metres(range.substr(0, colon)), metres(range.substr(colon + 1))};
  if (!(depths.near_m < depths.far_m)) refuse(text);
  return depths;
}

}  // namespace

void add_sharp_depths_option(CLI::App& parser, std::vector<SharpDepthRange>& ranges) {
  add_value(parser, kSharpDepthsOption, "NEAR:FAR[,...]",
            "Of generalised-diffusion: ranges in metres that are sharp, all of them at once "
            "(default: the lens's focus alone)",
            [&ranges](const std::string& text) {
              for (std::size_t from = 0; from <= text.size();) {
                const std::size_t comma = std::min(text.find(',', from), text.size());
                ranges.push_back(parse_range(text.substr(from, comma - from), text));
                from = comma + 1;
              }
            });
}

void check_sharp_depths(const CLI::App& parser, const MethodChoice& method, bool shows_image) {
  if (!is_given(parser, kSharpDepthsOption)) return;
  if (method.filter == nullptr || !method.filter->takes_radii) {
    std::string takers;
    for (const Method& taker : methods()) {
      if (!taker.takes_radii) continue;
      takers += (takers.empty() ? "" : ", ") + std::string{taker.name};
    }
    throw UsageError(std::string{kSharpDepthsOption} + ": the method " +
                     std::string{method.name()} + " blurs as the lens does; give --method " +
                     takers);
  }
  check_one_of(parser, {kSharpDepthsOption, "--focus", "--autofocus"});
  if (!shows_image) {
    throw UsageError(std::string{kSharpDepthsOption} +
                     ": --show has maps of the lens alone; leave one out");
  }
}

std::vector<SharpDepths> sharp_depths(const std::vector<SharpDepthRange>& ranges,
                                      const ThinLens& lens, double fov_y_degrees, int height_px,
                                      double coc_scale) {
  const auto focused_at = [&](double depth_m) {
    ThinLens focused = lens;
    focused.focus_m = depth_m;
    if (const char* error = lens_error(focused)) {
      throw UsageError(std::string{kSharpDepthsOption} + ", " + short_number(depth_m) +
                       " m (the focal length is " + short_number(lens.focal_length_mm) +
                       " mm): " + error);
    }
    return checked_pixel_coc(focused, fov_y_degrees, height_px, coc_scale);
  };
  std::vector<SharpDepths> depths;
  depths.reserve(ranges.size());
  for (const SharpDepthRange& range : ranges) {
    depths.push_back({focused_at(range.near_m), focused_at(range.far_m)});
  }
  return depths;
}

std::string ranges_text(const std::vector<SharpDepthRange>& ranges) {
  std::string text;
  for (const SharpDepthRange& range : ranges) {
    text +=
        (text.empty() ? "" : ",") + short_number(range.near_m) + ":" + short_number(range.far_m);
  }
  return text;
}

Json ranges_json(const std::vector<SharpDepthRange>& ranges) {
  Json json = Json::array();
  for (const SharpDepthRange& range : ranges) {
    json.push_back(std::vector<double>{range.near_m, range.far_m});
  }
  return json;
}

}  // namespace softfocus
