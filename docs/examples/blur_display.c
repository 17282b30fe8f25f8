/* Between LVGL and a display on SPI: blurs by depth what is drawn, strip by strip, on its way out.
 * With LVGL flush() is the callback of lv_display_set_flush_cb() and ends with
 * lv_display_flush_ready(); the display is RGB565_SWAPPED in partial render mode, with strips as
 * wide as it. lv_obj_invalidate() of the screen before each frame makes them come from the top.
 * Here a checkerboard of 160x120, near on the left, stands in for widgets, and the program says
 * where bytes go: tools/boards/display_run.cpp runs it on emulated boards. */
#include "dof/fixed/softfocus_fixed.h"

#ifdef __cplusplus
extern "C" {
#endif
void send_to_display(const void* bytes, size_t count); /* what the display is driven by */
int draw_frame(void); /* not 0: the lens is refused, or a strip that is not the next */
#ifdef __cplusplus
}
#endif

enum { kWidth = 160, kHeight = 120, kStrip = 10, kReach = 7 /* of circles of radius 8: 8 - 1 */ };

typedef struct area { /* both ends inside */
  int32_t x1, y1, x2, y2;
} area;

static uint32_t ring[(SOFTFOCUS_FIXED_MEMORY(kWidth, kReach, 0, 1) + 3) / 4];
static softfocus_fixed_weights table[256];
static softfocus_fixed_stream stream;
static uint16_t strip[kStrip * kWidth]; /* LVGL's draw buffer */
static uint8_t depths[kWidth];          /* of a row: whatever the program knows of its widgets */
static int refused;

/* The bytes of a row are sent from where it was drawn: rows come out 7 later. */
static void flush(const area* drawn, uint8_t* pixels) {
  for (int32_t y = drawn->y1; y <= drawn->y2; ++y, pixels += 2 * kWidth) {
    const int put = softfocus_fixed_put_row(&stream, (uint32_t)y, pixels, depths, pixels);
    if (put == 1) send_to_display(pixels, 2 * kWidth);
    if (put < 0) refused = 1;
  }
  if (drawn->y2 < kHeight - 1) return; /* lv_display_flush_is_last() */
  while (softfocus_fixed_finish_row(&stream, strip) == 1) send_to_display(strip, 2 * kWidth);
}

int draw_frame(void) {
  const softfocus_fixed_camera camera = {50000, 1 << 8, 1500000, 37600, kHeight};
  softfocus_fixed_lens lens = {0, camera.focus_um, 8 * SOFTFOCUS_FIXED_ONE_PIXEL,
                               SOFTFOCUS_FIXED_ONE_PIXEL};
  const softfocus_fixed_settings settings = {
      kWidth, kHeight, kReach, SOFTFOCUS_FIXED_RGB565_SWAPPED, SOFTFOCUS_FIXED_DEPTH8};
  if (softfocus_fixed_radius_at_infinity(&camera, &lens.radius_at_infinity) < 0 ||
      softfocus_fixed_table8(&lens, 500000, 2500000, table) < 0 || /* from 0.5 m to 2.5 m */
      softfocus_fixed_begin(&stream, &settings, table, ring, sizeof ring) < 0) {
    return 1;
  }
  for (int x = 0; x < kWidth; ++x) depths[x] = (uint8_t)(x * 255 / (kWidth - 1));
  for (int32_t y = 0; y < kHeight; y += kStrip) {
    const area drawn = {0, y, kWidth - 1, y + kStrip - 1};
    for (int i = 0; i < kStrip * kWidth; ++i) {
      strip[i] = ((i % kWidth >> 3) + ((y + i / kWidth) >> 3)) % 2 != 0 ? 0xFFFF : 0xA821;
    }
    flush(&drawn, (uint8_t*)strip);
  }
  return refused;
}
