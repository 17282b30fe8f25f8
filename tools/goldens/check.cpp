#include "tools/goldens/check.h"

#include <chrono>
#include <fstream>
#include <system_error>
#include <utility>

#include "dof/measure/difference.h"
#include "dof/measure/heat_map.h"
#include "dof/measure/measures.h"
#include "raster/images/image.h"
#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"
#include "tools/files/base64.h"
#include "tools/files/hash_text.h"
#include "tools/report/report.h"

namespace softfocus {
namespace {

// As one word of a shell's.
std::string in_quotes(const std::string& text) { return command_text({text}); }

std::string own_program_quoted() {
  const std::optional<std::filesystem::path> own = own_program();
  return own ? in_quotes(own->string()) : "softfocus";
}

// Goldens are made side by side: one thread each, of commands that have any.
std::string with_one_thread(const std::string& words) {
  if (words.find("--threads") != std::string::npos) return words;
  for (const std::string_view name : {"render ", "apply ", "refocus "}) {
    if (words.starts_with(name))
      return std::string{name} + "--threads 1 " + words.substr(name.size());
  }
  return words;
}

std::string replaced(std::string text, std::string_view what, const std::string& by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::filesystem::path log_file(const Golden& golden, const GoldenPlaces& places) {
  return places.made() / (golden.name + ".log");
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

std::string png_of(const Image& image) { return base64(encode(image, FileFormat::png)); }

// As a file of that ending has it: what a PNG cuts and rounds is cut and rounded.
Picture as_file_has_it(const Image& picture, const std::filesystem::path& file) {
  const FileFormat format = format_by_extension(file).value_or(FileFormat::npy);
  return decode_picture(encode(picture, format), file);
}

// Of two pictures of one size: the limits that are broken, or nothing if none is.
std::string broken_limits(const Golden& golden, const Image& made, const Image& expected,
                          bool has_opacity, const Difference& difference, double flip) {
  std::optional<std::uint64_t> beyond;
  const Tolerance& tolerance = golden.tolerance;
  if (counts_pixels(tolerance)) {
    beyond = pixels_beyond(
        made, expected,
        {tolerance.max_difference.value_or(0.0), has_opacity, tolerance.search_px.value_or(0)});
  }
  std::string broken;
  for (const LimitFinding& limit : check_limits(tolerance, difference, flip, beyond)) {
    if (!is_kept(limit)) broken += (broken.empty() ? "" : "; ") + limit_text(limit);
  }
  return broken;
}

void judge_by_picture(const Golden& golden, const GoldenPlaces& places, Picture own,
                      GoldenResult& result) {
  const std::filesystem::path file = places.manifest / *golden.picture;
  Picture expected = read_image_file(file);
  if (made_file(golden, places).extension() != file.extension()) {
    own = as_file_has_it(own.image, file);
  }
  // As compare has it: what one of them alone has, an alpha, cannot differ.
  const bool with_alpha = own.has_alpha && expected.has_alpha;
  if (!with_alpha) {
    clear_alpha(own.image);
    clear_alpha(expected.image);
  }
  const Image &got = own.image, &right = expected.image;
  result.verdict = Verdict::fails;
  if (got.width != right.width || got.height != right.height) {
    result.why = "is " + size_of(got) + " pixels, expected are " + size_of(right);
    result.shown.expected = png_of(right);
    return;
  }
  const Difference difference = compare_images(got, right);
  ThreadPool one{1};
  const MeasuredPictures measured = measure_pictures(right, got, nullptr, {}, one);
  const double flip = measured.whole.flip;
  const bool has_opacity = with_alpha && file.extension() == ".png";
  const bool has_tolerance = has_limits(golden.tolerance);
  const std::string broken =
      has_tolerance ? broken_limits(golden, got, right, has_opacity, difference, flip) : "";
  if (has_tolerance ? broken.empty() : !golden.hash && difference.differing == 0) {
    result.verdict = Verdict::passes;
    return;
  }
  result.shown.expected = png_of(right);
  result.shown.difference = png_of(heat_picture(measured.flip));
  result.why = broken + (broken.empty() ? "" : "; ");
  if (difference.differing == 0) {
    result.why += "its bits differ, its " + file.extension().string().substr(1) + " does not";
    return;
  }
  const auto all = static_cast<std::uint64_t>(got.width) * static_cast<std::uint64_t>(got.height);
  result.why += std::to_string(pixels_beyond(got, right, {0.0, with_alpha, 0})) + " of " +
                std::to_string(all) + " pixels differ, by up to " +
                short_number(difference.max_error) + " of light, the first at " +
                std::to_string(difference.first_x) + "," + std::to_string(difference.first_y) +
                "; FLIP " + short_number(flip);
}

void judge(const Golden& golden, const GoldenPlaces& places, const Picture& made,
           GoldenResult& result) {
  result.hash = hash_text(hash_image(made.image));
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
  if (result.verdict != Verdict::passes) result.shown.got = png_of(made.image);
}

// A file's name as a shell takes it. Within the manifest's folder it is relative, so that there are
// no blanks and signs in it but the user's.
std::string shell_name(const std::filesystem::path& file, const GoldenPlaces& places) {
  const std::filesystem::path whole = std::filesystem::absolute(file).lexically_normal();
  const std::filesystem::path from =
      std::filesystem::absolute(places.manifest / "").lexically_normal();
  const std::string near = whole.lexically_relative(from).string();
  return in_quotes(near.empty() || near.starts_with("..") ? whole.string() : near);
}

}  // namespace

std::filesystem::path made_file(const Golden& golden, const GoldenPlaces& places) {
  std::string ending = ".npy";
  if (has_out(golden)) {
    ending = golden.picture ? std::filesystem::path{*golden.picture}.extension().string() : ".png";
  }
  return places.made() / (golden.name + ending);
}

void remove_made(const Golden& golden, const GoldenPlaces& places) {
  const std::filesystem::path made = made_file(golden, places);
  std::error_code ignored;
  std::filesystem::remove(made, ignored);
  std::filesystem::remove(made.string() + ".json", ignored);
}

std::string shell_command(const Golden& golden, const GoldenPlaces& places) {
  const std::string out = shell_name(made_file(golden, places), places);
  if (golden.command.empty()) {
    std::string words = "render " + in_quotes(golden.scene);
    if (!golden.pipeline.empty()) {
      words = "apply " + in_quotes(golden.input) + " --pipeline " + in_quotes(golden.pipeline);
    } else if (!golden.shader.empty()) {
      words = "apply " + in_quotes(golden.input) + " --shader " + in_quotes(golden.shader);
    }
    if (!golden.options.empty()) words += " " + golden.options;
    return own_program_quoted() + " " + with_one_thread(words) + " -o " + out;
  }
  std::string command = golden.command;
  constexpr std::string_view kOwn = "softfocus ";
  if (command.starts_with(kOwn)) {
    command = own_program_quoted() + " " + with_one_thread(command.substr(kOwn.size()));
  }
  return has_out(golden) ? replaced(command, kOut, out) : command + " -o " + out;
}

std::optional<std::string> make_golden(const Golden& golden, const GoldenPlaces& places) {
  const std::filesystem::path made = made_file(golden, places), log = log_file(golden, places);
  std::error_code ignored;
  remove_made(golden, places);
  std::filesystem::remove(log, ignored);
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
  remove_made(golden, places);
  const std::string said = words.empty() ? "" : ": " + words;
  const std::string command = "its command, run in '" + places.manifest.string() + "', ";
  if (!status) return command + "was ended or could not be run" + said;
  if (*status != 0) return command + "ends with status " + std::to_string(*status) + said;
  return command + "writes no file at " + std::string{kOut} + said;
}

GoldenResult check_golden(const Golden& golden, const GoldenPlaces& places) {
  GoldenResult result;
  const auto start = std::chrono::steady_clock::now();
  try {
    if (const std::optional<std::string> why = make_golden(golden, places)) {
      result.why = *why;
    } else {
      judge(golden, places, read_image_file(made_file(golden, places)), result);
    }
  } catch (const std::exception& error) {
    result.verdict = Verdict::breaks;
    result.why = error.what();
  }
  result.why = printable(result.why);
  result.ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (result.verdict == Verdict::passes) remove_made(golden, places);
  return result;
}

}  // namespace softfocus
