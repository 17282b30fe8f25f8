#include "tools/crosscheck/run_cases.h"

#include <fnmatch.h>

#include <algorithm>

#include "tools/crosscheck/cases.h"
#include "tools/files/json.h"
#include "tools/files/whole_file.h"
#include "tools/gl/driver/driver_process.h"
#include "tools/pictures/image_file.h"

namespace softfocus {
namespace {

std::vector<Case> chosen_cases(const std::vector<std::string>& patterns,
                               const std::string& pipeline, bool quick, const Driver* driver) {
  std::vector<Case> all, chosen;
  if (pipeline.empty()) {
    all = crosscheck_cases();
  } else {
    add_pipeline_cases(pipeline, all);
  }
  for (Case& one : all) {
    const std::string name = one.stage + '/' + one.name;
    const bool suits = driver == nullptr || ((one.slow_too || !driver->slow) &&
                                             (driver->has_samples || !one.has_samples));
    const bool wanted = (one.quick || !quick) && suits;
    const bool matches = std::any_of(
        patterns.begin(), patterns.end(),
        [&](const std::string& glob) { return ::fnmatch(glob.c_str(), name.c_str(), 0) == 0; });
    if (wanted && (patterns.empty() || matches)) chosen.push_back(one);
  }
  return chosen;
}

// A case's picture, without the ending.
std::filesystem::path picture_name(const CrosscheckWork& work, const std::string& stage,
                                   const std::string& name) {
  return work.pictures / (std::string(work.driver.name) + '.' + stage + '.' + name);
}

// The three get their names together, when nothing can fail but the naming.
void write_pictures(const Tally& tally, const std::filesystem::path& name) {
  const auto ending = [&](const char* text) { return std::filesystem::path{name} += text; };
  WholeFile picture{ending(".png")}, driver{ending(".driver.npy")}, ours{ending(".emulation.npy")};
  picture.write(encode_png(side_by_side(tally)));
  driver.write(encode_npy(tally.driver));
  ours.write(encode_npy(tally.emulated));
  picture.commit();
  driver.commit();
  ours.commit();
}

Json line_of(const Case& one, const Tally& tally, bool has_picture, const std::string& error) {
  Json line{{"stage", one.stage},
            {"name", one.name},
            {"values", tally.values},
            {"differing", tally.differing},
            {"max_ulp", tally.max_ulp},
            {"has_picture", has_picture},
            {"error", error}};
  if (tally.first) {
    const FirstDifference& first = *tally.first;
    line["first"] = {{"x", first.x},
                     {"y", first.y},
                     {"channel", first.channel},
                     {"driver", first.driver},
                     {"emulated", first.emulated},
                     {"where", first.where}};
  }
  return line;
}

CaseResult result_of(const Json& line, const CrosscheckWork& work) {
  CaseResult result;
  result.stage = line.at("stage").text();
  result.name = line.at("name").text();
  result.values = static_cast<std::uint64_t>(line.at("values").integer());
  result.differing = static_cast<std::uint64_t>(line.at("differing").integer());
  result.max_ulp = static_cast<std::uint32_t>(line.at("max_ulp").integer());
  result.error = line.at("error").text();
  if (line.at("has_picture").boolean()) {
    result.picture = picture_name(work, result.stage, result.name).string() + ".png";
  }
  if (const Json* first = line.find("first")) {
    const auto whole = [&](const char* name) {
      return static_cast<int>(first->at(name).integer());
    };
    result.first = {whole("x"),
                    whole("y"),
                    whole("channel"),
                    first->at("driver").text(),
                    first->at("emulated").text(),
                    first->at("where").text()};
  }
  return result;
}

// In the driver's process.
void compare_all(const CrosscheckWork& work, const SendLine& send) {
  const GlContext gl{work.driver, {}, work.profile};
  send(json_text({{"renderer", gl.renderer() + ", OpenGL " + gl.version()}}));
  ThreadPool pool{work.threads};
  const Bench bench{gl, work.shaders, work.profile, pool};
  for (const Case& one : chosen_cases(work.cases, work.pipeline, work.quick, &work.driver)) {
    Tally tally;
    std::string error;
    bool has_picture = false;
    try {
      one.run(bench, tally);
      if (tally.differing != 0 && !work.pictures.empty()) {
        write_pictures(tally, picture_name(work, one.stage, one.name));
        has_picture = true;
      }
    } catch (const std::exception& refused) {
      error = refused.what();  // of this case; the others still run
    }
    send(json_text(line_of(one, tally, has_picture, error)));
  }
}

}  // namespace

DriverRun run_cases(const CrosscheckWork& work,
                    const std::function<void(const CaseResult&)>& report) {
  DriverRun run;
  run.error = run_driver_process([&](const SendLine& send) { compare_all(work, send); },
                                 [&](const std::string& text) {
                                   const Json line = parse_json(text).value();
                                   if (const Json* renderer = line.find("renderer")) {
                                     run.renderer = renderer->text();
                                   } else {
                                     report(result_of(line, work));
                                   }
                                 });
  return run;
}

int matching_cases(const std::vector<std::string>& patterns, const std::string& pipeline,
                   bool quick, const Driver* driver) {
  return static_cast<int>(chosen_cases(patterns, pipeline, quick, driver).size());
}

}  // namespace softfocus
