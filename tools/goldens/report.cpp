#include "tools/goldens/report.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "scenes/files/scene_error.h"
#include "tools/report/report.h"

namespace softfocus {

/// tools/goldens/goldens.html with its style sheet and script; the build makes it.
extern const std::string_view kGoldensTemplate;

namespace {

constexpr std::array<std::string_view, 4> kVerdicts{"passes", "fails", "new", "breaks"};

std::string_view name_of(Verdict verdict) { return kVerdicts[static_cast<std::size_t>(verdict)]; }

std::int64_t count_of(const GoldensChecked& checked, Verdict verdict) {
  return std::count_if(checked.results.begin(), checked.results.end(),
                       [&](const GoldenResult& result) { return result.verdict == verdict; });
}

std::string in_xml(std::string_view text) {
  std::string result;
  for (const char c : printable(text)) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string seconds_text(double seconds) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3f", seconds);
  return text.data();
}

}  // namespace

Json goldens_json(const GoldensChecked& checked, bool with_pictures) {
  Json json{{"folder", checked.folder}, {"seconds", checked.seconds}};
  for (std::size_t i = 0; i < kVerdicts.size(); ++i) {
    json[kVerdicts[i]] = count_of(checked, static_cast<Verdict>(i));
  }
  json["accept"] = checked.accept;
  json["goldens"] = Json::array();
  constexpr int kMostShown = 200;  // a browser has to hold them
  int shown = 0;
  for (std::size_t i = 0; i < checked.goldens.size(); ++i) {
    const Golden& golden = checked.goldens[i];
    const GoldenResult& result = checked.results[i];
    Json one{{"name", golden.name},
             {"made_by", maker_of(golden)},
             {"options", golden.options},
             {"verdict", name_of(result.verdict)},
             {"why", result.why},
             {"hash", result.hash},
             {"ms", result.ms}};
    if (golden.hash) one["expected_hash"] = *golden.hash;
    one["was"] = Json::array();
    for (const std::string& hash : golden.was) one["was"].push_back(hash);
    if (with_pictures && result.verdict != Verdict::passes && ++shown <= kMostShown) {
      const ShownPictures& pictures = result.shown;
      if (!pictures.got.empty()) one["got"] = pictures.got;
      if (!pictures.expected.empty()) one["expected"] = pictures.expected;
      if (!pictures.difference.empty()) one["difference"] = pictures.difference;
    }
    json["goldens"].push_back(std::move(one));
  }
  return json;
}

std::string goldens_page(const GoldensChecked& checked) {
  return page_with(kGoldensTemplate, goldens_json(checked, true));
}

std::string junit_xml(const GoldensChecked& checked) {
  const auto failures = count_of(checked, Verdict::fails) + count_of(checked, Verdict::is_new);
  const auto errors = count_of(checked, Verdict::breaks);
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"" +
                    in_xml(checked.folder) + "\" tests=\"" +
                    std::to_string(checked.results.size()) + "\" failures=\"" +
                    std::to_string(failures) + "\" errors=\"" + std::to_string(errors) +
                    "\" time=\"" + seconds_text(checked.seconds) + "\">\n";
  for (std::size_t i = 0; i < checked.results.size(); ++i) {
    const GoldenResult& result = checked.results[i];
    xml += "<testcase classname=\"goldens\" name=\"" + in_xml(checked.goldens[i].name) +
           "\" time=\"" + seconds_text(result.ms / 1e3) + "\"";
    if (result.verdict == Verdict::passes) {
      xml += "/>\n";
      continue;
    }
    const std::string kind = result.verdict == Verdict::breaks ? "error" : "failure";
    xml += "><" + kind + " message=\"" + in_xml(result.why) + "\"/></testcase>\n";
  }
  return xml + "</testsuite>\n</testsuites>\n";
}

}  // namespace softfocus
