#pragma once
// Runs of many frames through the program, for the tests of its command line.

#include "tests/support/cli_render.h"

namespace softfocus {

inline Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// A lens that blurs so small a picture of `figures`.
inline const Words kWideLens{"--focus",     "1.1", "--f-number", "1",
                             "--coc-scale", "3",   "--max-coc",  "12"};

/// Runs a command and checks its status and the last line that it says: its summary.
inline std::string check_run(const Words& words, int status, const std::string& summary) {
  std::string command;
  for (const std::string& word : words) command += word + " ";
  CAPTURE(command);
  const ProgramRun run = run_program(words);
  CHECK(run.status == status);
  CAPTURE(run.err);
  CHECK(run.err.ends_with("softfocus: " + summary + "\n"));
  return run.err;
}

/// Whether two files have the same bytes, and some.
inline bool same_files(const std::string& a, const std::string& b) {
  const std::string bytes = read_file(a);
  return !bytes.empty() && bytes == read_file(b);
}

}  // namespace softfocus
