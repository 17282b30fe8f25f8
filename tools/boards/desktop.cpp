// The desktop, where the same program says what every byte should be.

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tools/boards/machine.h"

namespace softfocus::boards {
namespace {
std::vector<std::FILE*> files;

int open_file(const char* name, const char* mode) {
  std::FILE* const file = std::fopen(name, mode);
  if (file == nullptr) return -1;
  files.push_back(file);
  return static_cast<int>(files.size()) - 1;
}
}  // namespace

FreeMemory free_memory() {
  static std::vector<uint8_t> memory(std::size_t{1} << 24);
  return {memory.data(), memory.size()};
}

size_t static_bytes() { return 0; }
void paint_stack() {}
size_t deepest_stack_bytes() { return 0; }
void start_clock() {}
uint64_t instructions_executed() { return 0; }
uint32_t instructions_per_tick() { return 0; }
void loop_of_known_length(uint32_t) {}

int open_to_read(const char* name) { return open_file(name, "rb"); }
int open_to_write(const char* name) { return open_file(name, "wb"); }
bool read_bytes(int file, void* to, size_t bytes) {
  return std::fread(to, 1, bytes, files[static_cast<std::size_t>(file)]) == bytes;
}
bool write_bytes(int file, const void* from, size_t bytes) {
  return std::fwrite(from, 1, bytes, files[static_cast<std::size_t>(file)]) == bytes;
}

void report(const char* name, uint64_t value) {
  std::printf("%s %llu\n", name, static_cast<unsigned long long>(value));
}
void give_up(const char* why) {
  std::fprintf(stderr, "%s\n", why);
  leave(1);
}
void leave(int status) { std::exit(status); }

}  // namespace softfocus::boards

int main() { run_filter(); }
