// softfocus lens: the lens in numbers.

#include <array>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>

#include "dof/lens.h"
#include "raster/images/image.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/options/lens_options.h"

namespace softfocus {
namespace {

struct LensCommandOptions {
  LensOptions lens;
  double fov_y_degrees = 40.0;
  int height_px = 1024;
  std::optional<double> largest_coc_mm;
  std::vector<double> distances_m;
  bool json = false;
};

struct CocAtDistance {
  double distance_m;
  double on_film_mm;
  double radius_px;
};

struct LensFigures {
  ThinLens lens;
  double film_mm = 0.0;
  double largest_coc_mm = 0.0;
  double hyperfocal_m = 0.0;
  SharpRange sharp{};
  PixelCoc coc;
  std::vector<CocAtDistance> at;
};

// Multiples of the focus distance: near, far and, where the circle is zero, the focus itself.
constexpr std::array kUsualDistances{0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0};

LensFigures figures(const LensCommandOptions& options) {
  LensFigures f;
  f.lens = overruled(ThinLens{}, options.lens);
  check_lens(f.lens, options.lens, "the default lens");
  f.film_mm = film_height_mm(f.lens, options.fov_y_degrees);
  f.largest_coc_mm = options.largest_coc_mm.value_or(f.film_mm / options.height_px);
  f.hyperfocal_m = hyperfocal_m(f.lens, f.largest_coc_mm);
  f.sharp = sharp_range(f.lens, f.largest_coc_mm);
  f.coc = checked_pixel_coc(f.lens, options.fov_y_degrees, options.height_px,
                            options.lens.coc_scale.value_or(1.0));
  auto distances = options.distances_m;
  if (distances.empty()) {
    for (const double part : kUsualDistances) distances.push_back(part * f.lens.focus_m);
  }
  for (const double z : distances) {
    f.at.push_back({z, coc_on_film_mm(f.lens, z),
                    static_cast<double>(coc_radius_px(f.coc, static_cast<float>(z)))});
  }
  return f;
}

void print_lens_text(const LensFigures& f, const LensCommandOptions& options) {
  const auto line = [](const char* name, const std::string& value) {
    std::cout << std::left << std::setw(23) << name << value << '\n';
  };
  const auto mm = [](double value) { return short_number(value) + " mm"; };
  const auto metres = [](double value) {
    return std::isfinite(value) ? short_number(value) + " m" : std::string{"infinity"};
  };
  line("focal length", mm(f.lens.focal_length_mm));
  line("f-number", short_number(f.lens.f_number));
  line("aperture", mm(aperture_mm(f.lens)));
  line("focus distance", metres(f.lens.focus_m));
  line("film height", mm(f.film_mm) + " for " + short_number(options.fov_y_degrees) +
                          " degrees and " + std::to_string(options.height_px) + " pixels");
  line("sharp is a circle of", mm(f.largest_coc_mm) + " on film, or less");
  line("sharp from", metres(f.sharp.near_m));
  line("sharp to", metres(f.sharp.far_m));
  line("hyperfocal distance", metres(f.hyperfocal_m));
  line("radius at infinity",
       short_number(static_cast<double>(f.coc.radius_at_infinity_px)) + " px");
  const auto columns = [](const std::string& a, const std::string& b, const std::string& c) {
    std::cout << std::right << std::setw(12) << a << std::setw(22) << b << std::setw(14) << c
              << '\n';
  };
  std::cout << '\n';
  columns("distance m", "circle on film mm", "radius px");
  for (const CocAtDistance& at : f.at) {
    columns(short_number(at.distance_m), short_number(at.on_film_mm), short_number(at.radius_px));
  }
}

void print_lens_json(const LensFigures& f, const LensCommandOptions& options) {
  Json json{{"focal_length_mm", f.lens.focal_length_mm},
            {"f_number", f.lens.f_number},
            {"aperture_mm", aperture_mm(f.lens)},
            {"focus_m", f.lens.focus_m},
            {"fov_y_degrees", options.fov_y_degrees},
            {"height_px", options.height_px},
            {"coc_scale", options.lens.coc_scale.value_or(1.0)},
            {"film_height_mm", f.film_mm},
            {"largest_sharp_coc_mm", f.largest_coc_mm},
            {"sharp_from_m", f.sharp.near_m},
            {"sharp_to_m", nullptr},  // infinity, which JSON has not
            {"hyperfocal_m", f.hyperfocal_m},
            {"radius_at_infinity_px", f.coc.radius_at_infinity_px},
            {"at", Json::array()}};
  if (std::isfinite(f.sharp.far_m)) json["sharp_to_m"] = f.sharp.far_m;
  for (const CocAtDistance& at : f.at) {
    json["at"].push_back({{"distance_m", at.distance_m},
                          {"coc_on_film_mm", at.on_film_mm},
                          {"radius_px", at.radius_px}});
  }
  std::cout << json_text(json, 2) << '\n';
}

void add_options(CLI::App& parser, LensCommandOptions& options) {
  begin_group(parser, "Lens");
  add_own_lens_options(parser, options.lens,
                       [&options](double degrees) { options.fov_y_degrees = degrees; });
  begin_group(parser, "Output");
  add_value(parser, "--height", "PIXELS", "Height of the picture (default: 1024)",
            [&options](const std::string& text) {
              options.height_px =
                  parse_whole("--height", text, 1, kMaxImageSize,
                              "a number of pixels from 1 to " + std::to_string(kMaxImageSize));
            });
  add_value(parser, "--max-coc-film", "MM",
            "Largest circle on film that is still sharp (default: one pixel's height)",
            [&options](const std::string& text) {
              options.largest_coc_mm = parse_number("--max-coc-film", text, 1e-9, 1e3,
                                                    "a diameter in millimetres above 0");
            });
  add_value_list(parser, "--at", "METRES",
                 "Distances to tell the circle for (default: 1/4 to 10 times the focus)",
                 [&options](const std::vector<std::string>& texts) {
                   for (const std::string& text : texts) {
                     options.distances_m.push_back(
                         parse_number("--at", text, 1e-6, 1e9, "distances in metres above 0"));
                   }
                 });
  add_flag(parser, "--json", "Print JSON", options.json);
}

}  // namespace

Command add_lens_command(CLI::App& program) {
  CLI::App* parser = add_command(program, "lens", "Print what a lens does, in numbers");
  const auto options = std::make_shared<LensCommandOptions>();
  add_options(*parser, *options);
  return {parser, [options] {
            (options->json ? print_lens_json : print_lens_text)(figures(*options), *options);
            return kDone;
          }};
}

}  // namespace softfocus
