#include "tools/chart/settings.h"

#include <algorithm>
#include <filesystem>

#include "dof/pipelines/pipeline.h"
#include "scenes/frame/frame.h"
#include "tools/cli/option_values.h"
#include "tools/files/hash_text.h"
#include "tools/files/json.h"

namespace softfocus {
namespace {

constexpr std::string_view kAccumulation = "accumulation", kAuto = "auto", kTwoPass = "two-pass";

/// The radii of every filter, so that no filter is held against another at a larger radius. Radii
/// are --max-coc for a picture 1024 rows high, scaled with the height as those of scenes are.
const std::vector<double>& radii_at_1024(bool quick) {
  static const std::vector<double> all{8, 16, 32, 64}, few{16, 64};
  return quick ? few : all;
}

struct SettingsOfMethod {
  std::string_view method;
  bool radii = true;  ///< each radius with each profile
  std::vector<std::string_view> profiles{"ieee"};
  std::vector<int> samples{};
  std::vector<int> quick_samples{};
  std::vector<double> max_errors{};
  std::vector<double> quick_max_errors{};
};

const std::vector<SettingsOfMethod>& table() {
  static const std::vector<SettingsOfMethod> settings{
      {.method = kPinhole, .radii = false},
      {.method = kTwoPass, .profiles = {"ieee", "d3d11"}},
      {.method = kAccumulation,
       .radii = false,
       .profiles = {},
       .samples = {8, 16, 32, 64},
       .quick_samples = {8, 32}},
      {.method = kOfFilteredViews,
       .radii = false,
       .profiles = {},
       .samples = {4, 8, 16, 32},
       .quick_samples = {8}},
      {.method = kAuto,
       .radii = false,
       .profiles = {},
       .max_errors = {0.05, 0.02, 0.01},
       .quick_max_errors = {0.05, 0.02}},
      // Settings of every other method.
      {.method = ""},
  };
  return settings;
}

const SettingsOfMethod& settings_of(std::string_view method) {
  const auto found = std::find_if(table().begin(), table().end(),
                                  [&](const SettingsOfMethod& of) { return of.method == method; });
  return found == table().end() ? table().back() : *found;
}

}  // namespace

bool is_of_effects(const ChartEntry& entry) {
  return !entry.effects.empty() || entry.supersample > 1 || entry.multisample > 1;
}

bool is_of_pinhole(const ChartEntry& entry) {
  return is_of_effects(entry) || entry.shadows.has_value() || entry.turn.has_value();
}

std::vector<std::string> chart_methods() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  names.emplace_back(kAccumulation);
  names.emplace_back(kOfFilteredViews);
  names.emplace_back(kOfWarpedViews);
  for (const LensViewMethod& method : lens_view_methods()) {
    if (!method.samples_lens) names.emplace_back(method.name);
  }
  names.emplace_back(kAuto);
  return names;
}

std::vector<ChartEntry> chart_entries(const std::string& method, int height_px, bool quick) {
  const SettingsOfMethod& of = settings_of(method);
  std::vector<ChartEntry> entries;
  const Method* const filter = find_method_choice(method).filter;
  const LensViewMethod* const of_scene = find_lens_view_method(method);
  if (of_scene != nullptr && !of_scene->samples_lens) {
    return {{.method = method, .of_scene = of_scene}};
  }
  if (method == kOfWarpedViews) {
    struct Views {
      int samples, drawn;
    };
    for (const Views of_few :
         quick ? std::vector<Views>{{64, 7}} : std::vector<Views>{{64, 3}, {64, 7}, {256, 7}}) {
      entries.push_back({.method = method, .samples = of_few.samples, .drawn_views = of_few.drawn});
    }
    return entries;
  }
  for (const int samples : quick ? of.quick_samples : of.samples) {
    entries.push_back({.method = method, .samples = samples});
  }
  for (const double error : quick ? of.quick_max_errors : of.max_errors) {
    entries.push_back({.method = method, .max_error = error});
  }
  const std::vector<double> radii = of.radii ? radii_at_1024(quick) : std::vector<double>{};
  for (const std::string_view profile : of.profiles) {
    const ChartEntry plain{.method = method, .filter = filter, .profile = std::string{profile}};
    if (radii.empty()) entries.push_back(plain);
    for (const double radius : radii) {
      entries.push_back(plain);
      const double scaled = std::min(radius * height_px / 1024.0, double{kLargestMaxCoc});
      entries.back().max_coc_px = static_cast<float>(scaled);
    }
  }
  if (method == kTwoPass) {
    for (const double radius : radii) {
      const auto scaled = static_cast<float>(radius * height_px / 1024.0);
      ChartEntry entry{.method = method, .filter = filter, .max_coc_px = scaled};
      entry.arithmetic = Arithmetic::fixed_8;
      if (scaled <= kLargestFixedRadiusPx) entries.push_back(std::move(entry));
    }
  }
  return entries;
}

