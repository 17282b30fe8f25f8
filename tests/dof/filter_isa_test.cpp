// The filters in lanes against their oracles, bit for bit, on every vector
// unit that this CPU has.

#include <doctest/doctest.h>

#include <array>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>

#include "dof/one_pass/one_pass.h"
#include "dof/two_pass/two_pass.h"
#include "raster/images/texel.h"
#include "tests/support/sanitizers.h"
#include "tests/support/test_images.h"

using namespace softfocus;

namespace {

struct FilterPair {
  const char* name;
  void (*apply)(const DofInput&, const ImageView&, ThreadPool&);
  void (*oracle)(const DofInput&, const ImageView&, ThreadPool&);
};
constexpr std::array kFilters{
    FilterPair{"two-pass", two_pass, two_pass_oracle},
    FilterPair{"two-pass-single", two_pass_single, two_pass_single_oracle},
    FilterPair{"one-pass", one_pass, one_pass_oracle}};

constexpr DofSettings kSettings{.coc = {12.0f, 2.0f}, .max_coc_px = 7.3f, .leak = 1.0f};

void check_units(const FilterPair& filter, const Image& scene, const DofSettings& settings,
                 HalfRounding rounding = HalfRounding::nearest_even) {
  Profile profile;
  profile.half_store = rounding;
  ThreadPool any_pool(2);
  Image expected = make_image(scene.format, scene.width, scene.height);
  filter.oracle({scene, settings, profile}, expected, any_pool);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(2, isa);
    // The result's old contents must not show.
    Image actual = random_scene_image(scene.width, scene.height, 99);
    filter.apply({scene, settings, profile}, actual, pool);
    INFO(filter.name, " on ", std::string{isa_name(isa)}, ", ", scene.width, "x", scene.height,
         ", max_coc ", settings.max_coc_px, ", leak ", settings.leak);
    CHECK(equal(actual, expected));
  }
}

template <class HalfAt>
void set_halves(Image& image, const HalfAt& half_at) {
  for (int y = 0; y < image.height; ++y) {
    const auto halves = row<std::uint16_t>(image, y);
    for (int x = 0; x < image.width; ++x) {
      for (int channel = 0; channel < 4; ++channel) {
        std::uint16_t& half = halves[static_cast<std::size_t>(4 * x + channel)];
        half = half_at(x, y, channel, half);
      }
    }
  }
}

// Depths of which each differs from those beside it, so that vectors hold all radii.
Image noisy_scene_image(int width, int height, std::uint64_t seed) {
  Image image = random_scene_image(width, height, seed);
  Random random{seed};
  set_depth(image, [&](int, int) { return 0.3f + 9.0f * random.unit(); });
  return image;
}

struct Island {
  int x, y, size;
};

void check_islands(std::initializer_list<Island> islands) {
  for (const FilterPair& filter : kFilters) {
    for (const Island island : islands) {
      // Behind the focus or before it, where it reaches what is in focus too.
      struct Depths {
        float inside_m, outside_m;
      };
      for (const Depths depths : {Depths{2.0f, 7.0f}, {7.0f, 2.0f}, {2.0f, 1.0f}, {1.0f, 2.0f}}) {
        Image scene = random_scene_image(141, 130, 11);
        set_depth(scene, [&](int x, int y) {
          const bool inside = x >= island.x && x < island.x + island.size && y >= island.y &&
                              y < island.y + island.size;
          return inside ? depths.inside_m : depths.outside_m;
        });
        // Sharp pixels pass through the same rules as blurred ones.
        set_halves(scene, [](int x, int y, int channel, std::uint16_t half) {
          constexpr std::array<std::uint16_t, 4> kStrange{0x7C00, 0xFC00, 0x7D01, 0x8000};
          const int place = x * 7 + y * 13 + channel;
          return channel < 3 && place % 97 == 0 ? kStrange[static_cast<std::size_t>(place) % 4]
                                                : half;
        });
        check_units(filter, scene, kSettings);
        check_units(filter, scene, kSettings, HalfRounding::swiftshader);
      }
    }
  }
}

}  // namespace

TEST_CASE("the filters' kernels give the oracles' bits at every size of picture") {
  struct Size {
    int width, height;
  };
  for (const FilterPair& filter : kFilters) {
    for (const Size size : {Size{1, 1},
                            {1, 40},
                            {40, 1},
                            {3, 2},
                            {16, 16},
                            {17, 15},
                            {33, 70},
                            {129, 31},
                            {150, 45},
                            {64, 90}}) {
      check_units(filter, random_scene_image(size.width, size.height, 1), kSettings);
      check_units(filter, noisy_scene_image(size.width, size.height, 2), kSettings);
    }
  }
}

TEST_CASE("the filters' kernels give the oracles' bits for every largest radius") {
  for (const FilterPair& filter : kFilters) {
    for (const float max_coc : {0.0f, 0.5f, 1.0f, 1.5f, 2.0f, 7.3f, 16.0f, 64.0f, 1024.0f}) {
      // Past the picture's size the oracles are slow, and one of them squared.
      const int size = max_coc > 64.0f   ? (filter.apply == one_pass ? 4 : 17)
                       : max_coc > 16.0f ? 21
                                         : 37;
      DofSettings settings = kSettings;
      settings.max_coc_px = max_coc;
      for (const float horizon : {2.5f, 25.0f, 2000.0f}) {
        if (max_coc > 64.0f && horizon < max_coc) continue;  // circles as with 64
        if (kHasSanitizers && (max_coc > 16.0f || horizon < 2000.0f)) continue;
        settings.coc.radius_at_infinity_px = horizon;
        check_units(filter, random_scene_image(size, size - 1, 3), settings);
      }
    }
  }
}

