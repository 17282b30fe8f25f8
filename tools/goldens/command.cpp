// softfocus golden: pictures that have to stay as they are, checked, accepted and added.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "raster/numbers/hash.h"
#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/cli/progress.h"
#include "tools/files/hash_text.h"
#include "tools/files/whole_file.h"
#include "tools/goldens/report.h"
#include "tools/report/kept_results.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

struct GoldenOptions {
  std::string action;
  std::string folder;
  std::vector<std::string> names;
  std::filesystem::path report;
  int jobs = hardware_threads();
  bool all = false;
  bool resumes = false;
  bool json = false;
  bool quiet = false;
};

std::filesystem::path manifest_of(const GoldenOptions& options) {
  return std::filesystem::path{options.folder} / kManifestName;
}

GoldenPlaces places_of(const GoldenOptions& options) {
  GoldenPlaces places{options.folder, options.report.empty()
                                          ? std::filesystem::path{options.folder} / "report"
                                          : options.report};
  if (is_same_file(places.report, places.manifest)) {
    throw UsageError("-o '" + places.report.string() +
                     "' is the goldens' own folder; another would be right");
  }
  return places;
}

// What is made there goes away again: nothing of the user's may be in it.
void check_places(const std::vector<Golden>& goldens, const GoldenPlaces& places) {
  const auto whole = [](const std::filesystem::path& file) {
    return std::filesystem::weakly_canonical(file).string() + "/";
  };
  const std::string report = whole(places.report);
  for (const Golden& golden : goldens) {
    for (const std::string& file :
         {golden.picture.value_or(""), golden.input, golden.shader, golden.pipeline}) {
      if (file.empty() || !whole(places.manifest / file).starts_with(report)) continue;
      throw UsageError("golden '" + golden.name + "': '" + file + "' lies in '" +
                       places.report.string() + "', where checks write; elsewhere would be right");
    }
  }
}

// One check or accept at a time writes there.
class ReportLock {
 public:
  explicit ReportLock(const GoldenPlaces& places) : file_(places.report / "lock") {
    make_directory(places.made());
    descriptor_ = open_existing(file_);
    if (descriptor_ < 0) descriptor_ = create_file(file_);
    if (descriptor_ < 0 || is_in_use(file_)) {
      throw UsageError("'" + places.report.string() +
                       "': another golden command writes there, or it cannot be written to");
    }
    mark_in_use(descriptor_);
  }
  ~ReportLock() {
    close_file(descriptor_);
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }
  ReportLock(const ReportLock&) = delete;
  ReportLock& operator=(const ReportLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

// Nothing, of a manifest that add has yet to make.
std::string manifest_text(const GoldenOptions& options) {
  std::error_code ignored;
  if (options.action == "add" && !std::filesystem::exists(manifest_of(options), ignored)) return "";
  return read_file_text(manifest_of(options), kMostManifestBytes);
}

std::vector<Golden> all_goldens(const GoldenOptions& options) {
  return parse_goldens(manifest_text(options), manifest_of(options));
}

std::vector<Golden> wanted_goldens(const GoldenOptions& options) {
  std::vector<Golden> all = all_goldens(options);
  if (options.names.empty()) return all;
  std::vector<Golden> wanted;
  for (const std::string& name : options.names) {
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const Golden& golden) { return golden.name == name; });
    if (found == all.end()) {
      std::vector<std::string> names;
      names.reserve(all.size());
      for (const Golden& golden : all) names.push_back(golden.name);
      throw UsageError("'" + manifest_of(options).string() + "' has no golden '" + name + "'" +
                       did_you_mean(name, names));
    }
    if (std::find(wanted.begin(), wanted.end(), *found) == wanted.end()) wanted.push_back(*found);
  }
  return wanted;
}

// --- a check that goes on where it was interrupted ---

constexpr const char* kUnfinished = "unfinished.jsonl";

// How a file was: its size and when it was written.
void add_state(Hash& hash, const std::filesystem::path& file) {
  std::error_code error;
  add_text(hash, file.string());
  add_number(hash, static_cast<double>(std::filesystem::file_size(file, error)));
  const auto written = std::filesystem::last_write_time(file, error).time_since_epoch();
  add_text(hash, std::to_string(static_cast<std::int64_t>(written.count())));
}

