#include "tools/compare/report.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <numeric>

#include "scenes/load/load_scene.h"
#include "tools/cli/option_values.h"
#include "tools/files/json.h"
#include "tools/options/lens_options.h"

namespace softfocus {
namespace {

AssumedLens known_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures) {
  if (options.scene) {
    const Scene scene = load_scene(*options.scene, scene_search_path(options.scene_path));
    return {{scene.lens.lens, scene.lens.coc_scale, scene.camera.fov_y_degrees},
            "scene",
            scene.name,
            {},
            scene.files};
  }
  for (const NamedNotes& picture : pictures) {
    if (picture.found.notes && picture.found.notes->lens) {
      return {*picture.found.notes->lens, "picture", picture.found.place.string(), {}, {}};
    }
  }
  return {{}, "default", "", {}, {}};
}

std::string degrees_text(double degrees) { return short_number(degrees) + " degrees"; }

}  // namespace

AssumedLens assumed_lens(const CompareOptions& options, const std::vector<NamedNotes>& pictures) {
  AssumedLens assumed = known_lens(options, pictures);
  const auto overrule = [&](const std::string& option, std::optional<double> value, double& place) {
    if (!value) return;
    place = *value;
    assumed.given.emplace_back(option);
  };
  NotedLens& lens = assumed.lens;
  for (const LensNumber& number : kLensNumbers) {
    overrule("--" + std::string{number.parameter.name}, options.lens.given[number.place],
             lens.lens.*number.place);
  }
  overrule("--coc-scale", options.lens.coc_scale, lens.coc_scale);
  overrule("--fov", options.fov_y_degrees, lens.fov_y_degrees);
  constexpr std::size_t kAllOptions = kLensNumbers.size() + 2;
  if (assumed.given.size() == kAllOptions) assumed.source = "options";
  check_lens(lens.lens, options.lens,
             assumed.source == "default" ? "the default lens" : "the lens of " + assumed.name);
  return assumed;
}

std::string lens_text(const NotedLens& lens) {
  return short_number(lens.lens.focal_length_mm) + " mm, f/" + short_number(lens.lens.f_number) +
         ", focused at " + short_number(lens.lens.focus_m) + " m, coc scale " +
         short_number(lens.coc_scale) + ", field of view " + degrees_text(lens.fov_y_degrees);
}

std::string source_text(const AssumedLens& assumed) {
  if (assumed.source == "options") return "all of it as given";
  std::string text = assumed.source == "scene"     ? "by the scene " + assumed.name
                     : assumed.source == "picture" ? "by " + assumed.name
                                                   : "assumed: no picture says, nor does --scene";
  std::string given;
  for (const std::string& option : assumed.given) given += (given.empty() ? "" : ", ") + option;
  return given.empty() ? text : text + "; " + given + " as given";
}

std::vector<std::string> lens_doubts(const std::vector<NamedNotes>& pictures) {
  std::vector<std::string> doubts;
  const NamedNotes* first = nullptr;
  for (const NamedNotes& picture : pictures) {
    const FoundNotes& found = picture.found;
    if (found.stale) {
      doubts.push_back("'" + found.place.string() + "' is of another picture than '" +
                       picture.name + "': it is not read");
    }
    if (!found.notes || !found.notes->lens) continue;
    if (first == nullptr) first = &picture;
    const NotedLens& lens = *first->found.notes->lens;
    // Of lenses that differ past the digits that are told, the note would show the same text twice.
    if (lens_text(*found.notes->lens) == lens_text(lens)) continue;
    doubts.push_back("the pictures have different lenses: '" + first->name + "' " +
                     lens_text(lens) + "; '" + picture.name + "' " + lens_text(*found.notes->lens));
  }
  return doubts;
}

