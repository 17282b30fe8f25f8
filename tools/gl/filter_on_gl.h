#pragma once
// The depth-of-field filters run by a GL driver with the project's shaders.

#include "dof/method.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// The methods that have a shader: two-pass and one-pass; pinhole needs none.
bool has_shader(std::string_view method);

/// Filters an RGBA16F texture; the result is the target's one colour texture. Throws
/// DriverError for a method without a shader.
GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height);

}  // namespace softfocus
