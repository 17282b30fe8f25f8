/* blur_buffer.cpp again, in C: depth of field on a picture in memory, by the shared library.
 * Prints the same hash.
 *     cc -std=c99 refocus_frame.c $(pkg-config --cflags --libs softfocus) -o refocus_frame
 */
#include <softfocus/softfocus.h>
#include <stdio.h>

enum { kWidth = 250, kHeight = 130 };

static float rgb[kHeight][kWidth][3], depth_m[kHeight][kWidth];
static uint16_t halves[kHeight][kWidth][4];
static unsigned char bytes[kHeight][kWidth][3];

/* The program's own picture: tiles that recede from 1 to 9 metres, linear light. */
static void draw(void) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float light = ((x ^ y) & 16) != 0 ? 4.0f : 0.25f;
      rgb[y][x][0] = light;
      rgb[y][x][1] = light * 0.5f;
      rgb[y][x][2] = (float)x / 256.0f;
      depth_m[y][x] = 1.0f + (float)x / 32.0f;
    }
  }
}

static uint64_t add_to_hash(uint64_t hash, unsigned value) { /* FNV-1a */
  return (hash ^ value) * 1099511628211u;
}

int main(void) {
  const softfocus_picture picture = {.struct_size = sizeof picture,
                                     .width = kWidth,
                                     .height = kHeight,
                                     .colour_type = SOFTFOCUS_FLOAT,
                                     .red = &rgb[0][0][0],
                                     .green = &rgb[0][0][1],
                                     .blue = &rgb[0][0][2],
                                     .pixel_bytes = sizeof rgb[0][0],
                                     .row_bytes = sizeof rgb[0],
                                     .depth_type = SOFTFOCUS_FLOAT,
                                     .depth = depth_m,
                                     .depth_pixel_bytes = sizeof depth_m[0][0],
                                     .depth_row_bytes = sizeof depth_m[0]};
  const softfocus_target linear = {.struct_size = sizeof linear, /* with the depth in alpha */
                                   .colour_type = SOFTFOCUS_HALF,
                                   .red = &halves[0][0][0],
                                   .green = &halves[0][0][1],
                                   .blue = &halves[0][0][2],
                                   .pixel_bytes = sizeof halves[0][0],
                                   .row_bytes = sizeof halves[0],
                                   .depth_type = SOFTFOCUS_HALF,
                                   .depth = &halves[0][0][3],
                                   .depth_pixel_bytes = sizeof halves[0][0],
                                   .depth_row_bytes = sizeof halves[0]};
  const softfocus_target display = {.struct_size = sizeof display, /* bytes to show */
                                    .colour_type = SOFTFOCUS_SRGB8,
                                    .red = &bytes[0][0][0],
                                    .green = &bytes[0][0][1],
                                    .blue = &bytes[0][0][2],
                                    .pixel_bytes = sizeof bytes[0][0],
                                    .row_bytes = sizeof bytes[0]};
  draw();
  softfocus_settings settings; /* 85 mm, f/2, focused at 3 m; 30 degrees high */
  softfocus_init_settings(&settings, sizeof settings);
  settings.focal_length_mm = 85.0;
  settings.focus_m = 3.0;
  settings.fov_y_degrees = 30.0;
  settings.max_radius_px = 16.0;

  softfocus_context* context;
  if (softfocus_open(&context, 0) != SOFTFOCUS_OK) return 1;
  if (softfocus_refocus(context, &picture, &settings, &linear, NULL) != SOFTFOCUS_OK ||
      softfocus_refocus(context, &picture, &settings, &display, NULL) != SOFTFOCUS_OK) {
    fprintf(stderr, "%s\n", softfocus_message(context));
    softfocus_close(context);
    return 1;
  }
  softfocus_close(context);

  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i < sizeof halves / 2; ++i) hash = add_to_hash(hash, (&halves[0][0][0])[i]);
  for (size_t i = 0; i < sizeof bytes; ++i) hash = add_to_hash(hash, (&bytes[0][0][0])[i]);
  printf("%08lx%08lx\n", (unsigned long)(hash >> 32), (unsigned long)(hash & 0xFFFFFFFFu));
  return 0;
}
