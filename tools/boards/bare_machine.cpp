// Shared by Cortex-M and RISC-V: memory as memory.ld lays it out, and files by semihosting.

#include "tools/boards/machine.h"

extern "C" {
// Places in memory.ld; their addresses are what counts.
extern uint8_t variables_begin[], variables_end[], stack_limit[], stack_top[];

/// Comes from the first instruction, with the stack at its top.
[[noreturn]] void begin_program() {
  for (uint8_t* byte = variables_begin; byte != variables_end; ++byte) *byte = 0;
  run_filter();
  softfocus::boards::leave(0);
}
}

namespace softfocus::boards {
namespace {

// Semihosting: requests to the debugger or emulator that a bare machine hangs on. An operation
// has a number and a block of words; the answer is a word. "Semihosting for AArch32 and AArch64",
// Arm, and "RISC-V Semihosting".
enum class HostCall : uint32_t {
  open = 0x01,
  write_text = 0x04,
  write = 0x05,
  read = 0x06,
  exit_extended = 0x20,
};

intptr_t ask_host(HostCall call, const void* block) {
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

constexpr uint8_t kPaint = 0xA5;

size_t text_length(const char* text) {
  size_t length = 0;
  while (text[length] != 0) ++length;
  return length;
}

int open_file(const char* name, uintptr_t mode) {
  const uintptr_t block[] = {reinterpret_cast<uintptr_t>(name), mode, text_length(name)};
  return static_cast<int>(ask_host(HostCall::open, block));
}

}  // namespace

FreeMemory free_memory() {
  return {variables_end, static_cast<size_t>(stack_limit - variables_end)};
}

size_t static_bytes() { return static_cast<size_t>(variables_end - variables_begin); }

__attribute__((noinline)) void paint_stack() {
  // 64 bytes are left for this function's own frame.
  auto* const top = static_cast<uint8_t*>(__builtin_frame_address(0)) - 64;
  for (volatile uint8_t* byte = stack_limit; byte < top; ++byte) *byte = kPaint;
}

size_t deepest_stack_bytes() {
  const volatile uint8_t* byte = stack_limit;
  while (byte < stack_top && *byte == kPaint) ++byte;
  return static_cast<size_t>(stack_top - byte);
}

int open_to_read(const char* name) { return open_file(name, 1); }   // "rb"
int open_to_write(const char* name) { return open_file(name, 5); }  // "wb"

// Both answer with the number of bytes that are still to do.
bool read_bytes(int file, void* to, size_t bytes) {
  const uintptr_t block[] = {static_cast<uintptr_t>(file), reinterpret_cast<uintptr_t>(to), bytes};
  return ask_host(HostCall::read, block) == 0;
}
bool write_bytes(int file, const void* from, size_t bytes) {
  const uintptr_t block[] = {static_cast<uintptr_t>(file), reinterpret_cast<uintptr_t>(from),
                             bytes};
  return ask_host(HostCall::write, block) == 0;
}

void report(const char* name, uint64_t value) {
  char digits[24];
  char* first = digits + sizeof digits;
  *--first = 0;
  *--first = '\n';
  for (; value > 9; value /= 10) *--first = static_cast<char>('0' + value % 10);
  *--first = static_cast<char>('0' + value);
  *--first = ' ';
  ask_host(HostCall::write_text, name);
  ask_host(HostCall::write_text, first);
}

void give_up(const char* why) {
  ask_host(HostCall::write_text, why);
  ask_host(HostCall::write_text, "\n");
  leave(1);
}

void leave(int status) {
  constexpr uintptr_t kApplicationExit = 0x20026;
  const uintptr_t block[] = {kApplicationExit, static_cast<uintptr_t>(status)};
  for (;;) ask_host(HostCall::exit_extended, block);
}

}  // namespace softfocus::boards
