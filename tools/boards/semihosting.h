#pragma once
// Requests to the debugger or emulator that a bare machine hangs on: "Semihosting for
// AArch32 and AArch64", Arm, and "RISC-V Semihosting". An operation has a number and a
// block of words; the answer is a word.

#include <stdint.h>

namespace softfocus::device {

enum class HostCall : uint32_t {
  open = 0x01,
  write_text = 0x04,
  write = 0x05,
  read = 0x06,
  exit_extended = 0x20,
};

inline intptr_t ask_host(HostCall call, const void* block) {
#ifdef __riscv
  register intptr_t a0 __asm__("a0") = static_cast<intptr_t>(call);
  register const void* a1 __asm__("a1") = block;
  // The three are known by each other: uncompressed, and in one page.
  __asm__ volatile(
      ".balign 16\n"
      ".option push\n"
      ".option norvc\n"
      "slli zero, zero, 0x1f\n"
      "ebreak\n"
      "srai zero, zero, 7\n"
      ".option pop"
      : "+r"(a0)
      : "r"(a1)
      : "memory");
  return a0;
#else
  register intptr_t r0 __asm__("r0") = static_cast<intptr_t>(call);
  register const void* r1 __asm__("r1") = block;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
#endif
}

}  // namespace softfocus::device
