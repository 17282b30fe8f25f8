// Any lines as the arguments of `refocus`: options that fit each other, or a UsageError. The same
// functions read the options of other commands.

#include <iostream>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/cli/parser.h"
#include "tools/refocus/options.h"

namespace {

using namespace softfocus;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

}  // namespace

int softfocus::fuzz_options(const std::uint8_t* data, std::size_t size) {
  std::cout.rdbuf(nullptr);  // where --help goes
  std::cerr.rdbuf(nullptr);
  std::vector<std::string> arguments = lines_of({reinterpret_cast<const char*>(data), size});
  arguments.insert(arguments.begin(), "refocus");
  const auto program = make_program("softfocus", "0", "");
  RefocusOptions options;
  CLI::App* const parser = add_command(*program, "refocus", "");
  add_refocus_options(*parser, options);
  try {
    if (parse(*program, arguments).answered) return 0;
    complete(options, *parser);
  } catch (const UsageError&) {
  }
  return 0;
}
