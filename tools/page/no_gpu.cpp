// Stands in for gpu.cpp in a build without GL.

#include "tools/gl/driver/driver.h"
#include "tools/page/requests.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse() { throw DriverError("this module was built without GL"); }

}  // namespace

Json answer_gl_open(Page& /*page*/, const Json& /*request*/) { refuse(); }
Json answer_gl_frame(Page& /*page*/, const Json& /*request*/) { refuse(); }
Json answer_gl_probe(Page& /*page*/, const Json& /*request*/) { refuse(); }
Json answer_gl_crosscheck(Page& /*page*/, const Json& /*request*/) { refuse(); }

}  // namespace softfocus
