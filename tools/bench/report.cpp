#include "tools/bench/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/cli/timing.h"
#include "tools/files/json.h"

namespace softfocus {
namespace {

std::string decimals(double value, int places) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", places, value);
  return text.data();
}

// Two decimals, or three where there is one digit before them.
std::string milliseconds_text(double ms) { return decimals(ms, ms < 10.0 ? 3 : 2); }

std::string times_text(const StageSamples& stage) { return spread_text(spread_of(stage.ms)); }

Spread ratio_of(const BenchRecord& record, std::size_t stage) {
  return spread_of(pair_ratios(record.samples.ours[stage].ms, record.samples.peers[stage].ms));
}

// ", max-coc 16", ", 256 samples", ": two-pass, radius 8".
std::string setting_of(const BenchRecord& record) {
  if (record.choice) return ": " + setting_text(*record.choice);
  if (const LensViewMethod* of_scene = record.work.method.of_scene) {
    return of_scene->samples_lens ? ", " + count_text(record.samples_taken, "sample") : "";
  }
  return ", max-coc " + short_number(static_cast<double>(record.work.settings.max_coc_px));
}

// "llvmpipe with the faster shader, tiled: brute-force 129.0 ms, tiled 50.12 ms"
std::string shaders_text(const BenchPeer& peer) {
  std::string text = peer.driver + " with the faster shader, " + peer.shader + ": ";
  for (const BenchPeer::ShaderForm& form : peer.shaders) {
    text += (&form == peer.shaders.data() ? "" : ", ") + form.name + ' ' +
            milliseconds_text(form.filter_ms) + " ms";
  }
  return text;
}

std::string heading(const BenchRecord& record) {
  const BenchWork& work = record.work;
  std::string text = work.name + ", ";
  if (work.scene) text += std::to_string(triangle_count(*work.scene)) + " triangles, ";
  text += size_text(work.size) + ", " + std::string{work.method.name()} +
          (record.options.arithmetic == Arithmetic::floats
               ? ""
               : " " + std::string{arithmetic_name(record.options.arithmetic)}) +
          setting_of(record) + "\n";
  text += run_text(record.options, work);
  if (record.peer) {
    const BenchPeer& peer = *record.peer;
    text += "against " + peer.renderer + ": the pictures " +
            (peer.equal ? "are equal to the bit" : "differ") +
            (peer.difference.empty() ? "" : "; " + peer.difference) + "\n";
    if (!peer.shaders.empty()) text += shaders_text(peer) + "\n";
  }
  return text;
}

// "ours 61.5 frames a second rendering to textures, 55.2 copying: 11 % more [9, 13]"
std::string copies_text(const std::string& who, const std::vector<StageSamples>& stages) {
  const StageSamples *frame = nullptr, *copied = nullptr;
  for (const StageSamples& stage : stages) {
    if (stage.name == "frame") frame = &stage;
    if (stage.name == "copied") copied = &stage;
  }
  if (frame == nullptr || copied == nullptr) return "";
  const Spread ratio = spread_of(pair_ratios(frame->ms, copied->ms));
  const auto rate = [](const StageSamples& stage) {
    return milliseconds_text(1000.0 / spread_of(stage.ms).median);
  };
  const auto percent = [](double times) { return short_number(std::round(100.0 * (times - 1.0))); };
  return who + ": " + rate(*frame) + " frames a second rendering to textures, " + rate(*copied) +
         " copying into them: " + percent(ratio.median) + " % more [" + percent(ratio.min) + ", " +
         percent(ratio.max) + "]\n";
}

constexpr double kSixtiethMs = 1000.0 / 60.0;

double kept_by_99_of_100(std::vector<double> frames_ms) {
  std::sort(frames_ms.begin(), frames_ms.end());
  return frames_ms[(frames_ms.size() * 99 + 99) / 100 - 1];
}

std::size_t within_a_sixtieth(const std::vector<double>& frames_ms) {
  return static_cast<std::size_t>(std::count_if(frames_ms.begin(), frames_ms.end(),
                                                [](double ms) { return ms <= kSixtiethMs; }));
}

// "600 frames 12.31 [11.02, 15.20] ms, 99 of 100 within 14.02 ms: 71.33 frames a second; 598 within
// a 60th of a second"
std::string frames_text(const std::vector<double>& frames_ms) {
  if (frames_ms.empty()) return "";
  const double kept_ms = kept_by_99_of_100(frames_ms);
  return count_text(static_cast<int>(frames_ms.size()), "frame") + ' ' +
         spread_text(spread_of(frames_ms)) + " ms, 99 of 100 within " + milliseconds_text(kept_ms) +
         " ms: " + milliseconds_text(1000.0 / kept_ms) + " frames a second; " +
         std::to_string(within_a_sixtieth(frames_ms)) + " within a 60th of a second\n";
}

Json frames_json(const std::vector<double>& frames_ms) {
  if (frames_ms.empty()) return nullptr;
  const Spread ms = spread_of(frames_ms);
  return {{"count", static_cast<int>(frames_ms.size())},
          {"median_ms", ms.median},
          {"min_ms", ms.min},
          {"max_ms", ms.max},
          {"percentile_99_ms", kept_by_99_of_100(frames_ms)},
          {"within_a_60th", static_cast<int>(within_a_sixtieth(frames_ms))}};
}

Json stages_json(const std::vector<StageSamples>& stages) {
  auto list = Json::array();
  for (const StageSamples& stage : stages) {
    const Spread ms = spread_of(stage.ms);
    list.push_back(
        {{"name", stage.name}, {"median_ms", ms.median}, {"min_ms", ms.min}, {"max_ms", ms.max}});
  }
  return list;
}

// One number for each stage, null for one that was not measured.
Json ratio_json(const BenchRecord& record, double Spread::*value) {
  Json json{{"raster", nullptr}, {"dof", nullptr}, {"frame", nullptr}};
  for (std::size_t i = 0; i < record.samples.ours.size(); ++i) {
    json[record.samples.ours[i].name] = ratio_of(record, i).*value;
  }
  return json;
}

}  // namespace

