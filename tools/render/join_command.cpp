// softfocus join: the sums that render --shard wrote become the picture.

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/platform.h"
#include "tools/cli/progress.h"
#include "tools/files/whole_file.h"
#include "tools/options/run_options.h"
#include "tools/pictures/sums_file.h"
#include "tools/render/picture_files.h"

namespace softfocus {
namespace {

struct JoinOptions {
  std::vector<std::string> parts;
  RenderOptions picture;  ///< of it, the output and its format
  bool check = false;
  bool quiet = false;
};

std::string in_quotes(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

/// "2, 5, 6" as far as a line can take.
std::string list_of(const std::vector<int>& numbers) {
  constexpr std::size_t kMost = 10;
  std::string list;
  for (std::size_t i = 0; i < std::min(numbers.size(), kMost); ++i) {
    list += (i == 0 ? "" : ", ") + std::to_string(numbers[i]);
  }
  if (numbers.size() > kMost) list += " and " + std::to_string(numbers.size() - kMost) + " more";
  return list;
}

/// The files by the number of their shard: all of one picture, none twice. Throws FileError.
std::vector<SumsFile> opened_parts(const std::vector<std::string>& paths) {
  std::vector<SumsFile> files;
  for (const std::string& path : paths) {
    files.push_back(open_sums_file(path));
    const std::string other = difference(files.back(), files.front());
    if (other.empty()) continue;
    throw FileError("cannot join " + in_quotes(path) + " with " + in_quotes(paths.front()) +
                    ": they are of different pictures: its " + other);
  }
  std::stable_sort(files.begin(), files.end(), [](const SumsFile& a, const SumsFile& b) {
    return a.shard.number < b.shard.number;
  });
  const auto twice = std::adjacent_find(
      files.begin(), files.end(),
      [](const SumsFile& a, const SumsFile& b) { return a.shard.number == b.shard.number; });
  if (twice != files.end()) {
    throw FileError("cannot join " + in_quotes(twice[0].path) + " and " + in_quotes(twice[1].path) +
                    ": both are shard " + std::to_string(twice->shard.number) + "; give it once");
  }
  return files;
}

void check_all_are_there(const std::vector<SumsFile>& files) {
  const int count = files.front().shard.count;
  std::vector<int> missing;
  auto file = files.begin();
  for (int number = 1; number <= count; ++number) {
    if (file != files.end() && file->shard.number == number) {
      ++file;
    } else {
      missing.push_back(number);
    }
  }
  if (missing.empty()) return;
  throw FileError("cannot join " + std::to_string(files.size()) + " of " + std::to_string(count) +
                  " shards: missing " + (missing.size() == 1 ? "is " : "are ") + list_of(missing));
}

void check_output(const JoinOptions& options) {
  if (options.picture.output == "-") {
    if (!is_terminal(kStandardOutput)) return;
    throw UsageError("-o -: standard output is a terminal; send it to a file or a program");
  }
  check_writable(options.picture.output);
  std::vector<ReadFile> inputs;
  inputs.reserve(options.parts.size());
  for (const std::string& part : options.parts) inputs.push_back({part, "one of the parts"});
  check_not_read("-o", options.picture.output, inputs);
  if (const auto sidecar = sidecar_place(options.picture)) {
    check_not_read("the sidecar of -o", *sidecar, inputs);
  }
}

void write_picture(const Image& picture, const PictureNotes& notes, const RenderOptions& options) {
  const Bytes bytes = encode_with_notes(picture, options.format, notes);
  if (options.output == "-") {
    write_to_standard_output(bytes);
    return;
  }
  WholeFile file{options.output};
  file.write(bytes);
  const auto sidecar = sidecar_place(options);
  const bool has_room = sidecar && is_free_for_sidecar(*sidecar);
  std::optional<WholeFile> sidecar_file;
  if (has_room) sidecar_file.emplace(*sidecar).write(sidecar_text(notes, bytes));
  file.commit();
  if (sidecar_file) sidecar_file->commit();
  if (sidecar && !has_room) {
    warn(in_quotes(*sidecar) +
         " is no sidecar of a picture and stays as it is: the picture's lens is written nowhere");
  }
}

int join(const JoinOptions& options) {
  if (!options.check) check_output(options);
  const std::vector<SumsFile> files = opened_parts(options.parts);
  if (!options.check) check_all_are_there(files);
  Progress progress{options.quiet};
  const auto show = [&](std::size_t done) {
    progress.show("joining, " + std::to_string(done) + " of " + std::to_string(files.size()));
  };
  if (options.check) {
    for (std::size_t i = 0; i < files.size(); ++i) {
      show(i);
      check_sums_file(files[i]);
    }
    return kDone;
  }
  const SumsOrigin& origin = files.front().origin;
  PictureNotes notes = origin.picture;
  // The sums, depth, the picture and its largest encoding.
  constexpr std::uint64_t kBytesPerPixel = 32 + 8 + 8 + 12;
  check_memory("join: the picture,", {notes.width, notes.height}, kBytesPerPixel);
  SampleSums sums = make_sample_sums(notes.width, notes.height);
  Image depth = make_image(Format::rgba16f, notes.width, notes.height);
  for (std::size_t i = 0; i < files.size(); ++i) {
    show(i);
    add_sums_file(files[i], sums, depth);
  }
  if (!are_exact(sums)) {
    throw FileError("cannot join " + in_quotes(files.front().path) +
                    " and the others: with so many samples of so much light, sums are rounded, and "
                    "one run would have other bits; take up to 8192 samples");
  }
  progress.show("writing");
  ThreadPool pool{hardware_threads(), widest_isa()};
  const Profile profile{.half_store = origin.half_store};
  const Image picture = mean_picture(sums, depth, profile, pool);
  notes.picture_hash = hash_image(picture);
  write_picture(picture, notes, options.picture);
  progress.clear();
  return kDone;
}

}  // namespace

Command add_join_command(CLI::App& program) {
  CLI::App* parser =
      add_command(program, "join", "Join what render --shard wrote to the picture of one run");
  const auto options = std::make_shared<JoinOptions>();
  add_value_list(*parser, "PARTS", "", "The .sum files of all shards",
                 [options](const std::vector<std::string>& names) { options->parts = names; });
  add_text(*parser, "-o,--output", "FILE",
           "The picture: .png, .exr, .tiff, .pfm, .hdr or .npy; - for standard output",
           options->picture.output);
  add_format_option(*parser, options->picture.format);
  add_flag(*parser, "--check", "Only look whether the files are whole and of one picture",
           options->check);
  add_quiet_option(*parser, options->quiet);
  return {parser, [parser, options] {
            if (options->parts.empty()) {
              throw UsageError("PARTS is missing: give the .sum files that render --shard wrote");
            }
            if (!options->check) {
              settle_format(*parser, options->picture.output, options->picture.format);
            } else if (!options->picture.output.empty()) {
              throw UsageError("--check and -o exclude each other: nothing is joined");
            }
            return join(*options);
          }};
}

}  // namespace softfocus
