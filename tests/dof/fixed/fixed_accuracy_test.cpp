// How far the fixed-point filter is from the same equations in binary64 with nothing rounded
// between lens and result, on the three scenes at 160x120. The table of docs/fixed-point.md:
//     softfocus_tests -s -tc="fixed point: *binary64*" | grep error

#include <cmath>
#include <cstdio>

#include "dof/fixed_pictures/arithmetic.h"
#include "dof/two_pass/two_pass.h"
#include "scenes/draw/draw_scene.h"
#include "tests/support/fixed_pictures.h"
#include "tools/golden/hashes.h"

using namespace softfocus;
using namespace softfocus::fixed;

namespace {

constexpr int kWidth = 160, kHeight = 120;

/// A scene's frame in bytes, and its depths in metres.
struct SceneFrame {
  std::string name;
  Image drawn;
  PackedPicture packed;
  std::uint32_t near_um, far_um;  ///< of codes 0 and 255
};

std::vector<SceneFrame> scene_frames() {
  ThreadPool pool(1);
  std::vector<SceneFrame> frames;
  for (const GoldenScene& golden : load_golden_scenes(pool)) {
    const CameraMatrices view = camera_matrices(golden.scene.camera, 0.0, kWidth, kHeight);
    SceneFrame frame{golden.name,
                     draw_scene(golden.scene, view, 0.0, kWidth, kHeight, Profile{}, pool),
                     {},
                     0xFFFFFFFF,
                     0};
    const BytePicture bytes = byte_picture(frame.drawn, pool);
    std::vector<double> depths;
    for (const std::uint16_t half : bytes.depths) {
      depths.push_back(half_to_float(half) * 1e6);
      frame.near_um = std::min(frame.near_um, static_cast<std::uint32_t>(depths.back()));
      // Beyond 8 m all is nearly as blurred as at 8 m.
      frame.far_um =
          std::max(frame.far_um, static_cast<std::uint32_t>(std::fmin(depths.back(), 8e6)));
    }
    frame.packed.settings = {kWidth, kHeight, 0, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8};
    for (const double depth : depths) {
      const double share = (depth - frame.near_um) / (frame.far_um - frame.near_um);
      frame.packed.depths.push_back(static_cast<std::uint8_t>(std::fmin(share, 1.0) * 255.0 + 0.5));
    }
    for (int y = 0; y < kHeight; ++y) {
      const auto line = row<std::uint8_t>(bytes.colours, y);
      frame.packed.colours.insert(frame.packed.colours.end(), line.begin(), line.end());
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

const std::vector<SceneFrame>& frames() {
  static const std::vector<SceneFrame> made = scene_frames();
  return made;
}

Picture3<double> exact_result(const SceneFrame& frame, const Lens& lens) {
  Picture3<double> picture{kWidth, kHeight, {}};
  std::vector<ExactPixel> circles;
  for (std::size_t i = 0; i < frame.packed.depths.size(); ++i) {
    const std::uint8_t* bytes = frame.packed.colours.data() + 4 * i;
    picture.pixels.push_back({double(bytes[0]), double(bytes[1]), double(bytes[2])});
    const double depth =
        frame.near_um + (double(frame.far_um) - frame.near_um) * frame.packed.depths[i] / 255.0;
    const double radius = lens.radius_at_infinity * std::fabs(depth - lens.focus_um) / depth;
    circles.push_back({std::fmin(radius, lens.largest_radius) / 65536.0, depth > lens.focus_um});
  }
  return exact_filter(picture, circles, lens.leak / 65536.0, reach_of(lens.largest_radius));
}

struct Error {
  double squares = 0, squares_unrounded = 0, most = 0;
  std::size_t count = 0;
};

/// Against the exact result as bytes, and as it is.
void add_error(Error& error, const SceneFrame& frame, const Lens& lens) {
  PackedPicture packed = frame.packed;
  packed.settings.reach = reach_of(lens.largest_radius);
  const auto actual = filtered_rows(packed, table8(lens, frame.near_um, frame.far_um));
  const Picture3<double> exact = exact_result(frame, lens);
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = exact.pixels[i][c];
      const double off = actual[4 * i + c] - std::floor(value + 0.5);
      const double off_unrounded = actual[4 * i + c] - value;
      error.squares += off * off;
      error.squares_unrounded += off_unrounded * off_unrounded;
      error.most = std::fmax(error.most, std::fabs(off));
      ++error.count;
    }
  }
}

double psnr(double squares, std::size_t count) {
  return 10.0 * std::log10(255.0 * 255.0 * static_cast<double>(count) / std::fmax(squares, 1e-9));
}

/// Focus before, in and behind the scene, and circles from far below the largest radius to
/// far above it.
std::vector<Lens> lenses(const SceneFrame& frame, std::uint32_t radius_px) {
  std::vector<Lens> list;
  const std::uint32_t range = frame.far_um - frame.near_um;
  for (const std::uint32_t focus :
       {frame.near_um / 2, frame.near_um, frame.near_um + range / 3, frame.far_um, 100000000u}) {
    for (const std::uint32_t at_infinity : {1u, 4u, 16u, 60u, 4000u}) {
      list.push_back({at_infinity * radius_px * 65536 / 8, focus, radius_px << 16, 65536});
    }
  }
  return list;
}

/// Any leakage that a lens may have, and a radius that is not whole.
std::vector<Lens> unusual_lenses(const SceneFrame& frame, std::uint32_t radius_px) {
  std::vector<Lens> list;
  const std::uint32_t focus = frame.near_um + (frame.far_um - frame.near_um) / 3;
  for (const std::uint32_t leak : {0u, 4096u, 65536u, 0xFFFFFFFFu}) {
    for (const std::uint32_t at_infinity : {1u, 16u}) {
      const std::uint32_t radius = (radius_px << 16) - 12345;
      list.push_back({at_infinity * radius / 8, focus, radius, leak});
    }
  }
  return list;
}

void check_lenses(std::uint32_t radius_px,
                  std::vector<Lens> lenses_of(const SceneFrame&, std::uint32_t)) {
  Error all;
  double worst = 1e9, worst_unrounded = 1e9;
  for (const SceneFrame& frame : frames()) {
    for (const Lens& lens : lenses_of(frame, radius_px)) {
      Error error;
      add_error(error, frame, lens);
      worst = std::fmin(worst, psnr(error.squares, error.count));
      worst_unrounded = std::fmin(worst_unrounded, psnr(error.squares_unrounded, error.count));
      all.squares += error.squares;
      all.squares_unrounded += error.squares_unrounded;
      all.most = std::fmax(all.most, error.most);
      all.count += error.count;
    }
  }
  char text[160];
  std::snprintf(text, sizeof text,
                "error at radius %2u: PSNR %.1f dB (least %.1f), unrounded %.1f dB (least %.1f), "
                "largest %.0f",
                radius_px, psnr(all.squares, all.count), worst,
                psnr(all.squares_unrounded, all.count), worst_unrounded, all.most);
  INFO(text);
  CHECK(worst >= 55.0);
  CHECK(worst_unrounded >= 55.0);
  CHECK(all.most <= 2.0);
}

}  // namespace

TEST_CASE("fixed point: small circles are within 55 dB and 2 levels of binary64" *
          doctest::test_suite("long")) {
  for (const std::uint32_t radius : {1u, 2u, 4u, 8u}) check_lenses(radius, lenses);
}
TEST_CASE("fixed point: circles of radius 16 are within 55 dB and 2 levels of binary64" *
          doctest::test_suite("long")) {
  check_lenses(16, lenses);
}
TEST_CASE("fixed point: circles of radius 32 are within 55 dB and 2 levels of binary64" *
          doctest::test_suite("long")) {
  check_lenses(32, lenses);
}

TEST_CASE("fixed point: any leakage and broken radii are within 55 dB and 2 levels of binary64" *
          doctest::test_suite("long")) {
  for (const std::uint32_t radius : {2u, 8u, 16u}) check_lenses(radius, unusual_lenses);
}

TEST_CASE("fixed point: halves are within 60 dB of the filter in binary32") {
  ThreadPool pool(1);
  for (const SceneFrame& frame : frames()) {
    for (const float radius : {1.0f, 4.5f, 16.0f, 32.0f, 64.0f}) {
      for (const float focus : {0.3f, 1.2f, 20.0f}) {
        const DofSettings settings{
            .coc = {1.5f * radius, focus}, .max_coc_px = radius, .leak = 1.0f};
        Image floats = make_image(Format::rgba16f, kWidth, kHeight), integers = floats;
        two_pass({frame.drawn, settings, {}}, floats, pool);
        two_pass_in(Arithmetic::fixed, {frame.drawn, settings, {}}, integers, pool);
        double squares = 0;
        for (int y = 0; y < kHeight; ++y) {
          const auto a = row<std::uint16_t>(floats, y), b = row<std::uint16_t>(integers, y);
          for (std::size_t i = 0; i < a.size(); ++i) {
            const double off = half_to_float(a[i]) - half_to_float(b[i]);
            squares += i % 4 == 3 ? 0 : off * off;
          }
        }
        const double decibels =
            -10.0 * std::log10(std::fmax(squares / (3.0 * kWidth * kHeight), 1e-20));
        char text[120];
        std::snprintf(text, sizeof text, "error of halves, %s, radius %g, focus %g m: PSNR %.1f dB",
                      frame.name.c_str(), double(radius), double(focus), decibels);
        INFO(text);
        CHECK(decibels >= 60.0);
      }
    }
  }
}
