#pragma once
// What a scene had to make do without, said on standard error.

#include <string>
#include <vector>

namespace softfocus {

/// A line each. A model may lack a hundred textures: three at most, unless `all`.
void print_scene_warnings(const std::vector<std::string>& warnings, bool all);

}  // namespace softfocus
