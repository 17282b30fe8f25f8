// Any words as SPIR-V: a ShaderError, or pixels.

#include <span>

#include "tests/fuzz/fuzz_input.h"
#include "tests/support/random_spirv.h"
#include "tests/support/shader_checks.h"

std::size_t softfocus::mutate_spirv(std::uint8_t* data, std::size_t size, std::size_t most,
                                    unsigned seed) {
  if (seed % 8 == 0) return LLVMFuzzerMutate(data, size, most);
  test::Random random{seed};
  std::vector<std::uint32_t> words(size / 4);
  if (!accepted_inputs.empty() && seed % 2 == 0) {
    const std::string& base = accepted_inputs[random.next() % accepted_inputs.size()];
    words.resize(base.size() / 4);
    std::memcpy(words.data(), base.data(), 4 * words.size());
  } else if (!words.empty()) {
    std::memcpy(words.data(), data, 4 * words.size());
  }
  words = test::damaged_spirv(std::move(words), random);
  size = std::min(4 * words.size(), most);
  if (size != 0) std::memcpy(data, words.data(), size);
  return size;
}

int softfocus::fuzz_shader(const std::uint8_t* data, std::size_t size) {
  try {
    test::run_any_shader(spirv_words(std::as_bytes(std::span{data, size})), Isa::baseline);
    return counted(true, data, size);
  } catch (const ShaderError&) {
    return counted(false, data, size);
  }
}
