// Any text as JSON, and as a picture's notes: nothing, or what its own text says again.

#include <string_view>

#include "tests/fuzz/fuzz_input.h"
#include "tools/files/json.h"
#include "tools/pictures/picture_notes.h"

int softfocus::fuzz_notes(const std::uint8_t* data, std::size_t size) {
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  if (const auto json = parse_json(text)) {
    const std::string written = json_text(*json);
    const auto again = parse_json(written);
    demand(again && json_text(*again) == written);
  }
  if (const auto notes = parse_notes(text)) {
    const std::string written = json_text(notes_json(*notes));
    const auto again = parse_notes(written);
    demand(again && json_text(notes_json(*again)) == written);
  }
  return 0;
}
