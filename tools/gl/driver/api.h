#pragma once
// OpenGL's functions: libepoxy's, and in a browser WebGL2's, which is OpenGL ES 3.0 without what
// has no safe form.

#ifdef __EMSCRIPTEN__
#include <GLES3/gl3.h>

namespace softfocus {

inline constexpr bool kIsWebGl = true;

inline void glClearDepth(double depth) { glClearDepthf(static_cast<float>(depth)); }

}  // namespace softfocus
#else
#include <epoxy/gl.h>

namespace softfocus {

inline constexpr bool kIsWebGl = false;

}  // namespace softfocus
#endif
