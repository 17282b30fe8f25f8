#pragma once
// The requests, by theme. Each throws what is wrong as an exception with one line.

#include "tools/page/page.h"

namespace softfocus {

Json answer_start(Page& page, const Json& request);
Json answer_about(Page& page, const Json& request);
Json answer_scenes(Page& page, const Json& request);
Json answer_open(Page& page, const Json& request);
Json answer_frame(Page& page, const Json& request);
Json answer_pixel(Page& page, const Json& request);
Json answer_truth(Page& page, const Json& request);
Json answer_compare_methods(Page& page, const Json& request);
Json answer_selftest(Page& page, const Json& request);
Json answer_file(Page& page, const Json& request);
Json answer_save(Page& page, const Json& request);
Json answer_shader(Page& page, const Json& request);
Json answer_shader_text(Page& page, const Json& request);
Json answer_gl_open(Page& page, const Json& request);
Json answer_gl_frame(Page& page, const Json& request);
Json answer_gl_probe(Page& page, const Json& request);
Json answer_gl_crosscheck(Page& page, const Json& request);

}  // namespace softfocus