// Of all that is known to make a golden what it is. What a scene or a command reads is not.
std::string key_of(const Golden& golden, const GoldenPlaces& places) {
  Hash hash;
  add_text(hash, std::filesystem::absolute(places.manifest).string());
  add_state(hash, places.manifest / kManifestName);
  add_text(hash, golden.name);
  for (const std::string& file :
       {golden.picture.value_or(""), golden.input, golden.shader, golden.pipeline, golden.scene}) {
    if (!file.empty()) add_state(hash, places.manifest / file);
  }
  if (const std::optional<std::filesystem::path> own = own_program()) add_state(hash, *own);
  return hash_text(hash.value);
}

// What passed before the interruption, by key: its hash.
std::map<std::string, std::string> passed_before(const std::filesystem::path& file) {
  std::map<std::string, std::string> passed;
  std::ifstream lines{file};
  for (std::string line; std::getline(lines, line);) {
    const std::optional<Json> json = parse_json(line);
    if (!json || !json->is_object()) continue;
    const Json *key = json->find("key"), *hash = json->find("hash");
    if (key == nullptr || hash == nullptr || !key->is_text() || !hash->is_text()) continue;
    passed[key->text()] = hash->text();
  }
  return passed;
}

std::vector<GoldenResult> check_all(const std::vector<Golden>& goldens, const GoldenPlaces& places,
                                    const GoldenOptions& options) {
  const std::filesystem::path unfinished = places.report / kUnfinished;
  const std::map<std::string, std::string> before =
      options.resumes ? passed_before(unfinished) : std::map<std::string, std::string>{};
  std::ofstream notes{unfinished, options.resumes ? std::ios::app : std::ios::trunc};
  std::vector<GoldenResult> results(goldens.size());
  Progress progress{options.quiet};
  std::mutex mutex;
  std::size_t done = 0;
  ThreadPool pool{options.jobs};
  pool.for_each(static_cast<int>(goldens.size()), [&](int i) {
    const Golden& golden = goldens[static_cast<std::size_t>(i)];
    GoldenResult& result = results[static_cast<std::size_t>(i)];
    const std::string key = key_of(golden, places);
    const auto kept = before.find(key);
    if (kept != before.end()) {
      result = {.verdict = Verdict::passes, .why = "", .hash = kept->second};
    } else {
      result = check_golden(golden, places);
    }
    const std::lock_guard lock{mutex};
    progress.show("golden " + std::to_string(++done) + " of " + std::to_string(goldens.size()));
    if (result.verdict == Verdict::passes && kept == before.end()) {
      notes << json_text(Json{{"key", key}, {"hash", result.hash}}) << std::endl;
    }
  });
  return results;
}

// --- actions ---

std::string accept_command(const GoldenOptions& options) {
  std::vector<std::string> words{"softfocus", "golden", "accept", options.folder};
  if (!options.report.empty()) words.insert(words.end(), {"-o", options.report.string()});
  return command_text(words);
}

void print_check(const GoldensChecked& checked, const GoldenPlaces& places) {
  std::vector<std::string> to_accept;
  std::size_t passing = 0;
  for (std::size_t i = 0; i < checked.results.size(); ++i) {
    const GoldenResult& result = checked.results[i];
    const std::string& name = checked.goldens[i].name;
    if (result.verdict == Verdict::passes) {
      ++passing;
      continue;
    }
    std::cout << (result.verdict == Verdict::breaks   ? "BREAKS "
                  : result.verdict == Verdict::is_new ? "NEW "
                                                      : "FAILS ")
              << name << ": " << result.why << '\n';
    if (result.verdict != Verdict::breaks) to_accept.push_back(name);
  }
  std::cout << passing << " of " << checked.results.size() << " goldens pass, in "
            << short_number(checked.seconds) << " s\n";
  if (passing == checked.results.size()) return;
  std::cout << "to go on: " << (places.report / "index.html").string() << " shows them";
  if (!to_accept.empty()) {
    constexpr std::size_t kMostNamed = 8;
    std::string names;
    for (const std::string& name : to_accept) names += " " + name;
    if (to_accept.size() > kMostNamed) names = " --all";
    std::cout << "; " << checked.accept << names << " takes the new pictures";
  }
  std::cout << '\n';
}

