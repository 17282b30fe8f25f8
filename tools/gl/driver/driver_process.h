#pragma once
// A process for a driver: what runs in it sends lines, and can crash.

#include <functional>
#include <string>

namespace softfocus {

using SendLine = std::function<void(const std::string&)>;

/// Runs `work` in a child process and calls `receive` here for each line that it sends
/// (which must hold no newline). Returns what went wrong: an exception's message or how
/// the process ended; empty if all went well. Must be called before any thread is
/// started.
std::string run_driver_process(const std::function<void(const SendLine&)>& work,
                               const std::function<void(const std::string&)>& receive);

}  // namespace softfocus
