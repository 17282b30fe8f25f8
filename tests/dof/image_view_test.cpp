// Filters of views on callers' memory: rows anywhere, in either order, at any distance. They
// give the bits that they give with images, and touch no byte around the picture.

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "dof/dof.h"
#include "dof/fixed_pictures/arithmetic.h"
#include "dof/focus_map.h"
#include "dof/one_pass/one_pass.h"
#include "dof/two_pass/two_pass.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

// How a picture lies in a caller's memory. Rows begin `start_bytes` past a cache line's begin.
struct Layout {
  const char* name;
  std::size_t start_bytes;
  std::size_t gap_bytes;  // between rows
  bool bottom_up;         // the stride is negative
};
constexpr std::array kLayouts{
    Layout{"rows without gaps", 0, 0, false}, Layout{"bottom-up rows", 64, 0, true},
    Layout{"rows of odd length", 2, 6, false}, Layout{"bottom-up rows of odd length", 6, 10, true},
    Layout{"a part of a wider picture", 24, 200, false}};

// A picture amid bytes of one value.
class Framed {
 public:
  Framed(Format format, int width, int height, const Layout& layout, std::uint16_t around)
      : row_bytes_(bytes_per_texel(format) * static_cast<std::size_t>(width)),
        stride_(row_bytes_ + layout.gap_bytes),
        bytes_(2 * kMargin + (stride_ * static_cast<std::size_t>(height) + 1) / 2 * 2),
        around_(around) {
    for (std::size_t i = 0; i < bytes_.size(); i += 2) std::memcpy(&bytes_[i], &around_, 2);
    const std::size_t first = kMargin + layout.start_bytes;
    const auto stride = static_cast<std::ptrdiff_t>(stride_);
    view = {format, width, height, layout.bottom_up ? -stride : stride, bytes_.data() + first};
    if (layout.bottom_up) view.texels += stride * (height - 1);
  }

  void fill(const ConstImageView& picture) const {
    for (int y = 0; y < view.height; ++y) {
      std::memcpy(view.texels + y * view.stride_bytes, picture.texels + y * picture.stride_bytes,
                  row_bytes_);
    }
  }

  // Bytes around the picture that have changed.
  int touched() const {
    std::vector<std::byte, RowAllocator<std::byte>> seen = bytes_;
    const auto place = static_cast<std::size_t>(view.texels - bytes_.data());
    for (int y = 0; y < view.height; ++y) {
      const auto at = static_cast<std::ptrdiff_t>(place) + y * view.stride_bytes;
      for (std::size_t i = 0; i < row_bytes_; ++i) {
        const auto byte = static_cast<std::size_t>(at) + i;
        std::memcpy(&seen[byte], reinterpret_cast<const std::byte*>(&around_) + byte % 2, 1);
      }
    }
    int count = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      count += std::memcmp(&seen[i], reinterpret_cast<const std::byte*>(&around_) + i % 2, 1) != 0;
    }
    return count;
  }

  ImageView view;

 private:
  static constexpr std::size_t kMargin = 8192;  // vectors and rows too far would lie in it
  std::size_t row_bytes_, stride_;
  std::vector<std::byte, RowAllocator<std::byte>> bytes_;
  std::uint16_t around_;
};

constexpr std::uint16_t kNanAround = 0x7E00;  // read as a colour or a depth, it would show
constexpr std::uint16_t kPatternAround = 0x5AA5;

template <class Apply>
void check_views(const Image& scene, const Apply& apply) {
  Image expected = make_image(scene.format, scene.width, scene.height);
  apply(scene, expected);
  for (const Layout& layout : kLayouts) {
    Framed from(scene.format, scene.width, scene.height, layout, kNanAround);
    from.fill(scene);
    Framed to(scene.format, scene.width, scene.height, layout, kPatternAround);
    apply(from.view, to.view);
    INFO(layout.name, ", ", scene.width, "x", scene.height);
    CHECK(equal(to.view, expected));
    CHECK(to.touched() == 0);
    CHECK(from.touched() == 0);
    CHECK(equal(from.view, scene));
  }
}

constexpr DofSettings kSettings{.coc = {12.0f, 2.0f}, .max_coc_px = 7.3f, .leak = 1.0f};

