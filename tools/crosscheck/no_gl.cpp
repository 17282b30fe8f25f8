// Stands in for what needs GL in a build without libepoxy.

#include "tools/bench/repeated_on_gl.h"
#include "tools/crosscheck/probe.h"
#include "tools/crosscheck/run_cases.h"
#include "tools/gl/driver/context.h"
#include "tools/gl/frame_on_gl.h"

namespace softfocus {
namespace {

[[noreturn]] void refuse() {
  throw DriverError(
      "this program was built without GL drivers, because libepoxy was not there; "
      "docs/building.md says how to build it with them");
}

}  // namespace

DriverRun run_cases(const CrosscheckWork&, const std::function<void(const CaseResult&)>&) {
  refuse();
}
int matching_cases(const std::vector<std::string>&, const std::string&, bool, const Driver*) {
  refuse();
}

Probe probe_driver(const Driver&) { refuse(); }

bool has_egl() { return false; }

struct FrameOnGl::State {};
FrameOnGl::FrameOnGl(const Driver&, Shaders) { refuse(); }
FrameOnGl::~FrameOnGl() = default;
std::string FrameOnGl::renderer() const { refuse(); }
Image FrameOnGl::draw(const Scene&, const CameraMatrices&, double, int, int) { refuse(); }
std::vector<Image> FrameOnGl::draw_layers(const Scene&, const CameraMatrices&, double, int, int,
                                          std::size_t) {
  refuse();
}
Image FrameOnGl::filter(const Method&, const DofSettings&, const Image&) { refuse(); }

struct ShadowsRepeatedOnGl::State {};
ShadowsRepeatedOnGl::ShadowsRepeatedOnGl(const Driver&, const MaskDraws&, int, int, int, int) {
  refuse();
}
ShadowsRepeatedOnGl::~ShadowsRepeatedOnGl() = default;
std::string ShadowsRepeatedOnGl::renderer() const { refuse(); }
void ShadowsRepeatedOnGl::draw() { refuse(); }
std::vector<std::uint8_t> ShadowsRepeatedOnGl::mask(std::span<const std::uint8_t>) const {
  refuse();
}

struct MapsRepeatedOnGl::State {};
MapsRepeatedOnGl::MapsRepeatedOnGl(const Driver&, std::span<const MapCasters>, int) { refuse(); }
MapsRepeatedOnGl::~MapsRepeatedOnGl() = default;
std::string MapsRepeatedOnGl::renderer() const { refuse(); }
void MapsRepeatedOnGl::draw() { refuse(); }
Image MapsRepeatedOnGl::nearness(std::size_t, std::size_t) const { refuse(); }

struct EffectsRepeatedOnGl::State {};
EffectsRepeatedOnGl::EffectsRepeatedOnGl(const Driver&, const Image&, int) { refuse(); }
EffectsRepeatedOnGl::~EffectsRepeatedOnGl() = default;
std::string EffectsRepeatedOnGl::renderer() const { refuse(); }
void EffectsRepeatedOnGl::choose(const ChosenEffect&, const Image*) { refuse(); }
void EffectsRepeatedOnGl::choose(const FrameEffect&, const FrameSources&) { refuse(); }
void EffectsRepeatedOnGl::run(bool) { refuse(); }
std::vector<Image> EffectsRepeatedOnGl::pictures() const { refuse(); }

struct RepeatedOnGl::State {};
RepeatedOnGl::RepeatedOnGl(const Driver&, const BenchWork&, int) { refuse(); }
RepeatedOnGl::~RepeatedOnGl() = default;
std::string RepeatedOnGl::renderer() const { refuse(); }
void RepeatedOnGl::draw() { refuse(); }
void RepeatedOnGl::finish() { refuse(); }
std::vector<std::string> RepeatedOnGl::forms() const { refuse(); }
void RepeatedOnGl::filter(std::size_t) { refuse(); }
void RepeatedOnGl::copy_and_filter(std::size_t) { refuse(); }
Image RepeatedOnGl::picture(std::size_t) const { refuse(); }

}  // namespace softfocus
