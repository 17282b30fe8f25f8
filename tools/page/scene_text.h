#pragma once
// The open scene as a file with the camera and the lens of a frame, and as a command.

#include <string>

#include "tools/page/page.h"

namespace softfocus {

/// `softfocus render` of this file, with the options that are no part of a scene, draws the same
/// bits. Of a model the file names the model. Throws UsageError for what has no file: cases, random
/// scenes.
std::string scene_text(const Opened& opened, const ShownFrame& shown);

/// The command of `softfocus render` whose --json tells the same picture_hash as a frame of these
/// settings, with the file of scene_text() if it needs one; null if there is none.
Json command_text(const Opened& opened, const FrameSettings& settings);

}  // namespace softfocus