// Blurred patches and cells in focus, which filters pass through on their own way.
Image scene_image(int width, int height) {
  Image scene = random_scene_image(width, height, 1);
  set_depth(scene, [](int x, int y) {
    return x / 40 % 2 == 0 && y < 35 ? 2.0f
                                     : 0.7f + static_cast<float>((x / 8 * 5 + y / 8 * 3) % 9);
  });
  return scene;
}

struct Size {
  int width, height;
};
const std::vector<Size> kSizes = kHasSanitizers
                                     ? std::vector<Size>{{3, 5}, {45, 22}}
                                     : std::vector<Size>{{1, 1}, {3, 5}, {69, 44}, {64, 37}};

}  // namespace

TEST_CASE("every method filters pictures in a caller's memory, and touches no byte around them") {
  for (const Method& method : methods()) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      for (const Size size : kSizes) {
        INFO(std::string{method.name}, " on ", std::string{isa_name(isa)});
        check_views(scene_image(size.width, size.height),
                    [&](const ConstImageView& from, const ImageView& to) {
                      apply(method, {from, kSettings, {}}, to, pool);
                    });
      }
    }
  }
}

TEST_CASE("the oracles filter pictures in a caller's memory") {
  ThreadPool pool(2);
  for (const auto oracle : {two_pass_oracle, two_pass_single_oracle, one_pass_oracle}) {
    check_views(scene_image(41, 26), [&](const ConstImageView& from, const ImageView& to) {
      oracle({from, kSettings, {}}, to, pool);
    });
  }
}

TEST_CASE("the integer filter takes pictures in a caller's memory") {
  for (const Arithmetic arithmetic : {Arithmetic::fixed, Arithmetic::fixed_8}) {
    for (const Isa isa : available_isas()) {
      ThreadPool pool(2, isa);
      for (const Size size : kSizes) {
        INFO(std::string{arithmetic_name(arithmetic)}, " on ", std::string{isa_name(isa)});
        check_views(scene_image(size.width, size.height),
                    [&](const ConstImageView& from, const ImageView& to) {
                      two_pass_in(arithmetic, {from, kSettings, {}}, to, pool);
                    });
      }
    }
  }
}

TEST_CASE("the integer filter takes bytes in a caller's memory, at odd addresses too") {
  const FixedTable table = fixed_table(half_table(fixed_lens(kSettings)));
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    const BytePicture picture = byte_picture(scene_image(93, 58), pool);
    Image expected = make_image(Format::rgba8, 93, 58);
    fixed_two_pass(picture.colours, picture.depths, table, expected, pool);
    for (Layout layout : kLayouts) {
      layout.start_bytes += 1;
      layout.gap_bytes += 1;
      Framed from(Format::rgba8, 93, 58, layout, kNanAround);
      from.fill(picture.colours);
      Framed to(Format::rgba8, 93, 58, layout, kPatternAround);
      fixed_two_pass(from.view, picture.depths, table, to.view, pool);
      INFO(std::string{isa_name(isa)}, ", ", layout.name);
      CHECK(equal(to.view, expected));
      CHECK(to.touched() == 0);
    }
  }
}

TEST_CASE("pictures larger than caches keep to their place in a caller's memory") {
  // Rows on cache lines, as filters want them that write past the caches, and not.
  const Image scene = scene_image(4104, 520);
  ThreadPool pool(2);
  for (const auto filter : {two_pass, one_pass}) {
    if (kHasSanitizers && filter == one_pass) continue;  // two-pass alone writes past them
    DofSettings settings = kSettings;
    settings.max_coc_px = 2.5f;
    Image expected = make_image(Format::rgba16f, 4104, 520);
    filter({scene, settings, {}}, expected, pool);
    for (const Layout layout : {Layout{"bottom-up on cache lines", 0, 64, true},
                                Layout{"off cache lines", 2, 64, false}}) {
      Framed to(Format::rgba16f, 4104, 520, layout, kPatternAround);
      CHECK(write_past_caches(to.view) == (layout.start_bytes == 0));
      filter({scene, settings, {}}, to.view, pool);
      INFO(layout.name);
      CHECK(equal(to.view, expected));
      CHECK(to.touched() == 0);
    }
  }
}
