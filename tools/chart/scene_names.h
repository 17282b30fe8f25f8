#pragma once
// The scenes that --scenes names.

#include <string>
#include <string_view>
#include <vector>

namespace softfocus {

/// The names of "a,b,c". "random:8..11" stands for random:8, random:9, random:10 and random:11.
/// Throws UsageError for an empty name, a name given twice, or a malformed range.
std::vector<std::string> scene_names(const std::string& text);

/// The parts of "a,b,c". Throws UsageError for an empty or a repeated one.
std::vector<std::string> listed_names(const std::string& option, const std::string& text);

/// A scene's name as the name of a file: "random-8", for not every system has ':' in names.
std::string name_for_files(std::string_view scene);

}  // namespace softfocus