std::string spread_text(const Spread& spread, std::optional<int> places) {
  const auto text = [&](double value) {
    return places ? decimals(value, *places) : milliseconds_text(value);
  };
  return text(spread.median) + " [" + text(spread.min) + ", " + text(spread.max) + "]";
}

std::string padded(const std::string& text, std::size_t width) {
  return text + std::string(text.size() < width ? width - text.size() : 1, ' ');
}

std::string run_text(const BenchOptions& options, const BenchWork& work) {
  return "profile " + work.profile_name + ", " + count_text(options.pool.threads, "thread") + ", " +
         std::string{isa_name(options.pool.isa)} + ", " + std::to_string(options.runs) + " runs, " +
         cpu_name().value_or("a CPU without a name") + "\n";
}

Json run_json(const BenchOptions& options, const BenchWork& work) {
  Json json{{"softfocus", SOFTFOCUS_VERSION},
            {"scene", work.name},
            {"size", size_text(work.size)},
            {"multisample", work.samples},
            {"profile", work.profile_name},
            {"threads", options.pool.threads},
            {"isa", isa_name(options.pool.isa)},
            {"runs", options.runs},
            {"cpu", nullptr},
            {"compiler", compiler_name()},
            {"peer", nullptr}};
  if (const auto cpu = cpu_name()) json["cpu"] = *cpu;
  return json;
}

std::string bench_text(const BenchRecord& record) {
  constexpr std::size_t kStageWidth = 8, kTimesWidth = 30;
  std::string text = heading(record) + "\n" + padded("stage", kStageWidth);
  if (!record.peer) {
    text += "ms [min, max]\n";
    for (const StageSamples& ours : record.samples.ours) {
      text += padded(ours.name, kStageWidth) + times_text(ours) + "\n";
    }
    return text + copies_text("ours", record.samples.ours) + frames_text(record.frames_ms);
  }
  const std::string& driver = record.peer->driver;
  text += padded("ours, ms [min, max]", kTimesWidth) +
          padded(driver + ", ms [min, max]", kTimesWidth) + driver + " / ours [min, max]\n";
  for (std::size_t i = 0; i < record.samples.ours.size(); ++i) {
    const StageSamples& ours = record.samples.ours[i];
    const Spread ratio = ratio_of(record, i);
    text += padded(ours.name, kStageWidth) + padded(times_text(ours), kTimesWidth) +
            padded(times_text(record.samples.peers[i]), kTimesWidth) + spread_text(ratio, 2) + "\n";
  }
  return text + copies_text("ours", record.samples.ours) +
         copies_text(driver, record.samples.peers) + frames_text(record.frames_ms);
}

std::string bench_json(const BenchRecord& record) {
  const BenchWork& work = record.work;
  Json json = run_json(record.options, work);
  json["method"] = work.method.name();
  json["arithmetic"] = arithmetic_name(record.options.arithmetic);
  json["stages"] = stages_json(record.samples.ours);
  json["frames"] = frames_json(record.frames_ms);
  for (const char* name : {"triangles", "max_coc", "samples", "chosen", "ratio", "ratio_min",
                           "ratio_max", "equal", "difference"}) {
    json[name] = nullptr;
  }
  if (work.method.filter != nullptr) json["max_coc"] = work.settings.max_coc_px;
  if (record.samples_taken > 0) json["samples"] = record.samples_taken;
  if (record.choice) json["chosen"] = setting_text(*record.choice);
  if (work.scene) json["triangles"] = triangle_count(*work.scene);
  if (record.peer) {
    json["peer"] = {{"driver", record.peer->driver},
                    {"renderer", record.peer->renderer},
                    {"shader", nullptr},
                    {"shaders", Json::array()},
                    {"stages", stages_json(record.samples.peers)}};
    for (const BenchPeer::ShaderForm& form : record.peer->shaders) {
      json["peer"]["shaders"].push_back({{"name", form.name}, {"dof_median_ms", form.filter_ms}});
    }
    if (!record.peer->shader.empty()) json["peer"]["shader"] = record.peer->shader;
    json["ratio"] = ratio_json(record, &Spread::median);
    json["ratio_min"] = ratio_json(record, &Spread::min);
    json["ratio_max"] = ratio_json(record, &Spread::max);
    json["equal"] = record.peer->equal;
    if (!record.peer->difference.empty()) json["difference"] = record.peer->difference;
  }
  // Neither a driver's words nor a file's name need be UTF-8, but JSON must be.
  return json_text(json, 2) + "\n";
}

}  // namespace softfocus
