#pragma once
// A picture with depth, as a lens focused elsewhere would have made it.

#include <optional>

#include "dof/auto/auto_method.h"
#include "tools/refocus/options.h"

namespace softfocus {

/// What was used.
struct UsedRefocus {
  SettledLens lens;
  DofSettings settings;
  const Method* method = nullptr;
  std::optional<AutoMethod> choice{};  ///< of auto
  float largest_circle_px = 0.0f;
};

/// A picture with depth. RGBA16F, depth in alpha, its colour times its opacity.
struct PictureOnItsWay {
  Image picture{};
  PlaneValues opacity{};  ///< 0 to 1, a number a pixel; empty: all is opaque
};

/// The alpha of `source` becomes the depth, here and in the result. The picture or the map that
/// `options.show` asks for; a map has no opacity.
PictureOnItsWay refocused(PictureOnItsWay source, const DepthMap& depth,
                          const RefocusOptions& options, UsedRefocus& used, ThreadPool& pool);

/// The circles that were used, in pixels, negative nearer than the focus.
PlaneValues circle_radii(const DepthMap& depth, const UsedRefocus& used);

}  // namespace softfocus
