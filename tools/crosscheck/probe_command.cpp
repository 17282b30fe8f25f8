// softfocus probe: a driver's profile, by experiment.

#include <iostream>
#include <memory>

#include "tools/cli/commands.h"
#include "tools/cli/errors.h"
#include "tools/cli/option_values.h"
#include "tools/crosscheck/probe.h"
#include "tools/files/whole_file.h"
#include "tools/options/run_options.h"

namespace softfocus {

std::string probe_text(const Probe& probe) {
  std::string heading = "Probed by softfocus " SOFTFOCUS_VERSION " on " + probe.renderer +
                        "\nFor --profile FILE. What the answers rest on:\n";
  for (const ProbeFinding& finding : probe.findings) {
    heading += "- " + finding.question + ": " + finding.answer + " (" + finding.evidence + ")\n";
  }
  return profile_text(probe.profile, heading);
}

namespace {

struct ProbeOptions {
  const Driver* driver = nullptr;
  std::string output;
};

int probe(const ProbeOptions& options) {
  const Driver& driver = options.driver != nullptr ? *options.driver : drivers().front();
  if (!options.output.empty()) check_writable(options.output);
  const Probe probed = naming(driver, [&] { return probe_driver(driver); });
  const std::string text = probe_text(probed);
  if (options.output.empty()) {
    std::cout << text;
  } else {
    WholeFile file{options.output};
    file.write(text);
    file.commit();
  }
  return kDone;
}

}  // namespace

Command add_probe_command(CLI::App& program) {
  CLI::App* parser = add_command(
      program, "probe", "Find out by experiment what a GL driver computes, and print its profile");
  const auto options = std::make_shared<ProbeOptions>();
  add_driver_option(*parser, "Driver to ask (default: llvmpipe)", [options](const Driver& driver) {
    if (options->driver != nullptr) throw UsageError("--driver is given twice; give it once");
    options->driver = &driver;
  });
  add_text(*parser, "-o,--output", "FILE", "Write the profile there (default: print it)",
           options->output);
  return {parser, [options] { return probe(*options); }};
}

}  // namespace softfocus
