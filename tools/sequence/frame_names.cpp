#include "tools/sequence/frame_names.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "tools/cli/errors.h"

namespace softfocus {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A whole number of digits alone, up to 18 of them.
std::optional<FrameNumber> whole_number(std::string_view text) {
  constexpr std::size_t kMostDigits = 18;
  if (text.empty() || text.size() > kMostDigits || !std::all_of(text.begin(), text.end(), is_digit))
    return std::nullopt;
  FrameNumber number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::size_t last_part_of(std::string_view text) {
  const std::size_t slash =
      text.find_last_of(std::filesystem::path::preferred_separator == '/' ? "/" : "/\\");
  return slash == text.npos ? 0 : slash + 1;
}

/// The end of the conversion at a %, %d behind its digits; nothing if it is none.
std::optional<std::size_t> end_of_number(std::string_view text, std::size_t percent) {
  std::size_t end = percent + 1;
  while (end < text.size() && is_digit(text[end])) ++end;
  if (end == text.size() || text[end] != 'd') return std::nullopt;
  return end + 1;
}

/// The runs of digits of a name, from the last to the first, without its ending.
std::vector<std::string_view> numbers_from_the_end(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot != name.npos && dot > 0) name = name.substr(0, dot);
  std::vector<std::string_view> runs;
  for (std::size_t end = name.size(); end > 0;) {
    if (!is_digit(name[end - 1])) {
      --end;
      continue;
    }
    std::size_t start = end;
    while (start > 0 && is_digit(name[start - 1])) --start;
    runs.push_back(name.substr(start, end - start));
    end = start;
  }
  return runs;
}

/// Whether a letter is one of those in [...]; `glob` begins behind the bracket and is moved past
/// the closing one. Nothing without a closing one.
std::optional<bool> fits_class(std::string_view& glob, char letter) {
  std::string_view rest = glob;
  const bool others = !rest.empty() && (rest[0] == '!' || rest[0] == '^');
  if (others) rest.remove_prefix(1);
  bool found = false;
  for (bool first = true; !rest.empty() && (first || rest[0] != ']'); first = false) {
    const char low = rest[0];
    const bool is_range = rest.size() > 2 && rest[1] == '-' && rest[2] != ']';
    const char high = is_range ? rest[2] : low;
    rest.remove_prefix(is_range ? 3 : 1);
    found = found || (letter >= low && letter <= high);
  }
  if (rest.empty()) return std::nullopt;
  glob = rest.substr(1);
  return found != others;
}

}  // namespace

FrameRange parse_frame_range(std::string_view option, const std::string& text) {
  const auto refuse = [&] {
    throw UsageError(std::string{option} + " '" + text +
                     "': give FIRST..LAST or FIRST..LAST:STEP, such as 1..48, from 0 to " +
                     std::to_string(kLastFrame) + ", at most a million frames");
  };
  const auto number = [&](std::string_view part) {
    const auto value = whole_number(part);
    if (!value || *value > kLastFrame) refuse();
    return *value;
  };
  const std::string_view all = text;
  const std::size_t dots = all.find(".."), colon = all.find(':');
  FrameRange range;
  if (dots == all.npos) {
    range.first = range.last = number(all);
    return range;
  }
  if (colon < dots) refuse();
  range.first = number(all.substr(0, dots));
  range.last = number(all.substr(dots + 2, colon == all.npos ? colon : colon - dots - 2));
  if (colon != all.npos) range.step = number(all.substr(colon + 1));
  constexpr FrameNumber kMostFrames = 1'000'000;
  if (range.step < 1 || range.last < range.first ||
      (range.last - range.first) / range.step >= kMostFrames) {
    refuse();
  }
  return range;
}

std::vector<FrameNumber> frames_of(const FrameRange& range) {
  std::vector<FrameNumber> frames;
  for (FrameNumber frame = range.first; frame <= range.last; frame += range.step) {
    frames.push_back(frame);
  }
  return frames;
}

std::optional<NumberedName> numbered_name(std::string_view what, const std::string& text) {
  const auto refuse = [&](const char* why) {
    throw UsageError(std::string{what} + " '" + text + "': " + why +
                     "; give one number in the file's name, such as frame_%04d.exr");
  };
  std::optional<NumberedName> found;
  std::string literal;
  const std::size_t last_part = last_part_of(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool at_percent = text[i] == '%';
    const auto end = at_percent ? end_of_number(text, i) : std::nullopt;
    if (!end) {
      if (at_percent && text.substr(i, 2) == "%%") ++i;
      literal += text[i];
      continue;
    }
    if (found) refuse("there are two numbers");
    if (i < last_part) refuse("the number is in a folder's name");
    const std::string_view digits = std::string_view{text}.substr(i + 1, *end - i - 2);
    if (!digits.empty() && (digits[0] != '0' || digits.size() != 2 || digits[1] == '0')) {
      refuse("a number is %d or %01d to %09d");
    }
    found = {literal, "", digits.empty() ? 1 : digits[1] - '0'};
    literal.clear();
    i = *end - 1;
  }
  if (found) found->behind = literal;
  return found;
}

std::string name_at(const NumberedName& name, FrameNumber frame) {
  const std::string number = std::to_string(frame);
  const auto digits = static_cast<std::size_t>(name.digits);
  return name.before + std::string(digits - std::min(digits, number.size()), '0') + number +
         name.behind;
}

