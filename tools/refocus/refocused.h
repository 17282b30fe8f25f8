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

/// `colour` is RGBA16F; its alpha becomes the depth, here and in the result. The picture or the map
/// that `options.show` asks for.
Image refocused(Image colour, const DepthMap& depth, const RefocusOptions& options,
                UsedRefocus& used, ThreadPool& pool);

}  // namespace softfocus
