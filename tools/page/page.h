#pragma once
// The simulator's page: what it has open, and its requests. A request and its reply are JSON;
// docs/simulator.md lists them. The same code answers natively, for tests, and as WebAssembly.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "raster/threads/parallel.h"
#include "scenes/frame/frame.h"
#include "scenes/lens_views/accumulation.h"
#include "tools/golden/hashes.h"
#include "tools/page/settings.h"
#include "tools/pictures/image_file.h"
#include "tools/stress/cases/stress_case.h"

namespace softfocus {

/// A picture with its depth, and a frame of it (picture.h).
struct OpenedPicture;
struct RefocusedFrame;

/// A scene, a case of `softfocus stress`, whose pictures depend on their size, or a picture.
struct Opened {
  std::string source;  ///< as `softfocus render` takes it, or the picture's file; empty for a case
  Scene scene;         ///< of a case: empty but for the camera and the lens that stand for it; of a
                       ///< picture: its title alone
  Camera camera;       ///< the scene's own; the scene has that of the last frame
  /// What a look changes, as the scene has it itself; the scene has the look of the last frame.
  std::vector<Light> lights{};
  std::vector<Material> materials{};
  std::vector<Object> objects{};
  SceneLook look{};
  double far_m = 0.0;  ///< of the camera, by the look
  std::optional<StressCase> stress_case;
  double severity = 0.0;
  std::shared_ptr<OpenedPicture> picture;
};

/// Of a scene's triangles: those that cast, those on which shadows can fall, and of all lights the
/// projected triangles (of one that has moved, on what is seen), or the casters that have volumes.
struct ShadowCounts {
  std::size_t casters = 0, receivers = 0, projected = 0, volumes = 0;
};

/// A sharp picture, and what was drawn.
struct Drawn {
  FrameSettings settings;
  Camera camera;
  DrawnFrame frame;
  std::optional<StressTrial> trial;  ///< of a case; else the scene is the opened one
  const StressFrame* trial_frame = nullptr;
  const Scene* scene = nullptr;  ///< null for a case that is made as a picture
  double ms = 0.0;
  double shadows_ms = 0.0;  ///< of them: shadows made ready for lights that moved
  std::optional<ShadowCounts> shadows{};

  const Image& picture() const { return frame.parts.picture(); }
};

/// How far a picture is from the mean of so many views.
struct KnownFlip {
  int samples = 0;
  double flip = 0.0;
};

/// The picture that was shown last.
struct ShownFrame {
  std::shared_ptr<const Drawn> drawn;
  FrameSettings settings;
  std::optional<UsedLens> lens;  ///< none where the picture needs none
  Image picture;
  std::uint64_t hash = 0;
  double filter_ms = 0.0;
  std::optional<KnownFlip> flip;
  std::shared_ptr<const RefocusedFrame> refocused;  ///< of a picture with depth of field
};

/// Views of the lens that are taken step by step, of one frame.
struct Truth {
  std::shared_ptr<const Drawn> drawn;
  double focus_m = 0.0, aperture_m = 0.0;
  Aperture aperture{};
  std::optional<AccumulationBuffer> buffer;
  SampleSums sums, first_half;
  std::optional<double> half_set_rms;
};

/// The picture on the screen: RGBA, 8 bits, sRGB, opaque.
struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// A frame that was interrupted to let messages in. The same request goes on with it.
struct BegunFrame {
  std::string request;
  std::shared_ptr<const Drawn> drawn;
  FrameMemory memory;
  double ms = 0.0;  ///< so far
};

/// The GPU of the page's machine, and the opened scene on it (gpu.cpp).
struct Gpu;
struct GpuScene;

struct Page {
  std::unique_ptr<ThreadPool> pool = std::make_unique<ThreadPool>(1);
  std::unique_ptr<Opened> opened;
  FrameMemory memory;  ///< of drawing the opened scene
  /// The last pictures drawn, the latest first: one as shown, one coarser.
  std::array<std::shared_ptr<const Drawn>, 2> drawn;
  std::optional<ShownFrame> shown;
  std::optional<BegunFrame> begun;
  std::optional<Truth> truth;
  GoldenSet golden_set = GoldenSet::all;  ///< of the self-test
  std::vector<GoldenPart> golden_parts;   ///< those to come, the next one last
  std::vector<HashCheck> golden;          ///< as far as computed
  std::shared_ptr<Gpu> gpu;               ///< once the request 'gl_open' or another gl_* has come
  std::shared_ptr<GpuScene> gpu_scene;
  Pixels pixels;
  Bytes saved;  ///< the file that `save` made
  /// Set from another thread: the request that runs, or is on its way here, ends soon. It is
  /// cleared there before a request is sent.
  std::atomic<std::int32_t> cancel{0};
};

/// Thrown by a request that sees `cancel`.
struct Cancelled {};

/// Thrown by a `frame` with `slice_ms` that takes longer: the same request goes on.
struct Interrupted {
  int samples;
};

void stop_if_cancelled(const Page& page);

/// Answers a request's text with the reply's. Never throws: what is wrong is {"error": ...}, and
/// then the page is as before.
std::string answer(Page& page, std::string_view request);

}  // namespace softfocus
