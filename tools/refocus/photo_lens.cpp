#include "tools/refocus/photo_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dof/lens.h"
#include "dof/parameters.h"
#include "raster/numbers/exact_math.h"
#include "tools/cli/errors.h"
#include "tools/options/parameter_options.h"

namespace softfocus {
namespace {

Sensor parse_sensor(const std::string& text) {
  for (const NamedSensor& known : kSensors) {
    if (known.name == text) return {text, known.width_mm, known.height_mm};
  }
  const auto cross = text.find_first_of("xX");
  const std::string wanted = ", or millimetres as WxH, such as 36x24mm";
  const auto refuse = [&] { refuse_name("--sensor", text, names_in(kSensors), wanted); };
  if (cross == text.npos) refuse();
  try {
    return {text, parse_parameter("", text.substr(0, cross), parameter::kSensorSide),
            parse_parameter("", text.substr(cross + 1), parameter::kSensorSide)};
  } catch (const UsageError&) {  // which knows one side alone
    refuse();
    throw;
  }
}

SharpDepthRange parse_focus_range(const std::string& text) {
  constexpr const char* kWanted = "two distances as NEAR..FAR, such as 1.5m..3m";
  const auto dots = text.find("..");
  const auto refuse = [&] { throw UsageError("--focus-range '" + text + "': give " + kWanted); };
  if (dots == text.npos) refuse();
  SharpDepthRange range;
  try {
    range = {parse_parameter("", text.substr(0, dots), parameter::kFocus),
             parse_parameter("", text.substr(dots + 2), parameter::kFocus)};
  } catch (const UsageError&) {  // which knows one end alone
    refuse();
  }
  if (!(range.near_m < range.far_m)) refuse();
  return range;
}

/// Sources of the field of view, in the order in which they are asked.
enum class CameraSource : std::uint8_t { fov, sensor, focal_px, notes, full_frame };

CameraSource camera_source(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                           std::optional<double> focal_px) {
  if (photo.fov_y_degrees) return CameraSource::fov;
  if (photo.sensor) return CameraSource::sensor;
  if (focal_px) return CameraSource::focal_px;
  return notes ? CameraSource::notes : CameraSource::full_frame;
}

Sensor sensor_of(const PhotoLens& photo) {
  return photo.sensor.value_or(Sensor{"full-frame", 36.0, 24.0});
}

double focal_length_mm(const PhotoLens& photo, const std::optional<PictureNotes>& notes) {
  const ThinLens standard;
  const double noted =
      notes && notes->lens ? notes->lens->lens.focal_length_mm : standard.focal_length_mm;
  return photo.lens.given[&ThinLens::focal_length_mm].value_or(
      photo.of_file.focal_length_mm.value_or(noted));
}

/// Who said it, in the order in which they are asked.
std::string source_of(bool is_given, const char* option, bool is_in_header, const char* attribute,
                      bool is_noted, const char* what) {
  if (is_given) return option;
  if (is_in_header) return "the file's " + std::string{attribute};
  return is_noted ? "what the picture says" : "the default " + std::string{what};
}

/// `lens` with what the file's header and the options say.
ThinLens settled_thin_lens(ThinLens lens, const PhotoLens& photo, bool is_noted,
                           std::string& from) {
  const HeaderLens& header = photo.of_file;
  lens.focal_length_mm = header.focal_length_mm.value_or(lens.focal_length_mm);
  lens.f_number = header.f_number.value_or(lens.f_number);
  from = source_of(photo.lens.given[&ThinLens::focal_length_mm].has_value(), "--focal-length",
                   header.focal_length_mm.has_value(), "nominalFocalLength", is_noted,
                   "focal length") +
         ", " +
         source_of(photo.lens.given[&ThinLens::f_number].has_value(), "--f-number",
                   header.f_number.has_value(), "aperture", is_noted, "f-number");
  return overruled(lens, photo.lens);
}

/// The picture's height over the height that it shows at distance 1. `image_mm` lies between the
/// lens and a sensor.
double pixels_per_tangent(CameraSource source, const PhotoLens& photo,
                          const std::optional<PictureNotes>& notes, std::optional<double> focal_px,
                          double image_mm, int width, int height) {
  const auto of_degrees = [&](double degrees) {
    return height / (2.0 * exact_math::tan_degrees(degrees / 2.0));
  };
  switch (source) {
    case CameraSource::fov: return of_degrees(*photo.fov_y_degrees);
    case CameraSource::notes: return of_degrees(notes->fov_y_degrees);
    case CameraSource::focal_px: return *focal_px;
    default: {
      const Sensor sensor = sensor_of(photo);
      return image_mm * pixels_per_sensor_mm(sensor.width_mm, sensor.height_mm, width, height);
    }
  }
}

/// For notes and reports alone: the C library's arctangent has other bits elsewhere.
double shown_degrees(double pixels_per_unit_tangent, int height) {
  return 2.0 * std::atan(height / (2.0 * pixels_per_unit_tangent)) * 180.0 / exact_math::kPi;
}

double ranked(std::vector<float>& values, std::size_t rank) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), place, values.end());
  return static_cast<double>(*place);
}

