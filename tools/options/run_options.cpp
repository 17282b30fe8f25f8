#include "tools/options/run_options.h"

#include <algorithm>
#include <iostream>
#include <sstream>

#include "scenes/files/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/cli/platform.h"

namespace softfocus {
namespace {

std::string isa_names() {
  std::string list;
  for (const Isa isa : available_isas()) {
    list += (list.empty() ? "" : ", ") + std::string{isa_name(isa)};
  }
  return list;
}

// This CPU's own units do not matter to a man page.
constexpr const char* kIsas = "scalar, baseline, avx2 or avx512";

ChosenProfile profile_of(const std::string& text) {
  if (const auto known = find_profile(text)) return {text, "", *known};
  if (text.find_first_of("/\\.") == std::string::npos) {
    refuse_name("--profile", text, names_in(profiles()),
                "; or give a profile's file, such as ./mine.toml");
  }
  try {
    ChosenProfile chosen = load_profile(text);
    chosen.file = text;
    return chosen;
  } catch (const SceneError& error) {
    throw UsageError(std::string("--profile: ") + error.what());
  }
}

Shaders checked_shaders(const std::string& text) {
  std::error_code unknown;
  if (!std::filesystem::is_directory(text, unknown)) {
    throw UsageError("--shaders '" + text + "': there is no such folder");
  }
  try {
    return read_shaders(text);
  } catch (const std::runtime_error& error) {
    throw UsageError(std::string("--shaders: ") + error.what());
  }
}

}  // namespace

void add_pool_options(CLI::App& parser, PoolOptions& options, const std::string& same) {
  add_value(parser, "--threads", "N", "Threads, 1 to 256; " + same + " (default: all)",
            [&options](const std::string& text) {
              options.threads = parse_whole("--threads", text, 1, 256, "a number from 1 to 256");
            });
  add_value(parser, "--isa", "NAME",
            "Vector unit, one that this CPU has: " + std::string{kIsas} + "; " + same +
                " (default: the widest)",
            [&options](const std::string& text) {
              const auto isa = find_isa(text);
              if (!isa) throw UsageError("--isa '" + text + "': this CPU has " + isa_names());
              options.isa = *isa;
            });
  offer(parser, "--isa", [] {
    return std::vector<std::string>{"scalar", "baseline", "avx2", "avx512"};
  });
}

void add_shard_option(CLI::App& parser, std::optional<Shard>& shard, const std::string& help) {
  add_value(parser, "--shard", "I/N", help, [&shard](const std::string& text) {
    const std::string wanted =
        "I/N, both from 1 to " + std::to_string(kMostSamples) + ", I at most N, such as 1/8";
    const auto refuse = [&] { throw UsageError("--shard '" + text + "': give " + wanted); };
    const auto slash = text.find('/');
    if (slash == text.npos) refuse();
    const auto number = [&](const std::string& part) {
      return parse_whole("--shard", part, 1, kMostSamples, wanted);
    };
    try {
      shard = Shard{number(text.substr(0, slash)), number(text.substr(slash + 1))};
    } catch (const UsageError&) {  // which knows one number alone
      refuse();
    }
    if (shard->number > shard->count) refuse();
  });
}

const Driver& parse_driver(std::string_view option, const std::string& text) {
  const Driver* driver = find_driver(text);
  if (driver == nullptr) {
    refuse_name(option, text, names_in(drivers()));
  }
  return *driver;
}

void add_driver_option(CLI::App& parser, const std::string& help,
                       std::function<void(const Driver&)> take) {
  add_repeatable_value(
      parser, "--driver", "NAME", help,
      [take = std::move(take)](const std::string& name) { take(parse_driver("--driver", name)); });
  offer(parser, "--driver", [] { return names_in(drivers()); });
}

void add_shaders_option(CLI::App& parser, Shaders& shaders) {
  add_value(parser, "--shaders", "DIR",
            "Shaders there take the place of those of the same name (see softfocus shaders)",
            [&shaders](const std::string& text) { shaders = checked_shaders(text); });
}

void add_profile_option(CLI::App& parser, const std::string& help,
                        std::function<void(const ChosenProfile&)> take) {
  add_value(parser, "--profile", "NAME|FILE", help,
            [take = std::move(take)](const std::string& text) { take(profile_of(text)); });
  offer(parser, "--profile", [] { return names_in(profiles()); });
}

void add_profile_option(CLI::App& parser, Profile& profile, std::string& name) {
  add_profile_option(
      parser,
      "Whose arithmetic to repeat to the bit: the standard's or a driver's (default: " + name + ")",
      [&profile, &name](const ChosenProfile& chosen) {
        profile = chosen.profile;
        name = chosen.name;
      });
}

namespace {

std::vector<std::string> names_of_formats() {
  std::vector<std::string> names;
  std::istringstream words{format_names(" ")};
  for (std::string name; words >> name;) names.push_back(name);
  return names;
}

}  // namespace

void add_format_option(CLI::App& parser, FileFormat& format) {
  add_value(parser, "--format", "FORMAT",
            "Format of FILE, whatever its name: " + format_names() +
                "; PNG of 8 or 16 bits (sRGB), PFM and HDR (linear), NPY (halves, depth in alpha), "
                "EXR in halves or floats (linear, depth as Z) (default: by the name, png for -)",
            [&format](const std::string& text) {
              const auto chosen = format_by_name(text);
              if (!chosen) refuse_name("--format", text, names_of_formats());
              format = *chosen;
            });
  offer(parser, "--format", names_of_formats);
}

void settle_format(const CLI::App& parser, const std::string& output, FileFormat& format) {
  constexpr const char* kEndings = ".png, .exr, .tiff, .pfm, .hdr or .npy";
  if (output.empty()) {
    throw UsageError(std::string{"-o is missing: give a "} + kEndings +
                     " file, or - for standard output");
  }
  if (!is_given(parser, "--format") && output != "-") {
    const auto by_name = format_by_extension(output);
    if (!by_name) {
      throw UsageError("-o '" + output + "': the name must end in " + kEndings +
                       ", or --format say which");
    }
    format = *by_name;
  }
  if (!missing_format(format).empty()) {
    throw UsageError("-o '" + output + "': " + std::string{missing_format(format)});
  }
}

void add_quiet_option(CLI::App& parser, bool& quiet) {
  begin_group(parser, kGeneralGroup);
  add_flag(parser, "-q,--quiet", "No progress and no notes on standard error; warnings stay",
           quiet);
}

void add_talk_options(CLI::App& parser, bool& verbose, bool& quiet) {
  begin_group(parser, kGeneralGroup);
  add_flag(parser, "-v,--verbose", "Say on standard error what was chosen", verbose);
  add_quiet_option(parser, quiet);
}

void check_talk(const CLI::App& parser) {
  if (!is_given(parser, "--verbose") || !is_given(parser, "--quiet")) return;
  throw UsageError("-v and -q exclude each other; give one");
}

namespace {
std::string gigabytes(std::uint64_t bytes) {
  return short_number(static_cast<double>(bytes) / 1e9) + " GB";
}
}  // namespace

void check_memory(std::string_view option, PictureSize size, std::uint64_t bytes_per_pixel) {
  const auto needed = bytes_per_pixel * static_cast<std::uint64_t>(size.width) *
                      static_cast<std::uint64_t>(size.height);
  const auto there = memory_bytes();
  if (!there || needed <= *there) return;
  throw UsageError(std::string{option} + " " + size_text(size) + ": needs " + gigabytes(needed) +
                   " of memory and there are " + gigabytes(*there) + "; give a smaller size");
}

void check_shadow_memory(const Scene& scene) {
  // Its corners, neighbours and place in the grid, and a mark of each thread's.
  const std::uint64_t bytes_per_facet = 160 + 4 * static_cast<std::uint64_t>(hardware_threads());
  std::uint64_t maps = 0;
  bool has_shadows = false;
  for (const Light& light : scene.lights) {
    has_shadows = has_shadows || light.shadows != ShadowKind::none;
    if (light.shadows != ShadowKind::map) continue;
    const auto size = static_cast<std::uint64_t>(light.map.size);
    const int sides = light.kind == LightKind::point ? 6 : light.map.cascades;
    maps += size * size * sizeof(float) * static_cast<std::uint64_t>(sides);
  }
  const std::uint64_t facets = has_shadows ? triangle_count(scene) * bytes_per_facet : 0;
  const auto there = memory_bytes();
  if (!there || maps + facets <= *there) return;
  throw UsageError("the scene's shadows need " + gigabytes(maps) + " for maps and " +
                   gigabytes(facets) + " for " + std::to_string(triangle_count(scene)) +
                   " triangles, and there are " + gigabytes(*there) + " of memory; " +
                   (maps > facets ? "smaller ones (--map size=N) or fewer cascades would do"
                                  : "fewer or coarser meshes, or --shadows none, would do"));
}

void print_scene_warnings(const std::vector<std::string>& warnings, bool all) {
  constexpr std::size_t kMostLines = 3;
  const std::size_t lines = all ? warnings.size() : std::min(warnings.size(), kMostLines);
  for (std::size_t i = 0; i < lines; ++i) warn(warnings[i]);
  if (lines < warnings.size()) {
    warn(std::to_string(warnings.size() - lines) + " more; -v lists them");
  }
}

}  // namespace softfocus
