/* shade_buffer.cpp again, in C: a shader on a picture in memory, by the shared library. Prints the
 * same hash.
 *     cc -std=c99 shade_frame.c $(pkg-config --cflags --libs softfocus) -o shade_frame
 */
#include <softfocus/softfocus.h>
#include <stdio.h>
#include <string.h>

enum { kWidth = 250, kHeight = 130 };

static unsigned char picture[kHeight][kWidth][4];
static float result[kHeight][kWidth][4];

static const char* const kShader =
    "#version 330\n"
    "uniform sampler2D picture;\n"
    "uniform float strength;\n"
    "out vec4 colour;\n"
    "void main() {\n"
    "  vec2 at = gl_FragCoord.xy / vec2(textureSize(picture, 0));\n"
    "  vec2 from_middle = at - 0.5;\n"
    "  colour = texture(picture, at) * (1.0 - strength * dot(from_middle, from_middle));\n"
    "}\n";

static uint64_t add_to_hash(uint64_t hash, uint32_t value) { /* FNV-1a */
  return (hash ^ value) * 1099511628211u;
}

int main(void) {
  const softfocus_shader_source source = {.struct_size = sizeof source,
                                          .stage = SOFTFOCUS_FRAGMENT,
                                          .text = kShader,
                                          .name = "corners.frag"};
  const softfocus_texels from = {.struct_size = sizeof from,
                                 .width = kWidth,
                                 .height = kHeight,
                                 .format = SOFTFOCUS_FORMAT_RGBA8,
                                 .first = picture};
  const softfocus_texels to = {.struct_size = sizeof to,
                               .width = kWidth,
                               .height = kHeight,
                               .format = SOFTFOCUS_FORMAT_RGBA32F,
                               .first = result};
  const softfocus_texels* const targets[] = {&to};
  const softfocus_pass pass = {.struct_size = sizeof pass, .targets = targets, .target_count = 1};
  const double strength = 1.5;
  uint64_t hash = 14695981039346656037u;
  softfocus_shader* shader = NULL;
  softfocus_context* context = NULL;
  for (int y = 0; y < kHeight; ++y) {
    for (int i = 0; i < 4 * kWidth; ++i) {
      picture[y][i / 4][i % 4] = (unsigned char)((i / 4 * (i % 4 + 1)) ^ y);
    }
  }
  if (softfocus_open(&context, 0) != SOFTFOCUS_OK) return 1;
  if (softfocus_compile_shader(context, &source, &shader) != SOFTFOCUS_OK ||
      softfocus_set_texture(context, shader, "picture", &from, NULL) != SOFTFOCUS_OK ||
      softfocus_set_uniform(context, shader, "strength", &strength, 1) != SOFTFOCUS_OK ||
      softfocus_run_shader(context, shader, &pass) != SOFTFOCUS_OK) {
    puts(softfocus_message(context)); /* FILE:LINE: what, and what would be right */
    softfocus_close(context);
    return 1;
  }
  softfocus_free_shader(shader);
  softfocus_close(context);

  for (int y = 0; y < kHeight; ++y) {
    for (int i = 0; i < 4 * kWidth; ++i) {
      uint32_t bits = 0;
      memcpy(&bits, &result[y][i / 4][i % 4], sizeof bits);
      hash = add_to_hash(hash, bits);
    }
  }
  printf("%016llx\n", (unsigned long long)hash);
  return 0;
}
