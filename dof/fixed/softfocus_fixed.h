#ifndef SOFTFOCUS_FIXED_H
#define SOFTFOCUS_FIXED_H
/* The two-pass depth-of-field filter (Zhou, Chen and Pullen 2007) in integers, for C. It gives
 * the same bits on every machine; docs/fixed-point.md is its specification.
 *
 * Once for a lens, depth codes get a table of weights. Then rows of a picture go in from the
 * top, one by one, and come out `reach` rows later. The caller gives all memory; nothing is
 * allocated, no static data is written, no floating point is used.
 *
 *   softfocus_fixed_table8(&lens, near_um, far_um, table);
 *   softfocus_fixed_begin(&stream, &settings, table, memory, sizeof memory);
 *   for (y = 0; y < height; ++y)
 *     if (softfocus_fixed_put_row(&stream, y, colours, depths, out) == 1) show(out);
 *   while (softfocus_fixed_finish_row(&stream, out) == 1) show(out);
 *
 * Functions return 0 or a positive number if all went well. Otherwise they return one of the
 * negative codes below, and have written nothing. Qm.n has n bits after the point. */

#include <stddef.h>
#include <stdint.h>

/* NOLINTBEGIN(readability-identifier-naming): C's names */
#ifdef __cplusplus
extern "C" {
#endif

/* Limits. */
#define SOFTFOCUS_FIXED_LARGEST_SIZE 16384 /* of width and height, pixels; both from 1 */
#define SOFTFOCUS_FIXED_LARGEST_REACH 63   /* taps to each side: circles of radius 64 */
#define SOFTFOCUS_FIXED_ONE_PIXEL 65536    /* a pixel in Q16.16 */

enum {
  SOFTFOCUS_FIXED_BAD_SIZE = -1,    /* width, height or reach past the limits */
  SOFTFOCUS_FIXED_BAD_FORMAT = -2,  /* no such format, or not of this function */
  SOFTFOCUS_FIXED_BAD_LENS = -3,    /* a quantity of the lens past its limits */
  SOFTFOCUS_FIXED_BAD_TABLE = -4,   /* the table's circles are larger than the ring, or
                                       it was not made by this library */
  SOFTFOCUS_FIXED_BAD_MEMORY = -5,  /* too little memory, none, or not aligned to 4 */
  SOFTFOCUS_FIXED_BAD_ROW = -6,     /* not the row whose turn it is */
  SOFTFOCUS_FIXED_BAD_ARGUMENT = -7 /* a null pointer */
};

/* --- the lens --- */

/* A lens: at depth z the circle of confusion has the signed radius
 * radius_at_infinity * (z - focus) / z. */
typedef struct softfocus_fixed_lens {
  uint32_t radius_at_infinity; /* Q16.16 pixels */
  uint32_t focus_um;           /* from 1 */
  uint32_t largest_radius;     /* Q16.16 pixels, larger circles are cut to it; to 64 pixels */
  uint32_t leak;               /* Q16.16 per pixel of the receiver's radius: 65536 as usual;
                                  0, or 4096 (1/16) and more */
} softfocus_fixed_lens;

/* A camera, as its data sheet describes it. */
typedef struct softfocus_fixed_camera {
  uint32_t focal_length_um; /* 1 to 2^20 (1.05 m) */
  uint32_t f_number;        /* Q7.8: 512 is f/2; 1 to 2^15 - 1 */
  uint32_t focus_um;        /* more than the focal length */
  uint32_t film_height_um;  /* 1 to 2^17 (13 cm): the height that the picture shows */
  uint32_t height_px;       /* 1 to SOFTFOCUS_FIXED_LARGEST_SIZE */
} softfocus_fixed_camera;

/* Stores the radius of the horizon's circle in Q16.16 pixels, rounded to nearest:
 * f^2 height / (2 N (z_f - f) film_height). BAD_LENS past the limits, or if it is 65536
 * pixels or more. */
int softfocus_fixed_radius_at_infinity(const softfocus_fixed_camera* camera, uint32_t* radius);

/* --- the table from depth codes to weights --- */

/* What a pixel of some depth weighs. Made by the functions below, and only by them. */
typedef struct softfocus_fixed_weights {
  uint32_t whole; /* Q0.19: 1 / max(r, 1)^2, at distances 1 to reach - 1 and to itself */
  uint32_t edge;  /* Q0.19: whole * (r - reach), at distance `reach`; whole if that is 0 */
  uint16_t leak;  /* Q1.15: what it takes from beyond the focus, 0 to 32768 */
  uint8_t reach;  /* the farthest distance that it weighs at: ceil(r) - 1, or 0 */
  uint8_t beyond; /* 1 if it lies beyond the focus, else 0 */
} softfocus_fixed_weights;

/* Codes 0 to 255, or 0 to 65535, lie evenly from depth near_um to far_um, in micrometres:
 * z = near + floor((far - near) * code / largest code). Either end may be the larger.
 * Depth 0 has the largest circle. BAD_LENS if the lens is past its limits. */
int softfocus_fixed_table8(const softfocus_fixed_lens* lens, uint32_t near_um, uint32_t far_um,
                           softfocus_fixed_weights table[256]);
int softfocus_fixed_table16(const softfocus_fixed_lens* lens, uint32_t near_um, uint32_t far_um,
                            softfocus_fixed_weights table[65536]);

/* Codes are the bits of a half (binary16), depth in metres. NaN and the infinities have the
 * largest circle; only +infinity is beyond the focus. */
int softfocus_fixed_table_half(const softfocus_fixed_lens* lens,
                               softfocus_fixed_weights table[65536]);

/* --- the filter --- */

typedef enum softfocus_fixed_colour {
  SOFTFOCUS_FIXED_RGBA8 = 0,         /* bytes r, g, b, a; a goes through */
  SOFTFOCUS_FIXED_RGB565 = 1,        /* uint16_t, red in the high bits */
  SOFTFOCUS_FIXED_RGBA16F = 2,       /* 4 halves as uint16_t; a goes through. Colours that are
                                        infinite count as 65504 of their sign, NaN as 0. For
                                        softfocus_fixed_begin_half() */
  SOFTFOCUS_FIXED_RGB565_SWAPPED = 3 /* RGB565 with its two bytes swapped, as displays on
                                        SPI want it: LVGL's RGB565_SWAPPED */
} softfocus_fixed_colour;

typedef enum softfocus_fixed_depth {
  SOFTFOCUS_FIXED_DEPTH8 = 0,        /* uint8_t codes, a table of 256 */
  SOFTFOCUS_FIXED_DEPTH16 = 1,       /* uint16_t codes (halves too), a table of 65536 */
  SOFTFOCUS_FIXED_DEPTH_IN_ALPHA = 2 /* alpha of RGBA16F is the code, a table of 65536;
                                        `depths` of put_row is then not read */
} softfocus_fixed_depth;

typedef struct softfocus_fixed_settings {
  uint16_t width, height; /* pixels */
  uint8_t reach;          /* of the ring: ceil(largest_radius) - 1 of the lens, or more */
  uint8_t colour;         /* softfocus_fixed_colour */
  uint8_t depth;          /* softfocus_fixed_depth */
} softfocus_fixed_settings;

/* Bytes of memory that a stream needs: for 8-bit colour, and for RGBA16F. A constant where
 * its arguments are. `has_alpha` is 1 for RGBA8, 0 for either RGB565; `depth_bytes` 1 or 2. */
#define SOFTFOCUS_FIXED_ROUND_UP(bytes) (((bytes) + 3u) & ~(size_t)3u)
#define SOFTFOCUS_FIXED_MEMORY(width, reach, has_alpha, depth_bytes) \
  (SOFTFOCUS_FIXED_ROUND_UP((size_t)(width) * (2u * (reach) + 1u) *  \
                            (5u + (has_alpha) + (depth_bytes))) +    \
   20u * (size_t)(width) + 88u * (reach) + 68u + SOFTFOCUS_FIXED_ROUND_UP(4u * (reach) + 2u))
#define SOFTFOCUS_FIXED_MEMORY_HALF(width, reach)                                               \
  (SOFTFOCUS_FIXED_ROUND_UP((size_t)(width) * (2u * (reach) + 1u) * 11u) + 24u * (reach) + 4u + \
   SOFTFOCUS_FIXED_ROUND_UP(4u * (reach) + 2u))

/* The bytes that a stream of these settings needs; 0 if they are past the limits. */
size_t softfocus_fixed_memory(const softfocus_fixed_settings* settings);

/* A picture on its way. The caller owns it; its members are the filter's. */
typedef struct softfocus_fixed_stream {
  const softfocus_fixed_weights* table;
  uint8_t* memory;
  softfocus_fixed_settings settings;
  uint16_t rows_in, rows_out;
  uint8_t next_slot, leaking;
  void (*add_row)(struct softfocus_fixed_stream*, const void*, const void*);
  void (*write_row)(struct softfocus_fixed_stream*, void*);
} softfocus_fixed_stream;

/* Makes a stream ready for a picture of 8-bit colour. `bytes` of memory, aligned to 4 bytes,
 * and the table are the caller's; neither may change until the picture is done. BAD_SIZE,
 * BAD_FORMAT, BAD_TABLE, BAD_MEMORY or BAD_ARGUMENT. */
int softfocus_fixed_begin(softfocus_fixed_stream* stream, const softfocus_fixed_settings* settings,
                          const softfocus_fixed_weights* table, void* memory, size_t bytes);

/* softfocus_fixed_begin() for RGBA16F: a function of its own, so that a program for 8-bit colour
 * does not link both. */
int softfocus_fixed_begin_half(softfocus_fixed_stream* stream,
                               const softfocus_fixed_settings* settings,
                               const softfocus_fixed_weights* table, void* memory, size_t bytes);

/* Puts row y in; rows come in order, from 0. `colours` and `depths` are `width` pixels and codes.
 * Returns 1 if row y - reach was written to `out`, in the format of `colours`; 0 if no row is
 * ready. `out` may be `colours`. BAD_ROW if it is not the turn of row y. */
int softfocus_fixed_put_row(softfocus_fixed_stream* stream, uint32_t y, const void* colours,
                            const void* depths, void* out);

/* After the last row: returns 1 if another row was written to `out`, 0 if all are out.
 * BAD_ROW if rows are missing. */
int softfocus_fixed_finish_row(softfocus_fixed_stream* stream, void* out);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