std::string pixel_text(Pixel pixel) {
  return std::to_string(pixel.x) + "," + std::to_string(pixel.y);
}

/// Whether the nearest may be asked for.
bool looks_at_nearest(const PhotoLens& photo) {
  const bool is_said = photo.lens.given[&ThinLens::focus_m] || photo.focus_at || photo.autofocus ||
                       photo.focus_range || photo.of_file.focus_m;
  return photo.focus_nearest || !is_said;
}

/// The distance in focus and who said it.
double focus_of(const PhotoLens& photo, FocusDepths& depths, std::string& from) {
  if (photo.lens.given[&ThinLens::focus_m]) {
    from = "--focus";
    return *photo.lens.given[&ThinLens::focus_m];
  }
  if (photo.focus_range) {
    from = "--focus-range";
    return photo.focus_range->near_m;
  }
  const bool is_asked = photo.focus_at || photo.autofocus;
  if (photo.focus_nearest || (looks_at_nearest(photo) && depths.around.empty())) {
    if (depths.finite == 0)
      throw UsageError("--focus-nearest: nothing has a finite depth; give a --focus");
    from = photo.focus_nearest ? "the nearest thousandth"
                               : "the nearest thousandth, for the middle is infinitely far";
    return ranked(depths.nearest, depths.finite / 1000);
  }
  if (photo.of_file.focus_m && !is_asked) {
    from = "the file's focus";
    return *photo.of_file.focus_m;
  }
  const PictureBox& film = depths.film.box;
  const Pixel pixel{depths.pixel.x - film.x, depths.pixel.y - film.y};
  if (pixel.x < 0 || pixel.x >= film.width || pixel.y < 0 || pixel.y >= film.height) {
    throw UsageError("--focus-at " + pixel_text(pixel) +
                     ": the pixel must lie in the picture, 0,0 to " +
                     pixel_text({film.width - 1, film.height - 1}));
  }
  from = "the median around pixel " + pixel_text(pixel);
  if (depths.around.empty()) {
    throw UsageError("--focus-at " + pixel_text(pixel) +
                     ": nothing there has a finite depth; give a --focus or another pixel");
  }
  return ranked(depths.around, depths.around.size() / 2);
}

}  // namespace

void add_photo_lens_options(CLI::App& parser, PhotoLens& photo) {
  begin_group(parser, "Lens");
  add_refocus_lens_options(parser, photo.lens,
                           [&photo](double degrees) { photo.fov_y_degrees = degrees; });
  add_value(
      parser, "--focus-at", "X,Y", "Focus on what is at this pixel: the median of the 5x5 there",
      [&photo](const std::string& text) { photo.focus_at = parse_pixel("--focus-at", text); });
  add_value(parser, "--autofocus", "[X,Y]", "The same, or on the middle, whatever the file says",
            [&photo](const std::string& text) {
              photo.autofocus = true;
              if (text != "centre") photo.focus_at = parse_pixel("--autofocus", text);
            });
  add_flag(parser, "--focus-nearest", "Focus on what is nearest", photo.focus_nearest);
  add_value(parser, "--focus-range", "NEAR..FAR",
            "All between these distances is sharp; beyond, the blur begins at their ends",
            [&photo](const std::string& text) { photo.focus_range = parse_focus_range(text); });
  add_value(parser, "--sensor", "NAME|WxHmm",
            "The sensor, which with the focal length gives the field of view: " +
                names_of(kSensors) + " (default: the picture's field of view, or full-frame)",
            [&photo](const std::string& text) { photo.sensor = parse_sensor(text); });
  offer(parser, "--sensor", [] { return names_in(kSensors); });
  add_parameter(parser, parameter::kBlurAtInfinity, "", photo.blur_at_infinity_px);
}

void check_photo_lens(const CLI::App& parser) {
  check_one_of(parser,
               {"--focus", "--focus-at", "--autofocus", "--focus-nearest", "--focus-range"});
  check_one_of(parser, {"--fov", "--sensor"});
  for (const char* option : {"--f-number", "--focal-length", "--sensor", "--coc-scale"}) {
    check_one_of(parser, {"--blur-at-infinity", option});
  }
}

namespace {

/// So many pixels across, in heights of a pixel.
int in_heights(int width, double pixel_aspect) {
  return std::max(1, static_cast<int>(std::floor(width * pixel_aspect + 0.5)));
}

}  // namespace

double pixels_per_tangent(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                          std::optional<double> focal_px, int width, int height) {
  width = in_heights(width, photo.film ? photo.film->pixel_aspect : 1.0);
  return pixels_per_tangent(camera_source(photo, notes, focal_px), photo, notes, focal_px,
                            focal_length_mm(photo, notes), width, height);
}

