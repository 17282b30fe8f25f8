#pragma once
// A shader over lanes, in every way that lanes run, against the oracle's pixels.

#include <cstdint>
#include <string>
#include <vector>

namespace softfocus::test {

struct CheckResult {
  bool is_stopped = false;   ///< the oracle ran too many blocks: nothing is compared
  std::string difference{};  ///< the first, in words; empty if all bits are equal
};

/// Compares a fragment shader's output 0: all vector units, several widths, sizes and numbers of
/// threads, simplified or not. Uniforms and textures are chosen by `seed`. Throws ShaderError.
CheckResult check_shader(const std::vector<std::uint32_t>& words, std::uint64_t seed);

}  // namespace softfocus::test
