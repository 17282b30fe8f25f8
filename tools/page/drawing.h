#pragma once
// From what is open to a sharp picture, and from its lens to the numbers of a filter.

#include <chrono>

#include "tools/page/page.h"

namespace softfocus {

/// The sharp picture of these settings, drawn or as it was kept. Throws UsageError if nothing is
/// open.
std::shared_ptr<const Drawn> drawn_picture(Page& page, const FrameSettings& settings);

/// The lens of these settings on that picture. Throws UsageError for a lens that cannot be.
FrameLens frame_lens(const Opened& opened, const Drawn& drawn, const FrameSettings& settings,
                     ThreadPool& pool);

/// The scene as seen from the lens. Needs drawn.scene.
LensViewInput lens_view_input(const Drawn& drawn, double focus_m, double aperture_m,
                              const Sampling& sampling);

/// The picture after a filter.
Image filtered_picture(const Drawn& drawn, const Method& method, const DofSettings& settings,
                       ThreadPool& pool);

double milliseconds_since(std::chrono::steady_clock::time_point start);

}  // namespace softfocus
