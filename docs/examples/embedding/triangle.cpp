// A triangle with stages of one's own on the software GPU. Prints a hash of its texels.
#include <softfocus/raster.h>

#include <cstdio>

using namespace softfocus;

struct Corners {
  VertexOutput<3> operator()(std::uint32_t i) const {
    constexpr float kPlace[3][2] = {{-0.9f, 0.7f}, {0.8f, 0.9f}, {0.1f, -0.8f}};
    return {{kPlace[i][0], kPlace[i][1], 0.5f, 1.0f + 0.5f * static_cast<float>(i)},
            {i == 0 ? 1.0f : 0.0f, i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f}};
  }
};

struct Light {
  static constexpr std::array kInterpolation{Interpolation::perspective, Interpolation::perspective,
                                             Interpolation::perspective};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<3>& f) const {
    const float red = f.varyings[0] * f.varyings[1] + f.varyings[2] / 3.0f;
    return {{glm::vec4{red, f.varyings[1], f.varyings[2], 1.0f}}, false};
  }
};

int main() {
  Image picture = make_image(Format::rgba16f, 256, 256);
  RenderPass pass{
      .targets = {.colour = {&picture}}, .profile = {}, .clear_colour = glm::vec4{0.0f}};
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  const std::uint32_t indices[] = {0, 1, 2};
  draw(pass, state, indices, 3, Corners{}, Light{});
  ThreadPool pool(hardware_threads());
  finish(pass, pool);
  std::printf("%016llx\n", static_cast<unsigned long long>(hash_image(picture)));
}