int check(const GoldenOptions& options) {
  const GoldenPlaces places = places_of(options);
  GoldensChecked checked{options.folder, accept_command(options), wanted_goldens(options), {}};
  if (checked.goldens.empty()) {
    throw UsageError("'" + manifest_of(options).string() +
                     "' has no [[golden]]; softfocus golden add makes one");
  }
  const std::vector<Golden> all = all_goldens(options);
  check_places(all, places);
  const ReportLock lock{places};
  std::error_code ignored;
  // What an earlier check has left is no longer what is shown.
  for (const Golden& golden : all) remove_made(golden, places);
  for (const char* file : {"index.html", "results.json", "junit.xml"}) {
    check_writable(places.report / file);
  }
  const auto start = std::chrono::steady_clock::now();
  checked.results = check_all(checked.goldens, places, options);
  checked.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  write_text(places.report / "index.html", goldens_page(checked));
  const Json json = goldens_json(checked, false);
  write_json(places.report / "results.json", json);
  write_text(places.report / "junit.xml", junit_xml(checked));
  std::filesystem::remove(places.report / kUnfinished, ignored);
  if (options.json) {
    std::cout << json_text(json, 2) << '\n';
  } else {
    print_check(checked, places);
  }
  const bool all_pass =
      std::all_of(checked.results.begin(), checked.results.end(),
                  [](const GoldenResult& result) { return result.verdict == Verdict::passes; });
  return all_pass ? kDone : kFailed;
}

void write_bytes(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  WholeFile whole{file};
  whole.write(bytes);
  whole.commit();
}

// Takes a picture that was made as what is expected from now on.
void take(Golden& golden, const GoldenOptions& options, const GoldenPlaces& places) {
  const std::filesystem::path made = made_file(golden, places);
  const Image image = read_image_file(made).image;
  if (golden.hash || !golden.picture) {
    const std::string hash = hash_text(hash_image(image));
    if (golden.hash && *golden.hash != hash) {
      golden.was.insert(golden.was.begin(), *golden.hash);
      if (golden.was.size() > kMostHashesKept) golden.was.resize(kMostHashesKept);
    }
    golden.hash = hash;
  }
  const std::string text = with_golden(manifest_text(options), golden, manifest_of(options));
  check_writable(manifest_of(options));
  if (golden.picture) {
    const std::filesystem::path file = places.manifest / *golden.picture;
    if (!file.parent_path().empty()) make_directory(file.parent_path());
    // A program's own file as it is; of ours, what its ending holds.
    write_bytes(file, made.extension() == file.extension()
                          ? read_picture_bytes(made)
                          : encode(image, *format_by_extension(file)));
  }
  write_text(manifest_of(options), text);
  remove_made(golden, places);
}

void make_or_throw(const Golden& golden, const GoldenPlaces& places) {
  if (const std::optional<std::string> why = make_golden(golden, places)) {
    throw FileError("golden '" + golden.name + "': " + *why);
  }
}

int accept(const GoldenOptions& options) {
  if (options.names.empty() && !options.all) {
    throw UsageError("accept: give names, or --all for all that the last check has left");
  }
  const GoldenPlaces places = places_of(options);
  std::vector<Golden> goldens = wanted_goldens(options);
  check_places(all_goldens(options), places);
  const ReportLock lock{places};
  std::error_code ignored;
  const auto told = std::filesystem::last_write_time(manifest_of(options), ignored);
  const auto is_there = [&](const Golden& golden) {
    return std::filesystem::is_regular_file(made_file(golden, places), ignored);
  };
  if (options.all) {
    std::erase_if(goldens, [&](const Golden& golden) { return !is_there(golden); });
  }
  for (Golden& golden : goldens) {
    // A program's picture is the one that was shown, unless the manifest is newer. Ours are made
    // again, as their files may have changed.
    const bool is_shown =
        has_out(golden) && is_there(golden) &&
        std::filesystem::last_write_time(made_file(golden, places), ignored) >= told;
    if (!is_shown) make_or_throw(golden, places);
    take(golden, options, places);
    std::cout << golden.name << ": accepted" << (golden.hash ? ", " + *golden.hash : "") << '\n';
  }
  if (goldens.empty()) std::cout << "there is nothing to accept\n";
  return kDone;
}

