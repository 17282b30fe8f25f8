#pragma once
// The depth that a phone puts into its JPEG beside the picture.
//
//   GDepth           XMP of Google's camera: format, near, far, and the map in base64, which XMP's
//                    extension spreads over several segments (Adobe 2012, XMP part 3, 1.1.3.1)
//   multi-picture    the map is a JPEG or PNG behind the picture's end (CIPA DC-007; Google's
//                    Dynamic Depth; Apple's auxiliary images), told by its XMP or by being grey

#include <cstddef>
#include <optional>
#include <span>

#include "tools/refocus/depth/depth_encodings.h"

namespace softfocus {

struct PhoneDepth {
  Bytes file{};  ///< of a picture
  /// What the file says of its numbers; no encoding if it says nothing.
  const DepthEncoding* encoding = nullptr;
  DepthNumbers numbers{};
  DepthAlong along = DepthAlong::axis;
};

/// Nothing if there is none. What is damaged counts as not there.
std::optional<PhoneDepth> find_phone_depth(std::span<const std::byte> jpeg);

}  // namespace softfocus
