#pragma once
// A picture and its depth in place of a scene, refocused as `softfocus refocus` does it.

#include "tools/page/page.h"
#include "tools/refocus/refocused.h"

namespace softfocus {

/// Why a request that draws a scene has none.
inline constexpr const char* kNoScene =
    "a picture has no scene to draw; open a scene for this, or look at the picture's filters";

/// The picture at one size.
struct PictureAtSize {
  int preview = 1;                     ///< what the file's width and height were divided by
  std::shared_ptr<const Drawn> drawn;  ///< its depth in alpha
  PlaneValues opacity;                 ///< empty: all is opaque
  DepthMap depth;                      ///< empty if its encoding is not known yet
};

struct OpenedPicture {
  RefocusOptions options;  ///< the files, and how the depth is read
  PictureSources sources;
  std::optional<ReadDepth> reading;  ///< without its map
  std::string lacks;                 ///< if the depth is not read: what must be said first
  PictureAtSize whole;
  std::optional<PictureAtSize> coarse;  ///< the last one that was wanted
};

/// Settings that a frame of a picture was made with, to write its file.
struct RefocusedFrame {
  RefocusOptions options;
  UsedRefocus used;
  PlaneValues opacity;
};

struct OpenedWithReply {
  std::unique_ptr<Opened> opened;
  Json reply;  ///< what there is to tell of it
};

/// Opens `request`'s `picture` and `depth`, read as it says. An encoding that cannot be told or
/// lacks numbers is no error: the picture is then there without depth. Throws FileError,
/// UsageError.
OpenedWithReply open_picture(const Json& request, ThreadPool& pool);

/// The opened picture with these settings. Its size is the file's, divided by `preview`.
ShownFrame refocused_frame(Page& page, const FrameSettings& settings);

/// Adds to the reply the figures of such a frame beside its size and times.
void add_refocus_figures(Json& reply, const ShownFrame& shown);

}  // namespace softfocus
