// start, about, scenes: what the page runs on, and what there is to show.

#include <algorithm>

#include "scenes/load/load_scene.h"
#include "tools/page/requests.h"
#include "tools/refocus/options.h"
#include "tools/refocus/photo_lens.h"

namespace softfocus {
namespace {

#if defined(__EMSCRIPTEN__) && !defined(__wasm_simd128__)
constexpr bool kSimd = false;
#else
constexpr bool kSimd = true;
#endif

constexpr int kMostThreads = 64;

Json cases_json() {
  Json cases = Json::array();
  for (const StressCase& known : stress_cases()) {
    Json values = Json::array();
    for (const double severity : known.severities) values.push_back(severity);
    cases.push_back({{"name", known.name},
                     {"title", known.title},
                     {"sentence", known.must_hold},
                     {"parameter", known.parameter.name},
                     {"unit", known.parameter.unit},
                     {"values", values},
                     {"telling", known.telling}});
  }
  return cases;
}

Json parameter_json(const Parameter& parameter) {
  return {{"name", parameter.name},    {"key", key_of(parameter)}, {"text", parameter.summary},
          {"unit", parameter.unit},    {"least", parameter.least}, {"most", parameter.most},
          {"preset", parameter.preset}};
}

/// By the keys of requests.
Json parameters_json() {
  Json all = Json::object();
  for (const LensNumber& number : kLensNumbers) {
    Json& of_lens = all[key_of(number.parameter)];
    of_lens = parameter_json(number.parameter);
    of_lens["of_lens"] = true;
  }
  for (const Parameter& parameter : page_parameters()) {
    all[key_of(parameter)] = parameter_json(parameter);
  }
  for (const OfDepth& of : kDepthNumbers)
    all[std::string{of.number.name}] = parameter_json(of.number);
  return all;
}

Json sensors_json() {
  Json list = Json::array();
  for (const NamedSensor& known : kSensors) {
    list.push_back(
        {{"name", known.name}, {"width_mm", known.width_mm}, {"height_mm", known.height_mm}});
  }
  return list;
}

Json methods_json() {
  Json list = Json::array();
  for (const Method& method : methods()) {
    list.push_back({{"name", method.name},
                    {"summary", method.summary},
                    {"kind", "filter"},
                    {"samples", false},
                    {"blades", MethodChoice{.filter = &method}.has_blades()},
                    {"stretch", MethodChoice{.filter = &method}.has_any_aperture()}});
  }
  for (const LensViewMethod& method : lens_view_methods()) {
    if (!method.missing.empty()) continue;
    list.push_back({{"name", method.name},
                    {"summary", method.summary},
                    {"kind", "views"},
                    {"samples", method.samples_lens},
                    {"blades", MethodChoice{.of_scene = &method}.has_blades()},
                    {"stretch", MethodChoice{.of_scene = &method}.has_any_aperture()}});
  }
  return list;
}

Json encodings_json() {
  Json list = Json::array();
  for (const DepthEncoding& encoding : depth_encodings()) {
    list.push_back({{"name", encoding.name},
                    {"summary", encoding.summary},
                    {"needs", encoding.needs},
                    {"takes", encoding.takes}});
  }
  list.push_back(
      {{"name", circles_encoding().name}, {"summary", kCirclesText}, {"needs", ""}, {"takes", ""}});
  return list;
}

template <class Choices>
Json choice_json(const char* name, const char* key, const char* text, const Choices& choices,
                 const Json& preset) {
  Json values = Json::array();
  for (const auto& choice : choices) values.push_back(choice.name);
  return {{"name", name}, {"key", key}, {"text", text}, {"values", values}, {"preset", preset}};
}

/// How a depth is read, beside its encoding: options of `refocus`.
Json readings_json() {
  Json list = Json::array();
  list.push_back(choice_json("holes", "holes", kHolesText, kHoles, kHoles.front().name));
  list.push_back(choice_json("depth-fit", "depth_fit", kDepthFitText, kDepthFits, nullptr));
  return list;
}

}  // namespace

Json answer_start(Page& page, const Json& request) {
  int threads = hardware_threads();
  Isa isa = widest_isa();
  if (const Json* number = request.find("threads")) {
    threads = static_cast<int>(checked_number(*number, "threads", 1, kMostThreads));
  }
  if (const Json* name = request.find("isa")) isa = find_isa(name->text()).value_or(isa);
  page.pool.reset();
  page.gpu_scene.reset();
  page.pool = std::make_unique<ThreadPool>(threads, isa);
  page.memory = {};
  page.truth.reset();
  return {{"threads", page.pool->threads()}, {"isa", isa_name(isa)}};
}

Json answer_about(Page& page, const Json& /*request*/) {
  return {{"version", SOFTFOCUS_VERSION},
          {"isa", isa_name(page.pool->isa())},
          {"threads", page.pool->threads()},
          {"simd", kSimd},
          {"hashes", member_count(expected_groups())},
          {"parameters", parameters_json()},
          {"sensors", sensors_json()}};
}

Json answer_scenes(Page& /*page*/, const Json& /*request*/) {
  Json scenes = Json::array();
  for (const SceneListing& scene : list_scenes(scene_search_path({}))) {
    scenes.push_back({{"name", scene.name}, {"title", scene.title}});
  }
  Json effect_names = Json::array();
  for (const Effect& effect : effects()) effect_names.push_back(effect.name);
  return {
      {"scenes", scenes},          {"effects", effect_names},       {"cases", cases_json()},
      {"methods", methods_json()}, {"encodings", encodings_json()}, {"readings", readings_json()}};
}

}  // namespace softfocus
