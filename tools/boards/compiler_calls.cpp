// Functions that compilers call by themselves, with or without a C library: by words if both
// addresses allow it, as libraries have it. Compiled with -fno-tree-loop-distribute-patterns, or
// the loops would become calls of themselves.

#include <stddef.h>
#include <stdint.h>

namespace {
using Word __attribute__((may_alias)) = uint32_t;

bool are_words(uintptr_t address) { return address % sizeof(Word) == 0; }
}  // namespace

extern "C" {

void* memset(void* to, int value, size_t bytes) {
  auto* byte = static_cast<uint8_t*>(to);
  if (are_words(reinterpret_cast<uintptr_t>(to))) {
    const Word word = 0x01010101u * static_cast<uint8_t>(value);
    for (; bytes >= sizeof(Word); bytes -= sizeof(Word), byte += sizeof(Word)) {
      *reinterpret_cast<Word*>(byte) = word;
    }
  }
  for (; bytes > 0; --bytes) *byte++ = static_cast<uint8_t>(value);
  return to;
}

void* memcpy(void* __restrict to, const void* __restrict from, size_t bytes) {
  auto* byte = static_cast<uint8_t*>(to);
  const auto* source = static_cast<const uint8_t*>(from);
  if (are_words(reinterpret_cast<uintptr_t>(to) | reinterpret_cast<uintptr_t>(from))) {
    for (; bytes >= sizeof(Word); bytes -= sizeof(Word)) {
      *reinterpret_cast<Word*>(byte) = *reinterpret_cast<const Word*>(source);
      byte += sizeof(Word);
      source += sizeof(Word);
    }
  }
  for (; bytes > 0; --bytes) *byte++ = *source++;
  return to;
}
}
