#include "tools/cli/interrupts.h"

#ifndef _WIN32
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <string>
#endif

namespace softfocus {

#ifdef _WIN32

void prepare_interrupts() {}
RemovedByInterrupt::RemovedByInterrupt(const std::filesystem::path&) {}
RemovedByInterrupt::~RemovedByInterrupt() = default;

#else

namespace {

// A handler may neither lock nor allocate, so names stand in memory of their own.
enum class SlotState : int { free, being_written, set };
struct Slot {
  std::atomic<SlotState> state{SlotState::free};
  std::array<char, 4096> name{};
};
static_assert(std::atomic<SlotState>::is_always_lock_free);
std::array<Slot, 64> slots;

extern "C" void end_by_interrupt(int signal) {
  for (const Slot& slot : slots) {
    if (slot.state.load() == SlotState::set) ::unlink(slot.name.data());
  }
  // The handler was for one time: now the signal ends the program.
  ::raise(signal);
}

}  // namespace

void prepare_interrupts() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = end_by_interrupt;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    ::sigaction(signal, &action, nullptr);
  }
}

RemovedByInterrupt::RemovedByInterrupt(const std::filesystem::path& file) {
  const std::string& name = file.native();
  if (name.size() >= slots[0].name.size()) return;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    SlotState free = SlotState::free;
    if (!slots[i].state.compare_exchange_strong(free, SlotState::being_written)) continue;
    std::copy_n(name.c_str(), name.size() + 1, slots[i].name.data());
    slots[i].state.store(SlotState::set);
    slot_ = static_cast<int>(i);
    return;
  }
}

RemovedByInterrupt::~RemovedByInterrupt() {
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(SlotState::free);
}

#endif

}  // namespace softfocus