namespace {

std::string bucket_name(std::size_t bucket) {
  if (bucket < 2) return std::to_string(bucket);
  return std::to_string(1 << (bucket - 1)) + " to " + std::to_string((1 << bucket) - 1);
}

/// A number, or a dash for what does not exist.
std::string number_or_dash(double value) { return std::isnan(value) ? "-" : short_number(value); }

void print_line(const std::string& name, const std::string& value) {
  std::cout << name << std::string(20 - name.size(), ' ') << value << '\n';
}

void print_whole(const Measures& whole) {
  print_line("PSNR of colour", short_number(whole.psnr_db) + " dB");
  print_line("PSNR, tone-mapped", short_number(whole.toned_psnr_db) + " dB");
  print_line("MSE of colour", short_number(whole.mse));
  print_line("MSE, tone-mapped", short_number(whole.toned_mse));
  print_line("SSIM", short_number(whole.ssim));
  print_line("FLIP", short_number(whole.flip));
  if (whole.hdr_flip) print_line("HDR-FLIP", short_number(*whole.hdr_flip));
}

/// By the names that other programs have for it.
void print_codes(const CodeDifference& codes) {
  print_line("codes of 8 bits", "AE " + std::to_string(codes.pixels) + " pixels, MAE " +
                                    short_number(codes.mean_error) + ", RMSE " +
                                    short_number(codes.rms_error) + ", PSNR " +
                                    short_number(codes.psnr_db) + " dB");
  if (codes.max_error > 0) {
    print_line("", "PAE " + std::to_string(codes.max_error) + " of 255, at " +
                       std::to_string(codes.max_x) + "," + std::to_string(codes.max_y));
  }
  print_line("YIQ", std::to_string(codes.beyond) + " pixels beyond the threshold, and " +
                        std::to_string(codes.anti_aliased) + " that are anti-aliased");
}

void print_histogram(const Difference& difference) {
  print_line("half-ULPs", "values");
  for (std::size_t bucket = 0; bucket < difference.ulp_histogram.size(); ++bucket) {
    if (difference.ulp_histogram[bucket] == 0) continue;
    print_line("  " + bucket_name(bucket), std::to_string(difference.ulp_histogram[bucket]));
  }
}

void print_regions(const MeasuredPictures& measured) {
  const auto print_row = [](const std::string& name, const std::vector<std::string>& cells) {
    std::cout << std::left << std::setw(12) << name << std::right;
    for (const std::string& cell : cells) std::cout << std::setw(13) << cell;
    std::cout << '\n';
  };
  std::vector<std::string> titles{"pixels",   "MSE",  "PSNR dB", "toned MSE",
                                  "toned dB", "SSIM", "FLIP"};
  if (measured.whole.hdr_flip) titles.emplace_back("HDR-FLIP");
  print_row("region", titles);
  for (const Region region : kAllRegions) {
    const Measures& m = measured.by_region[static_cast<std::size_t>(region)];
    std::vector<std::string> cells{std::to_string(m.pixels)};
    if (m.pixels == 0) {
      cells.emplace_back("   no pixel of the picture lies there");
      print_row(std::string{region_name(region)}, cells);
      continue;
    }
    for (const double value : {m.mse, m.psnr_db, m.toned_mse, m.toned_psnr_db, m.ssim, m.flip}) {
      cells.push_back(number_or_dash(value));
    }
    if (m.hdr_flip) cells.push_back(number_or_dash(*m.hdr_flip));
    print_row(std::string{region_name(region)}, cells);
  }
}

double energy_ratio(const PointFindings& point) { return point.a.energy / point.b.energy; }

void print_point(const PointFindings& point) {
  const auto pair = [](double a, double b) {
    const std::string first = number_or_dash(a);
    return first + std::string(first.size() < 12 ? 12 - first.size() : 1, ' ') + number_or_dash(b);
  };
  print_line("energy of A over B", number_or_dash(energy_ratio(point)));
  print_line("of the point", "A           B");
  print_line("  energy", pair(point.a.energy, point.b.energy));
  print_line("  eigenvalue ratio", pair(point.a.eigenvalue_ratio, point.b.eigenvalue_ratio));
  print_line("  radius, px", pair(point.a.radius_px, point.b.radius_px));
  print_line("  from the disc", pair(point.a_deviation, point.b_deviation));
}

void add_measures(Json& json, const Measures& m) {
  json["mse"] = number_or_null(m.mse);
  json["tone_mapped_mse"] = number_or_null(m.toned_mse);
  json["tone_mapped_psnr_db"] = number_or_null(m.toned_psnr_db);
  json["ssim"] = number_or_null(m.ssim);
  json["flip"] = number_or_null(m.flip);
  if (m.hdr_flip) json["hdr_flip"] = number_or_null(*m.hdr_flip);
}

Json regions_json(const MeasuredPictures& measured) {
  Json list = Json::array();
  for (const Region region : kAllRegions) {
    const Measures& m = measured.by_region[static_cast<std::size_t>(region)];
    Json entry{{"region", region_name(region)},
               {"pixels", m.pixels},
               {"psnr_db", number_or_null(m.psnr_db)}};
    add_measures(entry, m);
    list.push_back(entry);
  }
  return list;
}

Json point_json(const PointFindings& point) {
  const auto of = [](const PointShape& shape, double deviation) {
    return Json{{"energy", number_or_null(shape.energy)},
                {"x", shape.centre_x_px},
                {"y", shape.centre_y_px},
                {"eigenvalue_ratio", number_or_null(shape.eigenvalue_ratio)},
                {"radius_px", number_or_null(shape.radius_px)},
                {"disc_deviation", number_or_null(deviation)}};
  };
  return {{"disc_radius_px", point.disc_radius_px},
          {"energy_ratio", number_or_null(energy_ratio(point))},
          {"a", of(point.a, point.a_deviation)},
          {"b", of(point.b, point.b_deviation)}};
}

Json texts_json(const std::vector<std::string>& texts) {
  Json list = Json::array();
  for (const std::string& text : texts) list.push_back(text);
  return list;
}

Json lens_json(const AssumedLens& assumed) {
  const auto& [lens, coc_scale, fov_y_degrees] = assumed.lens;
  Json json = Json::object();
  add_lens(json, lens, coc_scale);
  json["fov_y_degrees"] = fov_y_degrees;
  json["source"] = assumed.source;
  json["name"] = assumed.name.empty() ? Json() : Json(assumed.name);
  json["given"] = texts_json(assumed.given);
  return json;
}

Json limits_json(const std::vector<LimitFinding>& findings) {
  Json list = Json::array();
  for (const LimitFinding& finding : findings) {
    list.push_back({{"option", finding.option},
                    {"limit", finding.limit},
                    {"value", number_or_null(finding.value)},
                    {"kept", is_kept(finding)}});
  }
  return list;
}

}  // namespace

