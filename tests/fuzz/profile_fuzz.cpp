// Any text as a profile: one whose text says the same, or a SceneError.

#include "scenes/files/scene_error.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/files/profile_file.h"

int softfocus::fuzz_profile(const std::uint8_t* data, std::size_t size) {
  try {
    const ChosenProfile profile = load_profile(fuzz_file(data, size, ".toml"));
    const std::string text = profile_text(profile, "");
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(text.data());
    demand(profile_text(load_profile(fuzz_file(bytes, text.size(), ".toml")), "") == text);
  } catch (const SceneError&) {
  }
  return 0;
}
