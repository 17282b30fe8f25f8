#pragma once
// From what is open to a shot, its sharp picture, its lens and its finished picture.

#include <chrono>

#include "tools/page/page.h"

namespace softfocus {

/// What these settings ask for of what is open, whose scene then has their camera. Throws
/// UsageError if nothing is open, or for what the scene's effects do not go with.
Shot asked_shot(Page& page, const FrameSettings& settings);

/// The sharp picture of these settings, drawn or as it was kept. Throws UsageError as asked_shot().
std::shared_ptr<const Drawn> drawn_picture(Page& page, const FrameSettings& settings);

/// asked_shot() of what was drawn: a case makes its own scene and size.
Shot shot_of_drawn(Page& page, const Drawn& drawn, const FrameSettings& settings);

/// The lens of these settings, whose shot has one, on that picture. Throws UsageError for a lens
/// that cannot be.
UsedLens used_lens(const Page& page, const Drawn& drawn, const FrameSettings& settings,
                   const Shot& shot);

/// The shot's picture, by any method, with the effects. With `slice_ms` it throws Interrupted if
/// samples of the lens take longer, and goes on by the same `memory`.
Image made_picture(const Page& page, const Drawn& drawn, const Shot& shot,
                   const std::optional<UsedLens>& lens, FrameMemory& memory,
                   std::optional<double> slice_ms = {});

double milliseconds_since(std::chrono::steady_clock::time_point start);

}  // namespace softfocus
