#include "tools/options/driver_option.h"

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

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
  add_repeatable_value(
      parser, "--driver", "NAME", help,
      [take = std::move(take)](const std::string& name) { take(parse_driver("--driver", name)); });
}

}  // namespace softfocus