// A golden of what is typed: softfocus's own command, or another program's.
std::string typed_command(std::vector<std::string> words) {
  // Behind -- parse() takes them for files.
  for (std::string& word : words) {
    if (word.starts_with("./-")) word.erase(0, 2);
  }
  const bool is_own = std::none_of(words.begin(), words.end(), [](const std::string& word) {
    return word.find(kOut) != std::string::npos;
  });
  std::string text = is_own && words[0] != "softfocus" ? "softfocus" : "";
  for (const std::string& word : words) {
    text += text.empty() ? "" : " ";
    // The file's name comes in quotes of its own.
    const std::size_t out = std::min(word.find(kOut), word.size());
    if (out > 0 || word.empty()) text += command_text({word.substr(0, out)});
    if (out == word.size()) continue;
    text += kOut;
    const std::string after = word.substr(out + kOut.size());
    if (!after.empty()) text += command_text({after});
  }
  return text;
}

int add(const GoldenOptions& options) {
  if (options.names.size() < 2) {
    throw UsageError(
        "add: give a name, --, and what makes the picture: softfocus golden add DIR NAME -- render "
        "SCENE --size 256x256, or a program with {out} for its file");
  }
  Golden golden;
  golden.name = options.names[0];
  golden.command = typed_command({options.names.begin() + 1, options.names.end()});
  golden.picture = golden.name + ".png";
  const std::filesystem::path manifest = manifest_of(options);
  std::vector<Golden> goldens = all_goldens(options);
  for (const Golden& other : goldens) {
    if (other.name != golden.name) continue;
    throw UsageError("'" + manifest.string() + "' has a golden '" + golden.name +
                     "'; softfocus golden accept takes its new picture");
  }
  with_golden(manifest_text(options), golden, manifest);  // says what is wrong with the name
  const GoldenPlaces places = places_of(options);
  goldens.push_back(golden);
  check_places(goldens, places);
  make_directory(options.folder);
  const ReportLock lock{places};
  make_or_throw(golden, places);
  golden.hash = hash_text(hash_image(read_image_file(made_file(golden, places)).image));
  take(golden, options, places);
  std::cout << golden.name << ": added, " << *golden.hash << '\n';
  return kDone;
}

struct GoldenAction {
  std::string_view name;
  int (*work)(const GoldenOptions&);
};
constexpr std::array kGoldenActions{GoldenAction{"check", check}, GoldenAction{"accept", accept},
                                    GoldenAction{"add", add}};

int run_golden(const GoldenOptions& options) {
  for (const GoldenAction& action : kGoldenActions) {
    if (action.name != options.action) continue;
    if (action.work != check && options.resumes) {
      throw UsageError("--resume: only golden check reads it");
    }
    if (action.work != accept && options.all) {
      throw UsageError("--all: only golden accept reads it");
    }
    return action.work(options);
  }
  refuse_name("ACTION", options.action, names_in(kGoldenActions));
}

}  // namespace

Command add_golden_command(CLI::App& program) {
  CLI::App* parser = add_command(
      program, "golden",
      "Check pictures that have to stay as they are; status 0 all pass, 1 some do not, 2 error");
  const auto options = std::make_shared<GoldenOptions>();
  add_argument(
      *parser, "ACTION",
      "check: make all, and hold them against what is expected; accept: take new pictures; add: a "
      "new golden",
      options->action);
  offer(*parser, "ACTION", [] { return names_in(kGoldenActions); });
  add_argument(*parser, "DIR", "The folder of goldens.toml (docs/goldens.md)", options->folder);
  add_optional_arguments(*parser, "NAME",
                         "Only these goldens; of add the new one's name, and behind -- its command",
                         options->names);
  begin_group(*parser, "Run");
  add_value(*parser, "-o,--output", "FOLDER",
            "Where the page, JSON, JUnit's XML and new pictures go (default: DIR/report)",
            [options](const std::string& text) { options->report = text; });
  add_value(*parser, "--jobs", "N", "Goldens at a time (1 to 256; default: all processors)",
            [options](const std::string& text) {
              options->jobs = parse_whole("--jobs", text, 1, 256, "goldens at a time");
            });
  add_flag(
      *parser, "--resume",
      "check: go on where one was interrupted; files that scenes and commands read must be the "
      "same",
      options->resumes);
  add_flag(*parser, "--all", "accept: all pictures that the last check has left", options->all);
  add_flag(*parser, "--json", "check: print JSON", options->json);
  add_flag(*parser, "--quiet", "No line of progress", options->quiet);
  return {parser, [options] { return run_golden(*options); }};
}

}  // namespace softfocus
