#pragma once
// The depth-of-field filters run by a GL driver with the project's shaders.

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "dof/dof.h"
#include "tools/gl/objects.h"

namespace softfocus {

/// The two shaders of a method, which give the same bits.
enum class FilterForm {
  brute_force,  ///< every pixel takes all taps up to max_coc_px
  tiled,        ///< two small passes first find how far the taps of each tile must go
};
inline constexpr std::array kFilterForms{FilterForm::brute_force, FilterForm::tiled};

/// "brute-force", "tiled".
std::string_view form_name(FilterForm form);

/// The side of a tile in pixels. On llvmpipe tiles of 32 take as long as tiles of 64 or up to a
/// tenth less; tiles of 128 take longer.
inline constexpr int kFilterTilePx = 32;

/// The passes that a tiled filter begins with.
struct GlTileReach {
  int tile_px;
  GlProgram rows_program;
  GlProgram reach_program;
  GlTarget rows;   ///< R32F: the largest radius of each row of a tile
  GlTarget reach;  ///< RGBA32F, a pixel a tile
};

/// A filter with its program linked and its targets made, to be run many times.
struct GlFilter {
  GlProgram program;
  GlTexture ring_taps;                 ///< of one-pass: where its samples lie
  std::vector<GlTarget> targets;       ///< one a pass; the last has the result
  std::optional<GlTileReach> tiles{};  ///< of the tiled form
};

/// For pictures of one size. Throws DriverError for a method without a shader.
GlFilter make_filter(const GlContext& context, const Shaders& shaders, std::string_view method,
                     FilterForm form, const DofSettings& settings, int width, int height,
                     int tile_px = kFilterTilePx);

/// Filters an RGBA16F texture of that size. With `copy`, another, which may be `scene`, each pass
/// but the last is copied there and read from there.
void run_filter(const GlFilter& filter, const GlTexture& scene, const GlTexture* copy = nullptr);

/// Both at once, brute-force, for a filter that is run once; the result is the target's one colour
/// texture. Throws DriverError for a method without a shader.
GlTarget filter_on_gl(const GlContext& context, const Shaders& shaders, std::string_view method,
                      const DofSettings& settings, const GlTexture& scene, int width, int height);

}  // namespace softfocus