FocusDepths::FocusDepths(const PhotoLens& photo, int map_width, int map_height)
    : width(map_width),
      height(map_height),
      film(photo.film.value_or(Film{{0, 0, map_width, map_height}})),
      pixel{film.box.x + photo.focus_at.value_or(Pixel{film.box.width / 2, 0}).x,
            film.box.y + photo.focus_at.value_or(Pixel{0, film.box.height / 2}).y},
      most_nearest_(looks_at_nearest(photo) ? static_cast<std::size_t>(map_width) *
                                                      static_cast<std::size_t>(map_height) / 1000 +
                                                  1
                                            : 0) {}

void FocusDepths::add(std::span<const float> metres, int first_row) {
  constexpr int kReach = 2;
  const auto columns = static_cast<std::size_t>(width);
  const int end_row = first_row + static_cast<int>(metres.size() / columns);
  for (int y = std::max(pixel.y - kReach, first_row); y <= std::min(pixel.y + kReach, end_row - 1);
       ++y) {
    for (int x = std::max(pixel.x - kReach, 0); x <= std::min(pixel.x + kReach, width - 1); ++x) {
      const float depth_m =
          metres[static_cast<std::size_t>(y - first_row) * columns + static_cast<std::size_t>(x)];
      if (std::isfinite(depth_m)) around.push_back(depth_m);
    }
  }
  if (most_nearest_ == 0) return;
  for (const float depth_m : metres) {
    if (!std::isfinite(depth_m)) continue;
    ++finite;
    nearest.push_back(depth_m);
    if (nearest.size() < 2 * most_nearest_ + 1024) continue;
    std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(most_nearest_),
                     nearest.end());
    nearest.resize(most_nearest_);
  }
}

SettledLens settle_lens(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                        std::optional<double> focal_px, const DepthMap& depth) {
  FocusDepths depths{photo, depth.width, depth.height};
  depths.add(depth.metres, 0);
  return settle_lens(photo, notes, focal_px, std::move(depths));
}

SettledLens settle_lens(const PhotoLens& photo, const std::optional<PictureNotes>& notes,
                        std::optional<double> focal_px, FocusDepths depths) {
  SettledLens settled;
  settled.pixel_aspect = depths.film.pixel_aspect;
  if (notes && notes->lens) {
    settled.lens = notes->lens->lens;
    settled.coc_scale = notes->lens->coc_scale;
  }
  const bool is_noted = notes && notes->lens;
  settled.lens = settled_thin_lens(settled.lens, photo, is_noted, settled.lens_from);
  settled.coc_scale = photo.lens.coc_scale.value_or(settled.coc_scale);
  if (photo.circles) {
    settled.focus_from = "--circles";
  } else {
    settled.lens.focus_m = focus_of(photo, depths, settled.focus_from);
  }
  settled.range = photo.focus_range;
  const CameraSource source = camera_source(photo, notes, focal_px);
  constexpr std::array<const char*, 5> kSources{"--fov", "--sensor ", "--focal-px",
                                                "what the picture says", "the default, full-frame"};
  settled.camera_from = kSources[static_cast<std::size_t>(source)];
  if (source == CameraSource::sensor) settled.camera_from += photo.sensor->name;
  const auto camera = [&](double image_mm) {
    const Film& film = depths.film;
    const double pixels =
        pixels_per_tangent(source, photo, notes, focal_px, image_mm,
                           in_heights(film.box.width, film.pixel_aspect), film.box.height);
    const bool known = source == CameraSource::fov || source == CameraSource::notes;
    settled.fov_y_degrees = !known                        ? shown_degrees(pixels, film.box.height)
                            : source == CameraSource::fov ? *photo.fov_y_degrees
                                                          : notes->fov_y_degrees;
    return pixels;
  };
  if (photo.circles) {
    settled.has_lens = false;
    camera(focal_length_mm(photo, notes));
    settled.coc = *photo.circles;
    return settled;
  }
  if (photo.blur_at_infinity_px) {
    // A lens focused at the near end of a range has more blur beyond it than one at the far end.
    const double more =
        photo.focus_range ? photo.focus_range->far_m / photo.focus_range->near_m : 1.0;
    settled.has_lens = false;
    camera(focal_length_mm(photo, notes));
    settled.coc = {static_cast<float>(*photo.blur_at_infinity_px * more),
                   static_cast<float>(settled.lens.focus_m)};
    return settled;
  }
  check_lens(settled.lens, photo.lens, settled.focus_from);
  settled.coc =
      sensor_coc(settled.lens, camera(image_distance_mm(settled.lens, settled.lens.focus_m)),
                 settled.coc_scale);
  if (!std::isfinite(settled.coc.radius_at_infinity_px)) {
    throw UsageError("the lens's circles are too large: give a larger --f-number");
  }
  return settled;
}

void move_range_into_focus(DepthMap& map, const SharpDepthRange& range) {
  for (float& metres : map.metres) {
    const double z = static_cast<double>(metres);
    if (z >= range.near_m && z <= range.far_m) {
      metres = static_cast<float>(range.near_m);
    } else if (z > range.far_m) {
      metres = static_cast<float>(1.0 / (1.0 / z + 1.0 / range.near_m - 1.0 / range.far_m));
    }
  }
}

}  // namespace softfocus
