#ifndef SOFTFOCUS_H
#define SOFTFOCUS_H
/* Depth of field on pictures with depth, and shaders on the emulated GPU, for C and for languages
 * that call C. The bits of a result are those of apply() in dof/dof.h and of run_shader() in
 * raster/shaders/shader.h: they depend on the input alone, not on threads, processor or compiler.
 * docs/embedding.md has examples in C and Python.
 *
 *   softfocus_context* context;
 *   if (softfocus_open(&context, 0) != SOFTFOCUS_OK) return 1;
 *   softfocus_settings settings;
 *   softfocus_init_settings(&settings, sizeof settings);
 *   settings.f_number = 1.4;
 *   softfocus_picture picture = {.struct_size = sizeof picture, ...};  // the caller's memory
 *   softfocus_target target = {.struct_size = sizeof target, ...};     // where the result goes
 *   if (softfocus_refocus(context, &picture, &settings, &target, NULL) != SOFTFOCUS_OK)
 *     puts(softfocus_message(context));
 *   softfocus_close(context);
 *
 * Later versions have longer structs. So each begins with its size. Settings start from
 * softfocus_init_settings(), the other structs from zeros. A library refuses a field that it does
 * not know, unless that is 0. */

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__) && !defined(_WIN32)
#define SOFTFOCUS_API __attribute__((visibility("default")))
#else
#define SOFTFOCUS_API
#endif

