#include "tools/crosscheck/probe.h"

namespace softfocus {

std::string probe_text(const Probe& probe) {
  std::string heading = "Probed by softfocus " SOFTFOCUS_VERSION " on " + probe.renderer +
                        "\nFor --profile FILE. What the answers rest on:\n";
  for (const ProbeFinding& finding : probe.findings) {
    heading += "- " + finding.question + ": " + finding.answer + " (" + finding.evidence + ")\n";
  }
  return profile_text(probe.profile, heading);
}

}  // namespace softfocus