Json settings_json(const ChartEntry& entry) {
  if (entry.max_error) return {{"max_error", *entry.max_error}, {"chosen", entry.chosen}};
  if (entry.of_scene != nullptr) return Json::object();
  if (is_of_pinhole(entry)) {
    Json json = Json::object();
    if (!entry.setting.name.empty()) json[entry.setting.name] = entry.setting.value;
    return json;
  }
  if (entry.drawn_views > 0) return {{"samples", entry.samples}, {"views", entry.drawn_views}};
  if (entry.filter == nullptr) return {{"samples", entry.samples}};
  Json json = Json::object();
  if (entry.max_coc_px) json["max_coc_px"] = *entry.max_coc_px;
  json["profile"] = entry.profile;
  if (entry.arithmetic != Arithmetic::floats) {
    json["arithmetic"] = arithmetic_name(entry.arithmetic);
  }
  return json;
}

std::string settings_text(const ChartEntry& entry) {
  std::string text = setting_within_series(entry);
  if (!entry.chosen.empty()) text += ": " + entry.chosen;
  if (entry.profile != "ieee") text += (text.empty() ? "" : ", ") + entry.profile;
  if (entry.arithmetic != Arithmetic::floats) {
    text += ", " + std::string{arithmetic_name(entry.arithmetic)};
  }
  return text;
}

std::string setting_within_series(const ChartEntry& entry) {
  if (entry.max_error) return "max-error " + short_number(*entry.max_error);
  if (entry.of_scene != nullptr) return "";
  if (is_of_pinhole(entry)) {
    const EffectSetting& setting = entry.setting;
    return setting.name.empty() ? "" : setting.name + " " + short_number(setting.value);
  }
  if (entry.drawn_views > 0) {
    return count_text(entry.samples, "sample") + " from " + std::to_string(entry.drawn_views);
  }
  if (entry.filter == nullptr) return count_text(entry.samples, "sample");
  return entry.max_coc_px ? "max-coc " + short_number(double{*entry.max_coc_px}) : "";
}

std::string entry_id(const ChartEntry& entry) {
  std::string id = entry.method;
  if (entry.filter != nullptr && entry.filter->pipeline != nullptr) {
    id = std::filesystem::path{entry.method}.stem().string() + "-" +
         hash_text(entry.filter->pipeline->hash);
  }
  if (entry.max_error) return id + "-e" + short_number(*entry.max_error);
  if (entry.of_scene != nullptr) return id;
  if (is_of_pinhole(entry)) {
    const EffectSetting& setting = entry.setting;
    return setting.name.empty() ? id : id + "-" + setting.name + short_number(setting.value);
  }
  if (entry.drawn_views > 0) {
    return id + "-s" + std::to_string(entry.samples) + "-v" + std::to_string(entry.drawn_views);
  }
  if (entry.filter == nullptr) return id + "-s" + std::to_string(entry.samples);
  if (entry.max_coc_px) id += "-r" + short_number(double{*entry.max_coc_px});
  if (entry.profile != "ieee") id += "-" + entry.profile;
  if (entry.arithmetic != Arithmetic::floats) {
    id += "-" + std::string{arithmetic_name(entry.arithmetic)};
  }
  return id;
}

std::string series_name(const ChartEntry& entry) {
  std::string name = entry.method;
  if (entry.profile != "ieee") name += ", " + entry.profile;
  if (entry.arithmetic != Arithmetic::floats) {
    name += ", " + std::string{arithmetic_name(entry.arithmetic)};
  }
  return name;
}

}  // namespace softfocus
