/* Blurs a frame by its depth, without a floating-point number: a checkerboard in RGB565, near on
 * the left and far on the right, through a 50 mm lens at f/1 that is focused on its middle. What
 * a camera would send goes in row by row, and rows come out 7 rows later. Writes a .ppm picture
 * to standard output:
 *     cc -std=c99 -I. -c docs/examples/blur_frame.c
 *     c++ -std=c++20 -I. -o blur_frame blur_frame.o $(find dof/fixed -name '*.cpp')
 *     ./blur_frame > frame.ppm
 */
#include <stdio.h>

#include "dof/fixed/softfocus_fixed.h"

enum { kWidth = 160, kHeight = 120, kReach = 7 /* of circles of radius 8: 8 - 1 */ };

/* All the memory there is: 15 rows, the table, a row of the picture and of its depth. */
static uint32_t ring[(SOFTFOCUS_FIXED_MEMORY(kWidth, kReach, 0, 1) + 3) / 4];
static softfocus_fixed_weights table[256];
static uint16_t colours[kWidth];
static uint8_t depths[kWidth];

static void next_row(int y) { /* in the place of a camera */
  for (int x = 0; x < kWidth; ++x) {
    colours[x] = ((x >> 3) + (y >> 3)) % 2 != 0 ? 0xFFFF : 0x21A8;
    depths[x] = (uint8_t)(x * 255 / (kWidth - 1));
  }
}

static void show_row(void) { /* in the place of a display */
  for (int x = 0; x < kWidth; ++x) {
    const int r = colours[x] >> 11, g = colours[x] >> 5 & 63, b = colours[x] & 31;
    putchar(r << 3 | r >> 2), putchar(g << 2 | g >> 4), putchar(b << 3 | b >> 2);
  }
}

int main(void) {
  const softfocus_fixed_camera camera = {50000, 1 << 8, 1500000, 37600, kHeight};
  softfocus_fixed_lens lens = {0, camera.focus_um, 8 * SOFTFOCUS_FIXED_ONE_PIXEL,
                               SOFTFOCUS_FIXED_ONE_PIXEL};
  const softfocus_fixed_settings settings = {kWidth, kHeight, kReach, SOFTFOCUS_FIXED_RGB565,
                                             SOFTFOCUS_FIXED_DEPTH8};
  softfocus_fixed_stream stream;
  if (softfocus_fixed_radius_at_infinity(&camera, &lens.radius_at_infinity) < 0 ||
      softfocus_fixed_table8(&lens, 500000, 2500000, table) < 0 || /* from 0.5 m to 2.5 m */
      softfocus_fixed_begin(&stream, &settings, table, ring, sizeof ring) < 0) {
    return 1;
  }
  printf("P6 %d %d 255\n", kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    next_row(y);
    if (softfocus_fixed_put_row(&stream, (uint32_t)y, colours, depths, colours) == 1) show_row();
  }
  while (softfocus_fixed_finish_row(&stream, colours) == 1) show_row();
  return 0;
}
