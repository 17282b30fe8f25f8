// Cortex-M: the vector table, and SysTick as the clock.
//
// SysTick counts the processor's clock down, in 24 bits. Under `qemu -icount shift=0` an
// instruction takes exactly 1 ns of the machine's time, whatever its clock: a tick is
// 1000 / MHz instructions, 40 on the mps2 boards (25 MHz), 62.5 on the microbit (16 MHz).
// Reading it is exact to the tick: qemu ends a block of translated code where a device
// is read.

#include "tools/boards/machine.h"

extern "C" {
extern uint8_t stack_top[];
[[noreturn]] void begin_program();

/// The first instructions.
[[noreturn]] static void reset() {
#ifdef __ARM_FP
  // Coprocessors 10 and 11 for everybody: CPACR, Armv7-M Architecture Reference Manual, B3.2.
  *reinterpret_cast<volatile uint32_t*>(0xE000ED88) |= 0xFu << 20;
  __asm__ volatile("dsb\nisb");
#endif
  begin_program();
}

[[noreturn]] static void stop_at_fault() {
  softfocus::boards::give_up("The processor took a fault");
}

struct Vectors {
  const void* stack;
  void (*handlers[15])();
};
__attribute__((section(".vectors"))) extern const Vectors vectors;
const Vectors vectors = {
    stack_top,
    {reset, stop_at_fault, stop_at_fault, stop_at_fault, stop_at_fault, stop_at_fault,
     stop_at_fault, stop_at_fault, stop_at_fault, stop_at_fault, stop_at_fault, stop_at_fault,
     stop_at_fault, stop_at_fault, stop_at_fault}};
}

namespace softfocus::boards {
namespace {

constexpr uint32_t kCounterMask = 0xFFFFFF;

// Armv6-M Architecture Reference Manual, B3.3: control, reload value, current value.
volatile uint32_t& systick(unsigned word) {
  return reinterpret_cast<volatile uint32_t*>(0xE000E010)[word];
}

uint32_t last_count;
uint64_t ticks;

}  // namespace

void start_clock() {
  systick(1) = kCounterMask;
  systick(2) = 0;
  systick(0) = 5;  // counts the processor's clock, and interrupts nobody
  last_count = systick(2);
  ticks = 0;
}

uint64_t instructions_executed() {
  const uint32_t count = systick(2);
  ticks += (last_count - count) & kCounterMask;
  last_count = count;
  return ticks * 1000 / SOFTFOCUS_CLOCK_MHZ;
}

uint32_t instructions_per_tick() { return (1000 + SOFTFOCUS_CLOCK_MHZ - 1) / SOFTFOCUS_CLOCK_MHZ; }

__attribute__((noinline)) void loop_of_known_length(uint32_t rounds) {
  __asm__ volatile(
      ".syntax unified\n"
      "1: subs %0, #1\n"
      "bne 1b"
      : "+l"(rounds)
      :
      : "cc");
}

}  // namespace softfocus::boards
