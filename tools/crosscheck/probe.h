#pragma once
// Asks a driver by experiment what it computes.

#include <string>
#include <vector>

#include "tools/files/profile_file.h"
#include "tools/gl/driver.h"

namespace softfocus {

/// One question, the answer, and what it rests on.
struct ProbeFinding {
  std::string question;
  std::string answer;
  std::string evidence;
};

struct Probe {
  std::string renderer;  ///< GL_RENDERER and GL_VERSION
  ChosenProfile profile;
  std::vector<ProbeFinding> findings;
};

/// Opens the driver in this process and experiments. Throws DriverError.
Probe probe_driver(const Driver& driver);

}  // namespace softfocus
