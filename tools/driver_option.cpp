#include "tools/driver_option.h"

#include "tools/errors.h"
#include "tools/option_values.h"

namespace softfocus {

const Driver& parse_driver(std::string_view option, const std::string& text) {
  const Driver* driver = find_driver(text);
  if (driver == nullptr) {
    throw UsageError(std::string(option) + " '" + text + "': there are " + names_of(drivers()));
  }
  return *driver;
}

void add_driver_option(CLI::App& parser, const std::string& help,
                       std::function<void(const Driver&)> take) {
  parser
      .add_option(
          "--driver",
          [take = std::move(take)](const CLI::results_t& names) {
            for (const std::string& name : names) take(parse_driver("--driver", name));
            return true;
          },
          help)
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace softfocus
