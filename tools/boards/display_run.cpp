// docs/examples/blur_display.c on a board: what it sends to its display is the file "filtered".

#include "tools/boards/machine.h"

extern "C" int draw_frame();
extern "C" void send_to_display(const void* bytes, size_t count);

static int display;

void send_to_display(const void* bytes, size_t count) {
  if (!softfocus::boards::write_bytes(display, bytes, count)) {
    softfocus::boards::give_up("The file \"filtered\" cannot be written");
  }
}

void run_filter() {
  display = softfocus::boards::open_to_write("filtered");
  if (display < 0 || draw_frame() != 0) softfocus::boards::give_up("There is no display, or lens");
}
