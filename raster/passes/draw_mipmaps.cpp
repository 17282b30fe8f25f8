#include "raster/passes/draw_mipmaps.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "raster/images/sampler.h"
#include "raster/pipeline/draw.h"

namespace softfocus {
namespace {

constexpr std::array<std::uint32_t, 6> kFan{0, 1, 2, 0, 2, 3};

// Corner `i` of the target, from the origin along x first.
struct Corners {
  VertexOutput<2> operator()(std::uint32_t i) const {
    const float u = i == 1 || i == 2 ? 1.0f : 0.0f;
    const float v = i >= 2 ? 1.0f : 0.0f;
    return {{2.0f * u - 1.0f, 2.0f * v - 1.0f, 0.0f, 1.0f}, {u, v}};
  }
};

struct Fetch {
  static constexpr std::array kInterpolation{Interpolation::linear, Interpolation::linear};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  const Texture* texture;
  const Profile* profile;

  FragmentOutput<1> operator()(const Fragment<2>& in) const {
    constexpr Sampler kSampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
    return {{sample(*texture, kSampler, {in.varyings[0], in.varyings[1]}, 0.0f, *profile)}, false};
  }
};

}  // namespace

void draw_mipmaps(Texture& texture, const Profile& profile) {
  assert(!texture.levels.empty());
  // softpipe keeps subnormals elsewhere, but flushes them when it draws and need not clip.
  Profile drawing = profile;
  drawing.denormals = Denormals::flush;
  texture.levels.resize(1);
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  ThreadPool pool{1};
  for (;;) {
    const Image& last = texture.levels.back();
    if (last.width == 1 && last.height == 1) return;
    Image coarse =
        make_image(last.format, std::max(1, last.width / 2), std::max(1, last.height / 2));
    const Texture fine = make_texture(last);
    RenderPass pass{.targets = {.colour = {&coarse}}, .profile = drawing, .draws = {}};
    draw(pass, state, kFan, 4, Corners{}, Fetch{&fine, &drawing});
    finish(pass, pool);
    texture.levels.push_back(std::move(coarse));
  }
}

void generate_mipmaps_as(Texture& texture, const Profile& profile) {
  if (profile.texture_unit == TextureUnit::standard) {
    generate_mipmaps(texture, profile);
  } else {
    draw_mipmaps(texture, profile);
  }
}

}  // namespace softfocus
