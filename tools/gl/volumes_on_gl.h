#pragma once
// Shadow volumes counted by a GL driver: the faces and samples of
// scenes/shadows/volumes/volume_mask.h.

#include "scenes/shadows/volumes/volume_mask.h"
#include "tools/gl/doubles_on_gl.h"

namespace softfocus {

/// A face is drawn as rectangles that hold all pixels which it may count.
struct GlVolumes {
  GlProgram program;
  GlTexture faces, samples;
  GlListed rectangles;
  GlTarget target;  ///< R32F: a pixel has what VolumeCounts::counts has
};

/// Uploads the faces and samples of `of`, which count_volumes() gave. Throws DriverError if the
/// driver has no doubles in shaders. 2^24 faces at most.
GlVolumes make_gl_volumes(const GlContext& context, const Shaders& shaders,
                          const ShadowVolumes& volumes, const VolumeCounts& of,
                          const ShadowView& view, glm::dvec3 eye, VolumeCount count);

void draw(const GlVolumes& volumes);

}  // namespace softfocus
