#pragma once
// The contenders of a chart of shadows, drawn and counted.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/draw/draw_scene.h"
#include "scenes/shadows/shadow_truth.h"
#include "tools/chart/scene.h"

namespace softfocus {

/// By rays, projected, volumes and maps; what is kept from frame to frame stands beside what is
/// found anew.
std::vector<std::string> shadow_methods();
std::vector<ChartEntry> shadow_entries(const std::string& method, int height_px, bool quick);

/// The sharp picture with shadows by rays.
Image truth_of_shadows(const ChartScene& scene, ThreadPool& pool);

/// One contender at a time is prepared: large scenes have hundreds of megabytes of shadows.
class ShadowContenders {
 public:
  /// Both outlive it. Throws UsageError if the scene has no lights, or more than
  /// kMostShadowLights.
  ShadowContenders(const ChartScene& chart, ThreadPool& pool);

  void prepare(const ChartEntry& entry);

  /// A whole frame of the contender that is prepared.
  void draw(Image& picture);

  /// Counts pixels times lights of the last drawn frame that are answered otherwise than by a ray
  /// from anywhere within 1/256 pixel. A pixel is dark by a map if more than half of the kernel is.
  std::size_t wrong_pixels();

  /// Without any shadow: all that a ray finds dark.
  std::size_t wrong_without_shadows();

 private:
  /// The truth of one light.
  struct LightTruth {
    ShadowTruth truth;
    std::vector<std::uint8_t> is_dark;
  };
  const std::vector<LightTruth>& truths();
  std::size_t wrong_bits(std::size_t light) const;

  const ChartScene& chart_;
  ThreadPool& pool_;
  Scene scene_;  ///< with the contender's shadows
  std::optional<PreparedScene> prepared_;
  std::string prepared_id_;
  bool keeps_ = false;
  // The truth's facets.
  Facets facets_;
  ShadowView view_;
  std::vector<ShadowLight> lights_;
  std::vector<SeenFacet> seen_;
  std::vector<LightTruth> truths_;
};

}  // namespace softfocus