/* NOLINTBEGIN(readability-identifier-naming): C's names */
#ifdef __cplusplus
extern "C" {
#endif

/* Limits. */
#define SOFTFOCUS_LARGEST_SIZE 16384  /* of width and height, pixels; both from 1 */
#define SOFTFOCUS_LARGEST_RADIUS 1024 /* of a circle of confusion, pixels */
#define SOFTFOCUS_MOST_THREADS 256
#define SOFTFOCUS_MOST_BEHIND 3      /* layers behind the first */
#define SOFTFOCUS_MOST_TRANSPARENT 4 /* layers before it */
#define SOFTFOCUS_MOST_TARGETS 8     /* of a shader */

/* What functions return. */
enum softfocus_status {
  SOFTFOCUS_OK = 0,
  SOFTFOCUS_BAD_ARGUMENT = 1, /* nothing was written; softfocus_message() says what is wrong */
  SOFTFOCUS_NO_MEMORY = 2,    /* the target may be written in part */
  SOFTFOCUS_FAILED = 3,       /* likewise; a bug in the library */
  SOFTFOCUS_BAD_SHADER = 4    /* likewise; the message names the shader's file and line */
};

/* How a number is stored. */
enum softfocus_type {
  SOFTFOCUS_HALF = 1,   /* binary16 */
  SOFTFOCUS_FLOAT = 2,  /* binary32 */
  SOFTFOCUS_UNORM8 = 3, /* 0 to 255 for 0 to 1, linear */
  SOFTFOCUS_SRGB8 = 4   /* 0 to 255 along the sRGB curve */
};

enum softfocus_stage { SOFTFOCUS_FRAGMENT = 1, SOFTFOCUS_VERTEX = 2 };

/* Texels of textures and targets. */
enum softfocus_format {
  SOFTFOCUS_FORMAT_R8 = 1,      /* 8-bit unsigned normalised */
  SOFTFOCUS_FORMAT_RGBA8 = 2,   /* likewise */
  SOFTFOCUS_FORMAT_SRGB8 = 3,   /* 8-bit sRGB, and a linear alpha */
  SOFTFOCUS_FORMAT_RGBA16F = 4, /* binary16 */
  SOFTFOCUS_FORMAT_R32F = 5,    /* binary32 */
  SOFTFOCUS_FORMAT_RGBA32F = 6, /* likewise */
  SOFTFOCUS_FORMAT_RGBA32I = 7, /* for ivec4 */
  SOFTFOCUS_FORMAT_RGBA32UI = 8 /* for uvec4 */
};

enum softfocus_filter {
  SOFTFOCUS_NEAREST = 1,
  SOFTFOCUS_BILINEAR = 2,
  SOFTFOCUS_TRILINEAR = 3 /* smaller levels are made */
};

enum softfocus_wrap { SOFTFOCUS_REPEAT = 1, SOFTFOCUS_MIRROR = 2, SOFTFOCUS_CLAMP = 3 };

/* What a shadow sampler gives 1 for: of the reference, to the texel. */
enum softfocus_compare {
  SOFTFOCUS_NEVER = 1,
  SOFTFOCUS_LESS = 2,
  SOFTFOCUS_EQUAL = 3,
  SOFTFOCUS_LESS_EQUAL = 4,
  SOFTFOCUS_GREATER = 5,
  SOFTFOCUS_NOT_EQUAL = 6,
  SOFTFOCUS_GREATER_EQUAL = 7,
  SOFTFOCUS_ALWAYS = 8
};

/* Threads, and the message of the last error. Calls on one context wait for each other. It does not
 * outlive fork(). */
typedef struct softfocus_context softfocus_context;

/* A picture in the caller's memory. Each pointer leads to the value of the top left pixel; the
 * right neighbour's lies `pixel_bytes` on, the one below `row_bytes`, both of either sign. Nothing
 * need be aligned. Numbers pass through halves: of colours those beyond 65504 become infinite;
 * depths beyond it, infinity too, are 65504 m and have the horizon's circle.
 *
 * Colour interleaved as halves with the depth behind it, 8 bytes a pixel and aligned to 2, is read
 * where it lies if no depth is infinite; anything else is copied first. */
typedef struct softfocus_picture {
  size_t struct_size; /* sizeof(softfocus_picture) */
  int32_t width;      /* pixels */
  int32_t height;
  const void* red; /* linear light, unless SOFTFOCUS_SRGB8 */
  const void* green;
  const void* blue;
  ptrdiff_t pixel_bytes;
  ptrdiff_t row_bytes;
  const void* depth; /* metres along the camera's axis */
  ptrdiff_t depth_pixel_bytes;
  ptrdiff_t depth_row_bytes;
  int32_t colour_type; /* SOFTFOCUS_HALF, FLOAT, UNORM8 or SRGB8 */
  int32_t depth_type;  /* SOFTFOCUS_HALF or FLOAT */

  /* What some methods make use of; null if it is not known. */
  const uint16_t* objects; /* the object that each pixel shows, row by row: object-identification */
  const float* radii_px; /* signed radii in place of the lens's, likewise: generalised-diffusion */
  /* What lies behind the surface that each pixel shows, then behind that, and so on; where nothing
   * does, the background again: layered. Pictures of the same size. */
  const struct softfocus_picture* const* behind;
  /* Transparent surfaces before the picture, the nearest first: colours times opacity, and depths,
   * the picture's where there is no surface. And as many pictures whose colours are the opacity, 0
   * to 1; their depths are not read. For every method. */
  const struct softfocus_picture* const* transparent;
  const struct softfocus_picture* const* opacity;
  int32_t behind_count;      /* 0 to SOFTFOCUS_MOST_BEHIND */
  int32_t transparent_count; /* 0 to SOFTFOCUS_MOST_TRANSPARENT */
} softfocus_picture;

/* Where a picture of that size goes, also over what is read. Nothing between the values is written,
 * such as an alpha of the caller's.
 */
typedef struct softfocus_target {
  size_t struct_size; /* sizeof(softfocus_target) */
  void* red;
  void* green;
  void* blue;
  ptrdiff_t pixel_bytes;
  ptrdiff_t row_bytes;
  void* depth; /* the picture's, rounded to halves; or null */
  ptrdiff_t depth_pixel_bytes;
  ptrdiff_t depth_row_bytes;
  int32_t colour_type; /* as of a picture */
  int32_t depth_type;
} softfocus_target;

/* The lens and how to blur. softfocus_init_settings() sets what stands in brackets. */
typedef struct softfocus_settings {
  size_t struct_size;
  const char* method;  /* of softfocus_method_name(), or "auto": the cheapest filter whose error is
                          within max_error [two-pass] */
  const char* profile; /* arithmetic, of softfocus_profile_name() [ieee] */
  double focal_length_mm;     /* [50] */
  double f_number;            /* [2] */
  double focus_m;             /* the distance in focus, metres [2] */
  double sensor_width_mm;     /* the picture is the largest part of its shape, upright if it is */
  double sensor_height_mm;    /* [36 x 24] */
  double fov_y_degrees;       /* the vertical field of view, in place of a sensor; 0: none [0] */
  double coc_scale;           /* exaggerates the circles [1] */
  double blur_at_infinity_px; /* in place of lens and sensor, the radius of the circle of what is
                                 infinitely far; 0: none [0] */
  double max_radius_px; /* larger circles are cut to it; 0: the picture's largest circle [0] */
  double leak;          /* how readily a background gives colour to what lies before it [1] */
  double budget;        /* of importance-ordered, 0 to 1 [0.25] */
  double max_error;     /* of auto, mean FLIP [0.02] */
} softfocus_settings;

/* What was used. */
typedef struct softfocus_report {
  size_t struct_size;
  const char* method;           /* that filters: what auto picked. Never freed */
  double radius_at_infinity_px; /* the lens as one number: at depth z a circle has the signed radius
                                   radius_at_infinity_px * (z - focus_m) / z */
  double largest_radius_px;     /* of the picture's circles, to SOFTFOCUS_LARGEST_RADIUS */
  double max_radius_px;         /* that circles are cut to */
  double share_cut;             /* of the pixels, 0 to 1, whose circle is larger */
  double predicted_error;       /* of auto, mean FLIP; else 0 */
} softfocus_report;

/* --- shaders (docs/shaders.md) --- */

/* What a shader is compiled from: a text or words. */
typedef struct softfocus_shader_source {
  size_t struct_size;    /* sizeof(softfocus_shader_source) */
  int32_t stage;         /* of a text, a softfocus_stage */
  const char* text;      /* GLSL, UTF-8; or null */
  const uint32_t* words; /* SPIR-V; or null */
  size_t word_count;
  const char* name;       /* for messages; null: "shader" */
  const char* convention; /* "plain", "shadertoy", "three", "libretro" or "gl-transitions"; null:
                             recognised by the text */
  const char* const* defines; /* macros, "NAME" or "NAME=VALUE" */
  size_t define_count;
  /* The text of a file that #include names; null: there is none. `path` begins with `name`'s
   * folder, if that has one. The text is copied before the next call, and the callback must not
   * use the context. May be null: then nothing is included. */
  const char* (*read_include)(void* user, const char* path);
  void* user;
} softfocus_shader_source;

/* A compiled shader with the uniforms and textures that were set. One thread at a time may use it.
 * It may outlive its context. */
typedef struct softfocus_shader softfocus_shader;

/* Rows of texels in the caller's memory, the first with v = 0 and the smallest gl_FragCoord.y.
 * Aligned to a channel. */
typedef struct softfocus_texels {
  size_t struct_size; /* sizeof(softfocus_texels) */
  int32_t width;      /* texels */
  int32_t height;
  int32_t format; /* a softfocus_format */
  void* first;
  ptrdiff_t row_bytes;   /* from a row to the next, of either sign; 0: without a gap */
  int32_t slices;        /* of a texture to read: layers, slices of a volume, or the six faces of a
                            cube, +x, -x, +y, -y, +z, -z; 0: one */
  ptrdiff_t slice_bytes; /* from a slice to the next, of either sign; 0: without a gap */
} softfocus_texels;

/* How a texture is sampled. What is 0 is as stands in brackets. */
typedef struct softfocus_sampler {
  size_t struct_size; /* sizeof(softfocus_sampler) */
  int32_t filter;     /* a softfocus_filter [SOFTFOCUS_BILINEAR] */
  int32_t wrap_u;     /* a softfocus_wrap [SOFTFOCUS_REPEAT] */
  int32_t wrap_v;
  int32_t compare; /* a softfocus_compare [SOFTFOCUS_LESS_EQUAL] */
  int32_t wrap_w;  /* of a volume */
} softfocus_sampler;

/* What vertices are given at an input of a vertex shader. */
typedef struct softfocus_attribute {
  size_t struct_size;  /* sizeof(softfocus_attribute) */
  const char* name;    /* of the input */
  const void* first;   /* of vertex 0: numbers of 32 bits, floats or whole ones as the shader has
                          them, matrices column by column */
  size_t vertex_bytes; /* from a vertex to the next; 0: without a gap */
  int32_t numbers;     /* of a vertex; those of a vector that are left out are 0, 0, 0, 1 */
} softfocus_attribute;

/* Triangles. */
typedef struct softfocus_vertices {
  size_t struct_size;                           /* sizeof(softfocus_vertices) */
  const softfocus_attribute* const* attributes; /* inputs that are not among them are 0, 0, 0, 1 */
  int32_t attribute_count;
  int32_t vertex_count;
  const uint32_t* indices; /* three a triangle; null: 0, 1, 2 and so on */
  size_t index_count;
} softfocus_vertices;

/* Where a shader draws. */
typedef struct softfocus_pass {
  size_t struct_size;                     /* sizeof(softfocus_pass) */
  const softfocus_texels* const* targets; /* by location, null where there is none; of one size */
  int32_t target_count;                   /* 1 to SOFTFOCUS_MOST_TARGETS */
  const char* profile; /* arithmetic, of softfocus_profile_name(); null: "ieee" */
  uint64_t budget;     /* turns of loops that a batch of pixels may take; 0: 16777216 */
} softfocus_pass;

/* The library's, "0.1.0". */
SOFTFOCUS_API const char* softfocus_version(void);

/* Methods and profiles by number, from 0; null past the last. */
SOFTFOCUS_API const char* softfocus_method_name(size_t index);
SOFTFOCUS_API const char* softfocus_method_summary(size_t index);
SOFTFOCUS_API const char* softfocus_profile_name(size_t index);
SOFTFOCUS_API const char* softfocus_profile_summary(size_t index);

/* A context with so many threads, the calling one among them; 0: all that the machine has. The
 * context is null if the call fails. It keeps the memory that methods work in until it is closed:
 * the next picture of the same size is made faster. */
SOFTFOCUS_API int softfocus_open(softfocus_context** context, int threads);

/* Frees a context; a null one is none. */
SOFTFOCUS_API void softfocus_close(softfocus_context* context);

/* One sentence about the error of the context's last call, or "". Until the next call. */
SOFTFOCUS_API const char* softfocus_message(const softfocus_context* context);

/* Settings of that size with the library's defaults. */
SOFTFOCUS_API void softfocus_init_settings(softfocus_settings* settings, size_t struct_size);

/* The picture as the lens makes it, into the target. `report` may be null. */
SOFTFOCUS_API int softfocus_refocus(softfocus_context* context, const softfocus_picture* picture,
                                    const softfocus_settings* settings,
                                    const softfocus_target* target, softfocus_report* report);

/* What softfocus_refocus() would use: checks everything and filters nothing. */
SOFTFOCUS_API int softfocus_plan(softfocus_context* context, const softfocus_picture* picture,
                                 const softfocus_settings* settings, softfocus_report* report);

/* Compiles a shader, once for many runs. It is null if the call fails. */
SOFTFOCUS_API int softfocus_compile_shader(softfocus_context* context,
                                           const softfocus_shader_source* source,
                                           softfocus_shader** shader);

/* Frees a shader; a null one is none. */
SOFTFOCUS_API void softfocus_free_shader(softfocus_shader* shader);

/* A shader's uniforms by number, from 0, textures among them; null past the last. Members are
 * "light.colour", "lights[1].colour". */
SOFTFOCUS_API const char* softfocus_uniform_name(const softfocus_shader* shader, size_t index);

/* Sets a uniform: `count` numbers, whatever its type; matrices column by column, arrays element by
 * element; "name[2]": from that element on. What is not set is 0, or what the shader says. The next
 * run compiles the uniforms into the program, in some milliseconds. */
SOFTFOCUS_API int softfocus_set_uniform(softfocus_context* context, softfocus_shader* shader,
                                        const char* name, const double* numbers, size_t count);

/* From now on runs are given the uniform, and setting it compiles nothing: for one that changes
 * from run to run of small pictures. The program is somewhat slower, and its bits are the same. An
 * array is late as a whole. Linking, if any, comes first. */
SOFTFOCUS_API int softfocus_make_uniform_late(softfocus_context* context, softfocus_shader* shader,
                                              const char* name);

/* Sets a texture: copies the texels. One that is not set reads as 0. `sampler` may be null. */
SOFTFOCUS_API int softfocus_set_texture(softfocus_context* context, softfocus_shader* shader,
                                        const char* name, const softfocus_texels* texels,
                                        const softfocus_sampler* sampler);

/* Runs a fragment shader at every pixel of the targets, with gl_FragCoord (x + 1/2, y + 1/2, 1/2,
 * 1); its inputs are the place: u, v from 0 to 1. What it discards stays. */
SOFTFOCUS_API int softfocus_run_shader(softfocus_context* context, softfocus_shader* shader,
                                       const softfocus_pass* pass);

/* Joins a vertex and a fragment shader: an input of the fragment shader gets the location of the
 * output of that name. Once, before their uniforms are set. */
SOFTFOCUS_API int softfocus_link_shaders(softfocus_context* context, softfocus_shader* vertex,
                                         softfocus_shader* fragment);

/* Draws triangles over the targets as OpenGL does: y upwards, the first row of the targets the
 * lowest. */
SOFTFOCUS_API int softfocus_draw_shaders(softfocus_context* context, softfocus_shader* vertex,
                                         softfocus_shader* fragment,
                                         const softfocus_vertices* vertices,
                                         const softfocus_pass* pass);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */

#endif
