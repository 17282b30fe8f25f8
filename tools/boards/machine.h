#pragma once
// The machine under the programs of this folder. Three kinds: Cortex-M and RISC-V without an
// operating system, which reach the desktop's files by semihosting, and the desktop itself. There
// are no standard libraries on the first two.

#include <stddef.h>
#include <stdint.h>

namespace softfocus::boards {

/// main()'s memory for buffers: everything between the variables and the deepest stack that is
/// allowed for.
struct FreeMemory {
  uint8_t* begin;
  size_t bytes;
};
FreeMemory free_memory();

/// Bytes of variables that are not constant, startup and run_filter.cpp included.
size_t static_bytes();

/// Fills the stack below the caller with a pattern; deepest_stack_bytes() then tells how
/// far from the top of memory it has been overwritten. 0 on the desktop.
void paint_stack();
size_t deepest_stack_bytes();

/// Instructions executed since start_clock(), to within instructions_per_tick() of them.
/// Must be called at least once in 670 million. 0 on the desktop.
void start_clock();
uint64_t instructions_executed();
uint32_t instructions_per_tick();

/// Executes 2 * `rounds` instructions, and at most five more.
void loop_of_known_length(uint32_t rounds);

/// Files in the folder where the desktop started the program; -1 if there is none.
int open_to_read(const char* name);
int open_to_write(const char* name);
/// Whether all bytes could be read or written.
bool read_bytes(int file, void* to, size_t bytes);
bool write_bytes(int file, const void* from, size_t bytes);

/// A line "name value" of the report.
void report(const char* name, uint64_t value);
/// A sentence on what went wrong; ends the program with status 1.
[[noreturn]] void give_up(const char* why);
[[noreturn]] void leave(int status);

}  // namespace softfocus::boards

/// The program; the startup code calls it.
void run_filter();
