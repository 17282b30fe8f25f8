#include "tools/options/profile_option.h"

#include "scenes/load/scene_error.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

ChosenProfile profile_of(const std::string& text) {
  if (const auto known = find_profile(text)) return {text, "", *known};
  if (text.find_first_of("/\\.") == std::string::npos) {
    throw UsageError("--profile '" + text + "': there are " + names_of(profiles()) +
                     "; or give a profile's file, such as ./mine.toml");
  }
  try {
    return load_profile(text);
  } catch (const SceneError& error) {
    throw UsageError(std::string("--profile: ") + error.what());
  }
}

}  // namespace

void add_profile_option(CLI::App& parser, const std::string& help,
                        std::function<void(const ChosenProfile&)> take) {
  add_value(parser, "--profile", "NAME|FILE", help,
            [take = std::move(take)](const std::string& text) { take(profile_of(text)); });
}

}  // namespace softfocus
