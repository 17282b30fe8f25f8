#include "tools/goldens/check.h"

#include <chrono>
#include <fstream>
#include <system_error>
#include <utility>

#include "dof/measure/difference.h"
#include "dof/measure/measures.h"
#include "raster/images/image.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/files/hash_text.h"

namespace softfocus {
namespace {

std::string in_quotes(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      result += c;
    }
  }
  return result + "'";
}

std::string own_program_quoted() {
  const std::optional<std::filesystem::path> own = own_program();
  return own ? in_quotes(own->string()) : "softfocus";
}

// Goldens are made side by side: one thread each.
std::string with_one_thread(const std::string& words) {
  return words.find("--threads") == std::string::npos ? words + " --threads 1" : words;
}

bool has_threads(std::string_view words) {
  return words.starts_with("render ") || words.starts_with("apply ") ||
         words.starts_with("refocus ");
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::filesystem::path log_file(const Golden& golden, const GoldenPlaces& places) {
  return places.report / (golden.name + ".log");
}

// The last line that was said that has letters, and no more of it than fits on one.
std::string last_words(const std::filesystem::path& log) {
  std::ifstream file{log};
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (line.find_first_not_of(" \t\r") != line.npos) last = line;
  }
  constexpr std::size_t kMost = 400;
  return last.size() > kMost ? last.substr(0, kMost) + " ..." : last;
}

std::string size_of(const Image& image) { return size_text({image.width, image.height}); }

// Of two pictures of one size: the limits that are broken, or nothing if none is.
std::string broken_limits(const Golden& golden, const Image& made, const Image& expected,
                          const Difference& difference, double flip) {
  std::optional<std::uint64_t> beyond;
  const Tolerance& tolerance = golden.tolerance;
  if (counts_pixels(tolerance)) {
    beyond = pixels_beyond(
        made, expected,
        {tolerance.max_difference.value_or(0.0), false, tolerance.search_px.value_or(0)});
  }
  std::string broken;
  for (const LimitFinding& limit : check_limits(tolerance, difference, flip, beyond)) {
    if (!is_kept(limit)) broken += (broken.empty() ? "" : "; ") + limit_text(limit);
  }
  return broken;
}

void judge_by_picture(const Golden& golden, const GoldenPlaces& places, const Image& made,
                      GoldenResult& result) {
  const std::filesystem::path file = places.manifest / *golden.picture;
  Image expected = read_image_file(file).image;
  const Image own = as_file_has_it(made, format_by_extension(file).value_or(FileFormat::png));
  result.expected = expected;
  if (own.width != expected.width || own.height != expected.height) {
    result.verdict = Verdict::fails;
    result.why = "is " + size_of(own) + " pixels, expected are " + size_of(expected);
    return;
  }
  const Difference difference = compare_images(own, expected);
  ThreadPool one{1};
  const double flip = measure_pictures(expected, own, nullptr, {}, one).whole.flip;
  const bool has_tolerance = has_limits(golden.tolerance);
  const std::string broken =
      has_tolerance ? broken_limits(golden, own, expected, difference, flip) : "";
  if (has_tolerance ? broken.empty() : !golden.hash && difference.differing == 0) {
    result.verdict = Verdict::passes;
    return;
  }
  result.verdict = Verdict::fails;
  const std::uint64_t pixels = pixels_beyond(own, expected, {});
  result.why = broken + (broken.empty() ? "" : "; ");
  if (difference.differing == 0) {
    result.why += "its bits differ, its " + file.extension().string().substr(1) + " does not";
    return;
  }
  result.why += std::to_string(pixels) + " of " +
                std::to_string(std::uint64_t{1} * static_cast<std::uint64_t>(own.width) *
                               static_cast<std::uint64_t>(own.height)) +
                " pixels differ, by up to " + short_number(difference.max_error) +
                " of light, the first at " + std::to_string(difference.first_x) + "," +
                std::to_string(difference.first_y) + "; FLIP " + short_number(flip);
}

}  // namespace

Image as_file_has_it(const Image& picture, FileFormat format) {
  if (format == FileFormat::npy) return picture;
  return decode_picture(
             encode(picture, format),
             "picture." + std::string{format == FileFormat::exr || format == FileFormat::exr_float
                                          ? "exr"
                                      : format == FileFormat::hdr  ? "hdr"
                                      : format == FileFormat::pfm  ? "pfm"
                                      : format == FileFormat::tiff ? "tiff"
                                                                   : "png"})
      .image;
}

