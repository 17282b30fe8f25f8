#pragma once
// The methods' GLSL, for a renderer of one's own: the same bits as the methods here, on a GPU
// whose profile is known.

#include <string_view>

namespace softfocus {

/// A shader's text: "two_pass.frag", "one_pass.frag", their tiled forms below, or
/// "fullscreen.vert", which draws a triangle over the target without a vertex buffer
/// (glDrawArrays(GL_TRIANGLES, 0, 3)). Empty for another name. It has no #version: GLSL 4.00 or
/// later is to be said before it.
///
/// Uniforms: sampler2D source, RGBA16F with depth in metres in alpha; the PixelCoc's
/// radius_at_infinity_px and focus_m; max_coc_px and leak as in DofSettings. two_pass.frag
/// is drawn twice, into RGBA16F, with ivec2 direction (1, 0) and then (0, 1), and int taps =
/// ceil(max_coc_px) - 1. one_pass.frag is drawn once, with the taps of ring_taps() in
/// sampler2D ring_taps, 256 a row: dx, dy, distance.
///
/// The tiled forms give the same bits, in less time where much is in focus or at large radii: two
/// small passes find how far the taps of each tile must go. With int tile_px = 32 and tiles of
/// W / 32 x H / 32, rounded up: "tile_rows.frag" is drawn into R32F, W / 32 wide and as high as the
/// picture, with the uniforms of a filter; "tile_reach.frag" into RGBA32F of W / 32 x H / 32, with
/// sampler2D row_radius, int farthest = ceil((max_coc_px - 1) / 32), at least 0, and bool diagonal,
/// true for one_pass. Then "two_pass_tiled.frag" and "one_pass_tiled.frag" are drawn as the
/// plain ones, with the reach in sampler2D tile_reach.
std::string_view shader_text(std::string_view name);

}  // namespace softfocus