bool within_limits(const CompareFindings& findings) {
  return std::all_of(findings.limits.begin(), findings.limits.end(), is_kept);
}

void print_compare_text(const CompareFindings& findings) {
  const Difference& d = findings.difference;
  print_line("differing values", std::to_string(d.differing) + " of " + std::to_string(d.values));
  if (d.differing != 0) {
    print_line("largest difference", std::to_string(d.max_ulp) + " half-ULPs");
    print_line("first difference", "pixel " + std::to_string(d.first_x) + ',' +
                                       std::to_string(d.first_y) + " channel " + findings.channel +
                                       ": " + short_number(static_cast<double>(findings.first_a)) +
                                       " and " +
                                       short_number(static_cast<double>(findings.first_b)));
    print_line("largest error", short_number(d.max_error) + " (linear light)");
    print_whole(findings.measured->whole);
    print_histogram(d);
  }
  if (findings.lens) {
    print_line("lens", lens_text(findings.lens->lens));
    print_line("", source_text(*findings.lens));
  }
  for (const std::string& doubt : findings.doubts) print_line("note", doubt);
  if (findings.focus_px > kFocusRadiusPx) {
    print_line("focus", "nothing is within " + short_number(static_cast<double>(kFocusRadiusPx)) +
                            " px of it beside silhouettes: here up to a radius of " +
                            short_number(static_cast<double>(findings.focus_px)) + " px");
  }
  if (findings.lens) print_regions(*findings.measured);
  if (findings.codes) print_codes(*findings.codes);
  if (findings.point) print_point(*findings.point);
  for (const LimitFinding& limit : findings.limits) print_line("limit", limit_text(limit));
  if (!findings.go_on.empty()) print_line("to go on", findings.go_on);
}

void print_compare_json(const CompareFindings& findings) {
  const Difference& d = findings.difference;
  Json json{{"equal", d.differing == 0},
            {"values", d.values},
            {"differing", d.differing},
            {"max_half_ulps", d.max_ulp},
            {"max_error", number_or_null(d.max_error)},
            {"psnr_db", number_or_null(d.psnr_db)},
            {"first", nullptr},
            {"histogram", Json::array()}};
  if (findings.codes) {
    const CodeDifference& codes = *findings.codes;
    json["codes"] = Json{{"ae", codes.pixels},
                         {"mae", codes.mean_error},
                         {"rmse", codes.rms_error},
                         {"psnr_db", number_or_null(codes.psnr_db)},
                         {"pae", codes.max_error},
                         {"beyond", codes.beyond},
                         {"anti_aliased", codes.anti_aliased}};
  }
  if (d.differing != 0) {
    json["first"] = {{"x", d.first_x},
                     {"y", d.first_y},
                     {"channel", std::string(1, findings.channel)},
                     {"a", findings.first_a},
                     {"b", findings.first_b}};
  }
  for (std::size_t bucket = 0; bucket < d.ulp_histogram.size(); ++bucket) {
    if (d.ulp_histogram[bucket] == 0) continue;
    json["histogram"].push_back(
        {{"half_ulps", bucket_name(bucket)}, {"values", d.ulp_histogram[bucket]}});
  }
  add_measures(json, findings.measured->whole);
  if (findings.lens) {
    json["lens"] = lens_json(*findings.lens);
    json["focus_up_to_px"] = findings.focus_px;
    json["regions"] = regions_json(*findings.measured);
  }
  if (!findings.doubts.empty()) json["notes"] = texts_json(findings.doubts);
  if (findings.point) json["point"] = point_json(*findings.point);
  if (!findings.limits.empty()) {
    json["within_limits"] = within_limits(findings);
    json["limits"] = limits_json(findings.limits);
  }
  std::cout << json_text(json, 2) << '\n';
}

double mean_flicker(const std::vector<double>& steps) {
  return std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
}

void print_flicker_text(const std::vector<double>& steps) {
  print_line("flicker", short_number(mean_flicker(steps)) + " a step, over " +
                            std::to_string(steps.size() + 1) + " frames");
}

void print_flicker_json(const std::vector<double>& steps) {
  const Json json{{"frames", steps.size() + 1}, {"flicker", mean_flicker(steps)}, {"steps", steps}};
  std::cout << json_text(json, 2) << '\n';
}

}  // namespace softfocus