std::filesystem::path made_file(const Golden& golden, const GoldenPlaces& places) {
  std::string ending = ".npy";
  if (golden.command.find("{out}") != std::string::npos) {
    ending = golden.picture ? std::filesystem::path{*golden.picture}.extension().string() : ".png";
  }
  return places.report / (golden.name + ending);
}

void remove_made(const Golden& golden, const GoldenPlaces& places) {
  const std::filesystem::path made = made_file(golden, places);
  std::error_code ignored;
  std::filesystem::remove(made, ignored);
  std::filesystem::remove(made.string() + ".json", ignored);
}

std::string shell_command(const Golden& golden, const GoldenPlaces& places) {
  const std::string out = in_quotes(std::filesystem::absolute(made_file(golden, places)).string());
  if (golden.command.empty()) {
    const std::string words = with_one_thread(golden.options.empty() ? "" : " " + golden.options);
    std::string what = " render " + in_quotes(golden.scene);
    if (!golden.pipeline.empty()) {
      what = " apply " + in_quotes(golden.input) + " --pipeline " + in_quotes(golden.pipeline);
    } else if (!golden.shader.empty()) {
      what = " apply " + in_quotes(golden.input) + " --shader " + in_quotes(golden.shader);
    }
    return own_program_quoted() + what + words + " -o " + out;
  }
  std::string command = golden.command;
  constexpr std::string_view kOwn = "softfocus ";
  if (command.starts_with(kOwn)) {
    const std::string words = command.substr(kOwn.size());
    command = own_program_quoted() + " " + (has_threads(words) ? with_one_thread(words) : words);
  }
  if (command.find("{out}") == std::string::npos) return command + " -o " + out;
  // The name comes in quotes of its own.
  for (const char* quoted : {"'{out}'", "\"{out}\""}) command = replaced(command, quoted, "{out}");
  return replaced(command, "{out}", out);
}

std::optional<std::string> make_golden(const Golden& golden, const GoldenPlaces& places) {
  const std::filesystem::path made = made_file(golden, places), log = log_file(golden, places);
  std::error_code ignored;
  remove_made(golden, places);
  const std::string text = "cd " + in_quotes(std::filesystem::absolute(places.manifest).string()) +
                           " && { " + shell_command(golden, places) + "\n} >" +
                           in_quotes(std::filesystem::absolute(log).string()) + " 2>&1 </dev/null";
  const std::optional<int> status = run_quietly("/bin/sh", {"-c", text});
  const std::string words = last_words(log);
  const bool is_there = std::filesystem::is_regular_file(made, ignored);
  if (status == 0 && is_there) {
    std::filesystem::remove(log, ignored);
    return {};
  }
  const std::string said = words.empty() ? "" : ": " + words;
  if (!status) return "its command was ended or could not be run" + said;
  if (*status != 0) return "its command ends with status " + std::to_string(*status) + said;
  return "its command writes no file at {out}" + said;
}

void judge(const Golden& golden, const GoldenPlaces& places, Image made, GoldenResult& result) {
  result.hash = hash_text(hash_image(made));
  if (golden.hash && *golden.hash == result.hash) {
    result.verdict = Verdict::passes;
    return;
  }
  std::error_code ignored;
  const bool has_picture =
      golden.picture && std::filesystem::exists(places.manifest / *golden.picture, ignored);
  if (!golden.hash && !has_picture) {
    result.verdict = Verdict::is_new;
    result.why = "is new: nothing is expected of it yet";
  } else if (has_picture) {
    judge_by_picture(golden, places, made, result);
  } else {
    result.verdict = Verdict::fails;
    result.why = "its hash is " + result.hash + ", expected is " + *golden.hash +
                 "; no picture is kept that would show where";
  }
  if (result.verdict != Verdict::passes) result.got = std::move(made);
}

GoldenResult check_golden(const Golden& golden, const GoldenPlaces& places) {
  GoldenResult result;
  const auto start = std::chrono::steady_clock::now();
  try {
    if (const std::optional<std::string> why = make_golden(golden, places)) {
      result.why = *why;
    } else {
      judge(golden, places, read_image_file(made_file(golden, places)).image, result);
    }
  } catch (const std::exception& error) {
    result.verdict = Verdict::breaks;
    result.why = error.what();
  }
  result.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (result.verdict == Verdict::passes) remove_made(golden, places);
  return result;
}

}  // namespace softfocus
