#include "tools/plugins/plugin_refocus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <new>
#include <optional>
#include <string>

#include "dof/auto/auto_method.h"
#include "dof/dof.h"
#include "dof/parameters.h"
#include "raster/images/image.h"
#include "raster/numbers/exact_math.h"
#include "raster/threads/float_environment.h"
#include "tools/cli/errors.h"
#include "tools/pictures/image_file.h"
#include "tools/refocus/depth/mend_depth.h"

namespace softfocus {
namespace {

constexpr float kMostLight = 65504.0f;  // the largest half

constexpr Parameter renamed(Parameter parameter, std::string_view name, std::string_view summary) {
  parameter.name = name;
  parameter.summary = summary;
  return parameter;
}

constexpr Parameter preset(Parameter parameter, double value) {
  parameter.preset = value;
  return parameter;
}

/// 0 stands for what `summary` says.
constexpr Parameter or_none(Parameter parameter, std::string_view summary) {
  parameter.summary = summary;
  parameter.least = parameter.preset = 0.0;
  return parameter;
}

constexpr const Parameter& of_depth(std::string_view name) {
  std::size_t i = 0;
  while (kDepthNumbers[i].number.name != name) ++i;
  return kDepthNumbers[i].number;
}

// clang-format off
constexpr std::array kNumbers{
    PluginNumber{preset(of_depth("near"), 1.0), 100.0},
    PluginNumber{preset(of_depth("far"), 20.0), 1000.0},
    PluginNumber{or_none(parameter::kFocus,
        "Distance in focus, along the axis; 0: what is at focus-x, focus-y"), 100.0},
    PluginNumber{{"focus-x", "In focus is what is here: a share of the width", 0.0, 1.0, 0.5}, 1.0},
    PluginNumber{{"focus-y", "Likewise a share of the height, from the top", 0.0, 1.0, 0.5}, 1.0},
    PluginNumber{parameter::kFNumber, 32.0},
    PluginNumber{parameter::kFocalLength, 300.0},
    PluginNumber{renamed(parameter::kSensorSide, "sensor-width",
        "The sensor; the picture takes the largest part that has its shape"), 60.0},
    PluginNumber{preset(renamed(parameter::kSensorSide, "sensor-height", "Likewise"), 24.0), 60.0},
    PluginNumber{or_none(parameter::kFov, "Vertical field of view; 0: the sensor's"), 120.0},
    PluginNumber{parameter::kCocScale, 10.0},
    PluginNumber{or_none(parameter::kBlurAtInfinity,
        "In place of a lens: the radius of the circle of what is infinitely far; 0: the lens's"),
        100.0},
    PluginNumber{or_none(parameter::kMaxCoc,
        "The largest radius, to which larger circles are cut; 0: the picture's largest"), 100.0},
    PluginNumber{{"aperture-blades", "Of scatter-aperture: straight blades, 3 to 64; 0: round",
        0.0, kMostApertureBlades, 0.0, "", "N", "", 1}, 12.0},
    PluginNumber{parameter::kApertureTurn, 360.0},
    PluginNumber{parameter::kAnamorphic, 4.0},
    PluginNumber{parameter::kLeak, 10.0},
    PluginNumber{parameter::kBudget, 1.0},
    PluginNumber{parameter::kMaxError, 0.2},
    PluginNumber{of_depth("scale"), 10.0},
    PluginNumber{of_depth("offset"), 10.0},
    PluginNumber{or_none(of_depth("baseline"), of_depth("baseline").summary), 10.0},
    PluginNumber{or_none(of_depth("focal-px"), of_depth("focal-px").summary), 10000.0}};
// clang-format on

constexpr std::array kHoles{
    Choice<Holes>{"background", Holes::background}, Choice<Holes>{"near", Holes::near_side},
    Choice<Holes>{"far", Holes::far_side}, Choice<Holes>{"infinity", Holes::infinity}};

template <class Named>
PluginChoice choice_of(std::string_view name, std::string_view summary, const Named& all,
                       std::string_view preset) {
  PluginChoice choice{name, summary, {}};
  for (const auto& one : all) {
    if (one.name == preset) choice.preset = choice.words.size();
    choice.words.push_back(one.name);
  }
  return choice;
}

/// The picture's height over the height that it shows at distance 1. `image_mm` lies between the
/// lens and the sensor.
double pixels_per_tangent(const PluginSettings& settings, const PluginFrame& frame,
                          double image_mm) {
  if (const double degrees = settings.number("fov"); degrees > 0.0) {
    return frame.height / (2.0 * exact_math::tan_degrees(degrees / 2.0));
  }
  if (const double focal_px = settings.number("focal-px"); focal_px > 0.0) return focal_px;
  return image_mm * pixels_per_sensor_mm(settings.number("sensor-width"),
                                         settings.number("sensor-height"), frame.width,
                                         frame.height);
}

/// The depth in metres, known everywhere.
DepthMap depth_of(const PluginSettings& settings, PluginFrame& frame, ThreadPool& pool) {
  DepthReading reading{.encoding = &depth_encodings()[settings.encoding]};
  for (const OfDepth& of : kDepthNumbers) {
    reading.numbers.*of.place = settings.number(of.number.name);
  }
  if (!(*reading.numbers.near_m < *reading.numbers.far_m)) {
    throw UsageError("near must be less than far");
  }
  reading.along = reading.encoding->along;
  reading.pixels_per_tangent = pixels_per_tangent(settings, frame, settings.number("focal-length"));
  DepthMap map = depth_of_codes(std::move(frame.codes), frame.type, frame.width, frame.height,
                                reading, frame.is_known);
  if (missing_depths(map) == map.metres.size()) {
    throw UsageError("the depth has no number that is a distance, read as " +
                     std::string{reading.encoding->name});
  }
  fill_holes(map, kHoles[settings.holes].value);
  if (settings.mend_edges) mend_edges(map, pool);
  return map;
}

/// The median of the 5x5 depths there, as --focus-at has it.
double focus_of(const PluginSettings& settings, const DepthMap& map) {
  if (const double focus_m = settings.number("focus"); focus_m > 0.0) return focus_m;
  constexpr int kReach = 2;
  const auto pixel = [](double share, int side) {
    return std::min(static_cast<int>(share * side), side - 1);
  };
  const int column = pixel(settings.number("focus-x"), map.width);
  const int line = pixel(settings.number("focus-y"), map.height);
  std::vector<float> around;
  for (int y = std::max(line - kReach, 0); y <= std::min(line + kReach, map.height - 1); ++y) {
    for (int x = std::max(column - kReach, 0); x <= std::min(column + kReach, map.width - 1); ++x) {
      const float metres =
          map.metres[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                     static_cast<std::size_t>(x)];
      if (std::isfinite(metres)) around.push_back(metres);
    }
  }
  if (around.empty()) throw UsageError("nothing at focus-x, focus-y has a finite depth");
  const auto median = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::nth_element(around.begin(), median, around.end());
  return static_cast<double>(*median);
}

PixelCoc coc_of(const PluginSettings& settings, const PluginFrame& frame, double focus_m) {
  if (const double radius_px = settings.number("blur-at-infinity"); radius_px > 0.0) {
    return {static_cast<float>(radius_px), static_cast<float>(focus_m)};
  }
  const ThinLens lens{settings.number("focal-length"), settings.number("f-number"), focus_m};
  if (const char* error = lens_error(lens)) throw UsageError(error);
  const double image_mm = image_distance_mm(lens, lens.focus_m);
  const PixelCoc coc =
      sensor_coc(lens, pixels_per_tangent(settings, frame, image_mm), settings.number("coc-scale"));
  if (!std::isfinite(coc.radius_at_infinity_px)) {
    throw UsageError("the lens's circles are too large; a larger f-number has smaller ones");
  }
  return coc;
}

DofSettings dof_settings(const PluginSettings& settings, const PixelCoc& coc) {
  DofSettings dof{.coc = coc};
  dof.leak = static_cast<float>(settings.number("leak"));
  dof.budget = static_cast<float>(settings.number("budget"));
  dof.aperture = {static_cast<int>(settings.number("aperture-blades")),
                  static_cast<float>(settings.number("aperture-turn")),
                  static_cast<float>(settings.number("anamorphic"))};
  if (const char* error = aperture_error(dof.aperture)) throw UsageError(error);
  return dof;
}

/// Divides colours by 2^power, so that halves hold them; returns the power.
int dim(std::span<float> rgba) {
  float brightest = 0.0f;
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (i % 4 != 3 && std::isfinite(rgba[i])) brightest = std::max(brightest, rgba[i]);
  }
  int power = 0;
  while (power < kMostLightPower && brightest > std::ldexp(kMostLight, power)) ++power;
  for (std::size_t i = 0; power > 0 && i < rgba.size(); ++i) {
    if (i % 4 != 3) rgba[i] = std::ldexp(rgba[i], -power);
  }
  return power;
}

void refocus(const PluginSettings& settings, PluginFrame& frame) {
  if (std::max(frame.width, frame.height) > kMaxImageSize) {
    throw UsageError("a picture has at most " + std::to_string(kMaxImageSize) + " pixels a side");
  }
  for (const double number : settings.numbers) {
    if (!std::isfinite(number)) throw UsageError("a setting is not a number");
  }
  const DefaultFloatEnvironment environment;
  ThreadPool pool{hardware_threads()};
  DepthMap map = depth_of(settings, frame, pool);
  DofSettings dof = dof_settings(settings, coc_of(settings, frame, focus_of(settings, map)));
  for (float& metres : map.metres) metres = std::min(metres, kMostLight);

  const std::ptrdiff_t row_floats = std::ptrdiff_t{4} * frame.width;
  const std::ptrdiff_t row_bytes = row_floats * std::ptrdiff_t{sizeof(float)};
  float* const alpha = frame.rgba.data() + 3;
  const ColourTarget colours = interleaved(ChannelType::single, frame.rgba.data(), 4, row_bytes);
  ColourTarget opacity = colours;
  opacity.red = opacity.green = opacity.blue = alpha;
  Image picture = make_image(Format::rgba16f, frame.width, frame.height);
  const auto take = [&](const ColourSource& from) {
    const DepthSource depth{map.metres.data(), sizeof(float),
                            std::ptrdiff_t{sizeof(float)} * frame.width};
    pack(from, depth, HalfRounding::nearest_even, picture, pool);
  };
  const int power = dim(frame.rgba);
  take(colours);

  std::optional<float> most_px;
  if (const double px = settings.number("max-coc"); px > 0.0) most_px = static_cast<float>(px);
  dof.max_coc_px =
      most_px.value_or(std::ceil(circle_sizes(picture, dof.coc, 0.0f, pool).largest_px));
  const Method* method = find_method(plugin_methods().words[settings.method]);
  if (method == nullptr) {
    const AutoMethod chosen =
        auto_filter(picture, dof.coc, {.max_error = settings.number("max-error")}, most_px, pool);
    method = find_method(chosen.method);
    if (!is_sharp(chosen)) dof.max_coc_px = chosen.radius_px;
  }
  if (const std::optional<PixelCoc> finer = with_finer_depths(map, dof.coc)) {
    dof.coc = *finer;
    take(colours);
  }
  DofInput input{picture, dof, {}};
  input.kept = frame.kept;
  const Image result = apply(*method, input, pool);
  bool is_transparent = false;
  for (std::size_t i = 3; i < frame.rgba.size(); i += 4) is_transparent |= frame.rgba[i] < 1.0f;
  if (is_transparent) {
    take(opacity);
    unpack(apply(*method, input, pool), opacity, pool);
    for (std::size_t i = 3; i < frame.rgba.size(); i += 4) {
      frame.rgba[i] = std::clamp(frame.rgba[i], 0.0f, 1.0f);
    }
  }
  unpack(result, colours, pool);
  for (std::size_t i = 0; power > 0 && i < frame.rgba.size(); ++i) {
    if (i % 4 != 3) frame.rgba[i] = std::ldexp(frame.rgba[i], power);
  }
}

}  // namespace

