#pragma once
// A command's machine, and its words before it runs: --threads and --isa, --shard, --driver,
// --shaders, --profile, --format, too little memory, what a scene lacks.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/lens_views/shard.h"
#include "tools/cli/option_values.h"
#include "tools/cli/parser.h"
#include "tools/files/profile_file.h"
#include "tools/gl/driver/driver.h"
#include "tools/gl/shaders.h"
#include "tools/pictures/image_file.h"

namespace softfocus {

struct PoolOptions {
  int threads = hardware_threads();
  Isa isa = widest_isa();
};

/// Adds --threads and --isa. `same` ends the help of the first: what does not depend on it.
void add_pool_options(CLI::App& parser, PoolOptions& options, const std::string& same);

/// Adds --shard I/N. `help` says what is shared out.
void add_shard_option(CLI::App& parser, std::optional<Shard>& shard, const std::string& help);

/// The driver of that name; throws UsageError, listing those there are.
const Driver& parse_driver(std::string_view option, const std::string& text);

/// Adds --driver, which may be repeated.
void add_driver_option(CLI::App& parser, const std::string& help,
                       std::function<void(const Driver&)> take);

/// Adds --shaders: a folder of the user's GLSL.
void add_shaders_option(CLI::App& parser, Shaders& shaders);

/// Adds --profile: the name of a known profile, or a profile's file (a name with a
/// slash or a dot in it).
void add_profile_option(CLI::App& parser, const std::string& help,
                        std::function<void(const ChosenProfile&)> take);

/// Adds --profile for the emulated GPU. `profile` and `name` hold the default.
void add_profile_option(CLI::App& parser, Profile& profile, std::string& name);

/// Adds --format; `format` is that of standard output.
void add_format_option(CLI::App& parser, FileFormat& format);

/// Once all options are read: the format of -o by its name, unless --format says it. Throws
/// UsageError if -o is missing, has no known ending, or this build lacks the format.
void settle_format(const CLI::App& parser, const std::string& output, FileFormat& format);

/// Throws UsageError, naming the option that gave the size, if the machine has less memory
/// than so many bytes a pixel. If the system does not tell, allocation decides.
void check_memory(std::string_view option, PictureSize size, std::uint64_t bytes_per_pixel);

/// Adds -q, beside --help.
void add_quiet_option(CLI::App& parser, bool& quiet);

/// Adds -v and -q, beside --help.
void add_talk_options(CLI::App& parser, bool& verbose, bool& quiet);

/// Throws UsageError if both were given.
void check_talk(const CLI::App& parser);

/// Throws UsageError if this machine has less memory than a scene's shadow maps and, where there
/// are shadows, its triangles in the world.
void check_shadow_memory(const Scene& scene);

/// A line each. A model may lack a hundred textures: three at most, unless `all`.
void print_scene_warnings(const std::vector<std::string>& warnings, bool all);

}  // namespace softfocus
