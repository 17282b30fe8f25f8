#include "tools/render/shard_file.h"

#include <array>
#include <fstream>

#include "raster/numbers/hash.h"
#include "tools/cli/errors.h"
#include "tools/pictures/sums_file.h"
#include "tools/render/picture_files.h"

namespace softfocus {
namespace {

constexpr std::string_view kMethod = "accumulation";

void add_letters(Hash& hash, std::string_view text) {
  for (const char letter : text) add_to_hash(hash, static_cast<unsigned char>(letter));
}

// Hashes the files' bytes, not their names: machines may keep them in different places.
std::uint64_t hash_of_files(const Scene& scene) {
  Hash hash;
  std::vector<char> part(65536);
  for (const std::filesystem::path& file : scene.files) {
    std::ifstream stream{file, std::ios::binary};
    std::uint64_t bytes = 0;
    do {
      stream.read(part.data(), static_cast<std::streamsize>(part.size()));
      const auto count = static_cast<std::size_t>(stream.gcount());
      add_letters(hash, {part.data(), count});
      bytes += count;
    } while (stream);
    if (!stream.eof()) throw FileError("cannot read '" + file.string() + "' again; keep it there");
    add_to_hash(hash, bytes);
  }
  return hash.value;
}

std::uint64_t hash_of_profile(const Profile& profile) {
  Hash hash;
  add_letters(hash, profile_text({.name = {}, .summary = {}, .profile = profile}, {}));
  return hash.value;
}

}  // namespace

void check_shard_options(const RenderOptions& options, const CLI::App& parser) {
  const std::string option = "--shard";
  if (options.show != Show::image || options.method.name() != kMethod) {
    throw UsageError(option + ": only the samples of --method " + std::string{kMethod} +
                     " are shared out; give that, with --show image");
  }
  if (options.sampling.until || options.sampling.by_tile) {
    throw UsageError(option + " and " + (options.sampling.until ? "--until" : "--samples auto") +
                     " exclude each other: who stops early must see all samples; give --samples N");
  }
  for (const char* other : {"--format", "--depth-output", "--report", "--json"}) {
    if (!is_given(parser, other)) continue;
    throw UsageError(option + " and " + other +
                     " exclude each other: a shard has sums, and no picture yet");
  }
  if (std::filesystem::path{options.output}.extension() != ".sum") {
    throw UsageError((options.output.empty() ? "-o is missing" : "-o '" + options.output + "'") +
                     ": --shard writes sums; give a .sum file");
  }
}

void check_shard_count(const Shard& shard, int samples) {
  const int most = most_shards(samples);
  if (shard.count <= most) return;
  throw UsageError("--shard " + std::to_string(shard.number) + "/" + std::to_string(shard.count) +
                   ": " + std::to_string(samples) + " samples are " + std::to_string(most) +
                   " groups of " + std::to_string(kSampleGroup) + "; N is at most " +
                   std::to_string(most));
}

void write_shard(const Scene& scene, const RenderOptions& options, const RenderRecord& record) {
  const Frame& frame = record.frame;
  const SumsOrigin origin{.picture = notes_of(options, record),
                          .samples = frame.sampling.samples,
                          .half_store = options.profile.half_store,
                          .scene_files_hash = hash_of_files(scene),
                          .profile_hash = hash_of_profile(options.profile),
                          .pinhole_hash = hash_image(frame.picture)};
  write_sums_file(options.output, *options.shard, origin, frame.sums, frame.picture);
}

}  // namespace softfocus
