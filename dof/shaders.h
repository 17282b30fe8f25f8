#pragma once
// The methods' GLSL, for a renderer of one's own: the same bits as the methods here, on a GPU
// whose profile is known.

#include <string_view>

namespace softfocus {

/// A shader's text: "two_pass.frag", "one_pass.frag", or "fullscreen.vert", which draws a
/// triangle over the target without a vertex buffer (glDrawArrays(GL_TRIANGLES, 0, 3)). Empty
/// for another name. It has no #version: GLSL 4.00 or later is to be said before it.
///
/// Uniforms: sampler2D source, RGBA16F with depth in metres in alpha; the PixelCoc's
/// radius_at_infinity_px and focus_m; max_coc_px and leak as in DofSettings. two_pass.frag
/// is drawn twice, into RGBA16F, with ivec2 direction (1, 0) and then (0, 1), and int taps =
/// ceil(max_coc_px) - 1. one_pass.frag is drawn once, with the taps of ring_taps() in
/// sampler2D ring_taps, 256 a row: dx, dy, distance.
std::string_view shader_text(std::string_view name);

}  // namespace softfocus