TEST_CASE("the filters' kernels give the oracles' bits at every leak and rounding" *
          doctest::test_suite("long")) {
  const Image patches = random_scene_image(67, 41, 4), noise = noisy_scene_image(67, 41, 5);
  for (const FilterPair& filter : kFilters) {
    for (const float leak : {0.0f, 0.06f, 0.3f, 1.0f, 5.0f, 1e-38f, 1e30f}) {
      DofSettings settings = kSettings;
      settings.leak = leak;
      for (const HalfRounding rounding :
           {HalfRounding::nearest_even, HalfRounding::toward_zero, HalfRounding::swiftshader}) {
        check_units(filter, patches, settings, rounding);
        check_units(filter, noise, settings, rounding);
      }
    }
  }
}

TEST_CASE("the filters' kernels give the oracles' bits for any colours") {
  constexpr std::array<std::uint16_t, 12> kColours{0x0000, 0x8000, 0x0001, 0x83FF, 0x0400, 0xBC00,
                                                   0x7BFF, 0xFBFF, 0x7C00, 0xFC00, 0x7E01, 0xFD55};
  for (const FilterPair& filter : kFilters) {
    // Few strange ones, some, nothing else, and nothing but negative zeros.
    for (const int every : {400, 20, 1}) {
      Image scene = random_scene_image(70, 50, 6);
      Random random{7};
      set_halves(scene, [&](int, int, int channel, std::uint16_t half) {
        const std::uint64_t chance = random.next() >> 20;
        return channel < 3 && chance % static_cast<unsigned>(every) == 0
                   ? kColours[chance / 512 % kColours.size()]
                   : half;
      });
      check_units(filter, scene, kSettings);
      check_units(filter, scene, kSettings, HalfRounding::toward_zero);
      check_units(filter, scene, kSettings, HalfRounding::swiftshader);
    }
    Image scene = random_scene_image(40, 40, 8);
    set_halves(scene, [](int, int, int channel, std::uint16_t half) {
      return channel < 3 ? std::uint16_t{0x8000} : half;
    });
    check_units(filter, scene, kSettings);
  }
}

TEST_CASE("the filters' kernels give the oracles' bits for any depths") {
  constexpr std::array<std::uint16_t, 10> kDepths{0x0000, 0x8000, 0x0001, 0x03FF, 0x4000,
                                                  0xC000, 0x7BFF, 0x7C00, 0xFC00, 0x7E01};
  for (const FilterPair& filter : kFilters) {
    for (const int every : {300, 2}) {
      Image scene = random_scene_image(70, 50, 9);
      set_depth(scene, [](int, int) { return 2.0f; });
      Random random{10};
      set_halves(scene, [&](int, int, int channel, std::uint16_t half) {
        const std::uint64_t chance = random.next() >> 20;
        return channel == 3 && chance % static_cast<unsigned>(every) == 0
                   ? kDepths[chance / 512 % kDepths.size()]
                   : half;
      });
      check_units(filter, scene, kSettings);
      // Depths that are stored as NaN between the passes.
      check_units(filter, scene, kSettings, HalfRounding::swiftshader);
    }
  }
}

TEST_CASE("the filters' kernels give the oracles' bits where part of a picture is in focus") {
  check_islands({{95, 50, 45}});
}

TEST_CASE("so they do for a pixel, a corner and a part at the border" *
          doctest::test_suite("long")) {
  check_islands({{70, 60, 1}, {0, 0, 20}, {10, 100, 30}});
}

TEST_CASE("the filters' kernels give the same bits for any number of threads" *
          doctest::test_suite("threads long")) {
  const Image scene = random_scene_image(203, 141, 12);
  for (const FilterPair& filter : kFilters) {
    for (const Isa isa : available_isas()) {
      ThreadPool one(1, isa);
      Image expected = make_image(scene.format, scene.width, scene.height);
      filter.apply({scene, kSettings, {}}, expected, one);
      for (const int threads : {2, 3, 7}) {
        ThreadPool pool(threads, isa);
        Image actual = make_image(scene.format, scene.width, scene.height);
        filter.apply({scene, kSettings, {}}, actual, pool);
        CHECK(equal(actual, expected));
      }
    }
  }
}

// image_view_test.cpp writes such a picture too, with its surroundings watched.
TEST_CASE("the filters' kernels give the oracles' bits for a picture larger than caches" *
          doctest::test_suite("long")) {
  // Written past them in whole vectors, and at the right edge not in whole ones.
  Image scene = random_scene_image(4099, 517, 13);
  set_depth(scene, [](int x, int y) { return x / 50 % 3 == 0 && y / 40 % 2 == 0 ? 8.0f : 2.0f; });
  DofSettings settings = kSettings;
  settings.max_coc_px = 2.5f;
  for (const FilterPair& filter : kFilters) check_units(filter, scene, settings);
}
