// RISC-V: the first instructions, and the counter of retired instructions as the clock,
// which is exact to the instruction under `qemu -icount shift=0`.

#include "tools/boards/machine.h"

// The instructions on control registers are an extension since 2019.
__asm__(
    ".option arch, +zicsr\n"
    ".section .vectors, \"ax\"\n"
    ".globl first_instruction\n"
    "first_instruction:\n"
    ".option push\n"
    ".option norelax\n"
    "la gp, __global_pointer$\n"
    ".option pop\n"
    "la sp, stack_top\n"
    "la t0, fault_entry\n"
    "csrw mtvec, t0\n"
    "j begin_program\n"
    ".balign 4\n"
    "fault_entry:\n"
    "j stop_at_fault\n");

extern "C" [[noreturn]] __attribute__((used)) void stop_at_fault() {
  softfocus::boards::give_up("The processor took a fault");
}

namespace softfocus::boards {
namespace {

uint64_t retired() {
  uint32_t high, low, high_after;
  do {
    __asm__ volatile("csrr %0, minstreth" : "=r"(high));
    __asm__ volatile("csrr %0, minstret" : "=r"(low));
    __asm__ volatile("csrr %0, minstreth" : "=r"(high_after));
  } while (high != high_after);
  return uint64_t{high} << 32 | low;
}

uint64_t start;

}  // namespace

void start_clock() { start = retired(); }
uint64_t instructions_executed() { return retired() - start; }
uint32_t instructions_per_tick() { return 1; }

__attribute__((noinline)) void loop_of_known_length(uint32_t rounds) {
  __asm__ volatile(
      "1: addi %0, %0, -1\n"
      "bnez %0, 1b"
      : "+r"(rounds));
}

}  // namespace softfocus::boards
