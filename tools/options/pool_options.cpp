#include "tools/options/pool_options.h"

#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"

namespace softfocus {
namespace {

std::string isa_names() {
  std::string list;
  for (const Isa isa : available_isas()) {
    list += (list.empty() ? "" : ", ") + std::string{isa_name(isa)};
  }
  return list;
}

}  // namespace

void add_pool_options(CLI::App& parser, PoolOptions& options, const std::string& same) {
  add_value(parser, "--threads", "N", "Threads, 1 to 256; " + same + " (default: all)",
            [&options](const std::string& text) {
              options.threads = parse_whole("--threads", text, 1, 256, "a number from 1 to 256");
            });
  add_value(parser, "--isa", "NAME",
            "Vector unit: of this CPU " + isa_names() + "; " + same + " (default: the widest)",
            [&options](const std::string& text) {
              const auto isa = find_isa(text);
              if (!isa) throw UsageError("--isa '" + text + "': this CPU has " + isa_names());
              options.isa = *isa;
            });
}

}  // namespace softfocus
