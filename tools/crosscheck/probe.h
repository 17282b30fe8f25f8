#pragma once
// Asks a driver by experiment what it computes.

#include <string>
#include <vector>

#include "tools/files/profile_file.h"
#include "tools/gl/driver/driver.h"

namespace softfocus {

class GlContext;
class ThreadPool;

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

/// Experiments on an open driver; `name` is the profile's, or empty for one from the driver's own.
Probe probe_context(const GlContext& gl, const std::string& name, ThreadPool& pool);

/// The profile's file, with what the answers rest on in its heading.
std::string probe_text(const Probe& probe);

}  // namespace softfocus