std::optional<FrameNumber> frame_named(const NumberedName& name, std::string_view text) {
  if (text.size() < name.before.size() + name.behind.size()) return std::nullopt;
  const std::size_t length = text.size() - name.before.size() - name.behind.size();
  const auto number = whole_number(text.substr(name.before.size(), length));
  if (!number || *number > kLastFrame || name_at(name, *number) != text) return std::nullopt;
  return number;
}

bool is_glob(const std::string& text) {
  std::error_code unknown;
  return text.find_first_of("*?[", last_part_of(text)) != text.npos &&
         !std::filesystem::exists(text, unknown);
}

bool fits_glob(std::string_view glob, std::string_view name) {
  if (name.starts_with('.') && !glob.starts_with('.')) return false;
  // The place to go on from if a * has to take one letter more.
  std::string_view star_glob, star_name;
  bool has_star = false;
  while (!name.empty() || !glob.empty()) {
    if (glob.starts_with('*')) {
      glob.remove_prefix(1);
      has_star = true;
      star_glob = glob;
      star_name = name;
      continue;
    }
    if (!name.empty() && !glob.empty()) {
      std::string_view rest = glob.substr(1);
      bool fits = glob[0] == '?' || glob[0] == name[0];
      if (glob[0] == '[') {
        if (const auto of_class = fits_class(rest, name[0])) fits = *of_class;
      }
      if (fits) {
        glob = rest;
        name.remove_prefix(1);
        continue;
      }
    }
    if (!has_star || star_name.empty()) return false;
    star_name.remove_prefix(1);
    glob = star_glob;
    name = star_name;
  }
  return true;
}

std::optional<std::vector<FrameNumber>> numbers_of(const std::vector<std::string>& names) {
  std::vector<std::vector<std::string_view>> runs;
  std::size_t fewest = ~std::size_t{0};
  for (const std::string& name : names) {
    runs.push_back(numbers_from_the_end(name));
    fewest = std::min(fewest, runs.back().size());
  }
  for (std::size_t run = 0; !names.empty() && run < fewest; ++run) {
    std::vector<FrameNumber> numbers;
    for (const auto& of_name : runs) {
      const auto number = whole_number(of_name[run]);
      if (!number) break;
      numbers.push_back(*number);
    }
    const std::set<FrameNumber> different(numbers.begin(), numbers.end());
    if (different.size() == names.size()) return numbers;
  }
  return std::nullopt;
}

FrameFiles::FrameFiles(std::string what, std::string text)
    : what_(std::move(what)), text_(std::move(text)) {
  std::error_code error;
  const bool is_one_file = std::filesystem::exists(text_, error);
  if (!is_one_file) numbered_ = numbered_name(what_, text_);
  const bool glob = !numbered_ && is_glob(text_);
  if (!numbered_ && !glob) return;
  many_ = true;

  const std::filesystem::path place = glob ? text_ : name_at(*numbered_, 0);
  const std::filesystem::path folder = place.parent_path();
  std::vector<std::string> names;
  std::filesystem::directory_iterator entries{folder.empty() ? "." : folder, error};
  for (; !error && entries != std::filesystem::directory_iterator{}; entries.increment(error)) {
    names.push_back(entries->path().filename().string());
  }
  if (error) {
    throw UsageError(what_ + " '" + text_ + "': cannot read the folder: " + error.message());
  }
  if (!glob) {
    NumberedName in_folder = *numbered_;
    in_folder.before.erase(0, last_part_of(in_folder.before));
    for (const std::string& name : names) {
      if (const auto frame = frame_named(in_folder, name)) {
        files_[*frame] = name_at(*numbered_, *frame);
      }
    }
    return;
  }
  const std::string wanted = place.filename().string();
  std::erase_if(names, [&](const std::string& name) { return !fits_glob(wanted, name); });
  if (names.empty()) throw UsageError(what_ + " '" + text_ + "': no file fits; name some");
  std::sort(names.begin(), names.end());
  const auto numbers = numbers_of(names);
  if (!numbers) {
    throw UsageError(what_ + " '" + text_ + "': '" + names.front() + "'" +
                     (names.size() > 1 ? " and the others have no number each" : " has no number") +
                     "; number the files, as in frame_0001.exr");
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    files_[(*numbers)[i]] = (folder / names[i]).string();
  }
}

std::vector<FrameNumber> FrameFiles::frames() const {
  std::vector<FrameNumber> frames;
  for (const auto& [frame, file] : files_) frames.push_back(frame);
  return frames;
}

void FrameFiles::check_there(const std::vector<FrameNumber>& wanted) const {
  if (!many_) return;
  std::vector<std::string> missing;
  for (const FrameNumber frame : wanted) {
    if (!files_.contains(frame)) missing.push_back(at(frame));
  }
  if (missing.empty()) return;
  throw UsageError(what_ + " '" + text_ + "': of " + std::to_string(wanted.size()) + " frames " +
                   std::to_string(missing.size()) + " have no file: " + some_of(missing) +
                   "; give them, or other --frames");
}

std::string FrameFiles::at(FrameNumber frame) const {
  if (!many_) return text_;
  const auto found = files_.find(frame);
  if (found != files_.end()) return found->second;
  return numbered_ ? name_at(*numbered_, frame) : "number " + std::to_string(frame);
}

std::string some_of(const std::vector<std::string>& words) {
  constexpr std::size_t kFew = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(words.size(), kFew); ++i) {
    text += (i == 0 ? "" : ", ") + words[i];
  }
  if (words.size() > kFew) text += " and " + std::to_string(words.size() - kFew) + " more";
  return text;
}

}  // namespace softfocus
