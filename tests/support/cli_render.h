#pragma once
// Renders small pictures through the program, for the tests of its command line.

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/support/run_program.h"
#include "tools/pictures/image_file.h"

namespace softfocus {

using Words = std::vector<std::string>;

// So small a picture has a --max-coc of 0.5 by itself: a test of blur gives one.
inline constexpr int kWidth = 48;
inline constexpr int kHeight = 32;
inline constexpr const char* kSize = "48x32";

inline const std::string kCube = "[material.m]\n[[object]]\nshape = \"cube\"\nmaterial = \"m\"\n";

/// Of one sample a pixel, as filters and other programs have it.
inline Words render(const std::string& scene, const std::string& output, const Words& more = {}) {
  Words words{"render", scene, "--size", kSize, "-o", output, "--multisample", "1"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// The files that a render leaves in a folder: an NPY or a PFM has a sidecar.
inline Words written(const std::string& name, const std::string& bytes) {
  if (bytes.starts_with("\x89PNG")) return {name};
  return {name, name + ".json"};
}

/// The bytes of a picture that was rendered without complaint.
inline std::string rendered(const std::string& scene, const Words& more,
                            const char* name = "a.npy") {
  const TemporaryDirectory directory;
  const ProgramRun run = run_program(render(scene, directory.file(name), more));
  CHECK(run.status == 0);
  CHECK(run.err == "");
  std::string bytes = read_file(directory.file(name));
  CHECK(directory.listing() == written(name, bytes));
  return bytes;
}

inline Picture rendered_picture(const std::string& scene, const Words& more) {
  const std::string bytes = rendered(scene, more);
  return decode_npy(std::as_bytes(std::span{bytes}));
}

/// --json's report.
inline nlohmann::json rendered_json(const std::string& scene, Words more) {
  const TemporaryDirectory directory;
  more.emplace_back("--json");
  const ProgramRun run = run_program(render(scene, directory.file("a.npy"), more));
  CHECK(run.status == 0);
  return nlohmann::json::parse(run.out);
}

/// The report that a page draws.
inline nlohmann::json report_of_page(const std::string& page) {
  const std::string start = "id=\"results\">";
  const std::size_t place = page.find(start) + start.size();
  return nlohmann::json::parse(page.substr(place, page.find("</script>", place) - place));
}

}  // namespace softfocus
