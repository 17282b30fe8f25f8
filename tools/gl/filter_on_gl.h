#pragma once
// The depth-of-field filters run by a GL driver with the project's shaders.

#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// The methods that have a shader: two-pass and one-pass; pinhole needs none.
bool has_shader(std::string_view method);

/// A filter with its program linked and its targets made, to be run many times.
struct GlFilter {
  GlProgram program;
  GlTexture ring_taps;            ///< of one-pass: where its samples lie
  std::vector<GlTarget> targets;  ///< one a pass; the last has the result
};

/// For pictures of one size. Throws DriverError for a method without a shader.
GlFilter make_filter(const GlContext& context, const Shaders& shaders, std::string_view method,
                     const DofSettings& settings, int width, int height);

/// Filters an RGBA16F texture of that size.
void run_filter(const GlFilter& filter, const GlTexture& scene);

/// Both at once, for a filter that is run once; the result is the target's one colour texture.
/// Throws DriverError for a method without a shader.
GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height);

}  // namespace softfocus