std::span<const PluginNumber> plugin_numbers() { return kNumbers; }

const PluginChoice& plugin_methods() {
  static const PluginChoice choice = [] {
    PluginChoice all = choice_of("method", "How the picture is blurred: docs/methods.md", methods(),
                                 "disc-layers");
    all.words.emplace_back("auto");
    return all;
  }();
  return choice;
}

const PluginChoice& plugin_encodings() {
  static const PluginChoice choice =
      choice_of("depth-encoding", "Meaning of the depth's numbers: docs/refocus.md",
                depth_encodings(), "midas");
  return choice;
}

const PluginChoice& plugin_holes() {
  static const PluginChoice choice =
      choice_of("holes", "What is not known of the depth", kHoles, "background");
  return choice;
}

std::string_view plugin_mend_edges() {
  return "Depth between two surfaces becomes that of one of them";
}

PluginSettings::PluginSettings()
    : method(plugin_methods().preset),
      encoding(plugin_encodings().preset),
      holes(plugin_holes().preset) {
  for (const PluginNumber& number : kNumbers) numbers.push_back(number.parameter.preset);
}

double PluginSettings::number(std::string_view name) const {
  std::size_t i = 0;
  while (kNumbers[i].parameter.name != name) ++i;
  return numbers[i];
}

std::string refocus_in_plugin(const PluginSettings& settings, PluginFrame frame) {
  try {
    refocus(settings, frame);
    return {};
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace softfocus
