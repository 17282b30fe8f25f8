#pragma once
// From an option's text to its value, with one kind of message: the option, what was
// given, and what would be right.

#include <filesystem>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/parser.h"

namespace softfocus {

struct PictureSize {
  int width = 1024;
  int height = 1024;
};

/// Counted from the left and from the top.
struct Pixel {
  int x = 0;
  int y = 0;
};

/// Adds an option whose value is taken as it is: a name, a file.
template <class Text>
void add_text(CLI::App& parser, const std::string& name, const std::string& type,
              const std::string& help, Text& place) {
  add_value(parser, name, type, help, [&place](const std::string& text) { place = text; });
}

/// The names of the scenes that come along.
std::vector<std::string> known_scenes();

/// Adds SCENE, as load_scene() takes it.
void add_scene_argument(CLI::App& parser, std::string& scene);

/// Adds --scene-path, which may be repeated: directories that must exist.
void add_scene_path(CLI::App& parser, std::vector<std::filesystem::path>& directories);

/// Adds --size.
void add_size(CLI::App& parser, PictureSize& size);

/// Adds --multisample; `samples` holds the default.
void add_multisample(CLI::App& parser, int& samples);

/// Adds --frame, a time of the animation.
void add_frame(CLI::App& parser, double& frame);

/// A finite decimal number from `least` to `most`; `wanted` ends the message "give ...".
double parse_number(std::string_view option, const std::string& text, double least, double most,
                    std::string_view wanted);

/// A whole number likewise.
int parse_whole(std::string_view option, const std::string& text, int least, int most,
                std::string_view wanted);

/// WIDTHxHEIGHT, each 1 to kMaxImageSize.
PictureSize parse_size(std::string_view option, const std::string& text);

/// A to Z as a to z.
std::string lower_case(std::string text);

/// "1024x768".
std::string size_text(PictureSize size);

/// X,Y.
Pixel parse_pixel(std::string_view option, const std::string& text);

/// `value` as short as it can be told from its neighbours by eye: at most 6 digits.
std::string short_number(double value);

/// "1 sample", "2 samples".
std::string count_text(int count, const std::string& thing);

/// Every bit of `value`, readable: 17 digits.
std::string exact_number(double value);

/// Throws UsageError for a name that there is not: "OPTION 'TEXT': there are A, B", then `also`,
/// then the one that was probably meant.
[[noreturn]] void refuse_name(std::string_view option, const std::string& text,
                              const std::vector<std::string>& there, const std::string& also = "");

/// Adds a name. Throws UsageError if it is there already.
void add_once(const std::string& option, const std::string& text, const std::string& name,
              std::vector<std::string>& names);

/// The parts of "a,b,c". Throws UsageError for an empty or a repeated one, and for one that is not
/// among those `known`, if there are any.
std::vector<std::string> listed_names(const std::string& option, const std::string& text,
                                      const std::vector<std::string>& known = {});

/// The names of things that have one.
template <class Range>
std::vector<std::string> names_in(const Range& things) {
  std::vector<std::string> names;
  names.reserve(std::size(things));
  for (const auto& thing : things) names.emplace_back(thing.name);
  return names;
}

/// "a, b, c" of things that have a name.
template <class Range>
std::string names_of(const Range& things) {
  std::string list;
  for (const auto& thing : things) list += (list.empty() ? "" : ", ") + std::string{thing.name};
  return list;
}

}  // namespace softfocus
