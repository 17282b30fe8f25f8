// Any text as a line of a sequence's journal, a range of frames, and two names, the first with a
// number or a glob.

#include <string>

#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/sequence/frame_names.h"
#include "tools/sequence/journal.h"

namespace {

using namespace softfocus;

void check_range(const std::string& text) {
  try {
    const FrameRange range = parse_frame_range("--frames", text);
    demand(range.first >= 0 && range.first <= range.last && range.last <= kLastFrame);
    const std::vector<FrameNumber> frames = frames_of(range);
    demand(!frames.empty() && frames.size() <= 1'000'000 && frames.back() <= range.last);
  } catch (const UsageError&) {
  }
}

void check_name(const std::string& text) {
  try {
    const auto name = numbered_name("-o", text);
    if (!name) return;
    for (const FrameNumber frame : {FrameNumber{0}, FrameNumber{12}, kLastFrame}) {
      demand(frame_named(*name, name_at(*name, frame)) == frame);
    }
  } catch (const UsageError&) {
  }
}

}  // namespace

int softfocus::fuzz_sequence(const std::uint8_t* data, std::size_t size) {
  const std::string text{reinterpret_cast<const char*>(data), size};
  if (const auto line = parse_journal_line(text)) demand(journal_line(*line) == text + "\n");
  check_range(text);
  check_name(text);
  const std::size_t end = text.find('\n');
  if (end != text.npos) fits_glob(text.substr(0, end), text.substr(end + 1));
  numbers_of({text.substr(0, end), text});
  return 0;
}
