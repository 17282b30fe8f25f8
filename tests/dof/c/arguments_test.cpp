// The C interface refuses wrong arguments with one sentence, and writes nothing.

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dof/c/softfocus.h"
#include "tests/support/c_pictures.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr int kSide = 16;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::ptrdiff_t kFarthest = PTRDIFF_MAX, kFarthestBack = PTRDIFF_MIN;

/// A call that would succeed.
struct Call {
  Image scene = random_scene_image(kSide, kSide, 1);
  Image result = make_image(Format::rgba16f, kSide, kSide);
  softfocus_picture picture = c_picture(scene);
  softfocus_settings settings = c_settings();
  softfocus_target target = c_target(result);
  softfocus_report report{};
  Call() { report.struct_size = sizeof report; }
};

/// Checks that the changed call is refused with these words and writes nothing.
void check_refused(const std::function<void(Call&)>& change, const std::string& words) {
  const Context context = open_context(1);
  Call call;
  change(call);
  const Image before = call.result;
  const int status =
      softfocus_refocus(context.get(), &call.picture, &call.settings, &call.target, &call.report);
  const std::string message = softfocus_message(context.get());
  CAPTURE(words);
  CAPTURE(message);
  CHECK(status == SOFTFOCUS_BAD_ARGUMENT);
  CHECK(message.find(words) != message.npos);
  CHECK(call.result.bytes == before.bytes);
  CHECK(call.report.method == nullptr);

  // The context is as good as before.
  Call good;
  CHECK(softfocus_refocus(context.get(), &good.picture, &good.settings, &good.target, nullptr) ==
        SOFTFOCUS_OK);
  CHECK(std::string{softfocus_message(context.get())}.empty());
}

}  // namespace

TEST_CASE("the C interface: null pointers are refused by name") {
  const Context context = open_context(1);
  Call call;
  const auto refused = [&](const softfocus_picture* picture, const softfocus_settings* settings,
                           const softfocus_target* target, const std::string& words) {
    CHECK(softfocus_refocus(context.get(), picture, settings, target, nullptr) ==
          SOFTFOCUS_BAD_ARGUMENT);
    CHECK(softfocus_message(context.get()) == words + ": a null pointer");
  };
  refused(nullptr, &call.settings, &call.target, "picture");
  refused(&call.picture, nullptr, &call.target, "settings");
  refused(&call.picture, &call.settings, nullptr, "target");
  CHECK(softfocus_plan(context.get(), &call.picture, &call.settings, nullptr) ==
        SOFTFOCUS_BAD_ARGUMENT);
  CHECK(softfocus_refocus(nullptr, &call.picture, &call.settings, &call.target, nullptr) ==
        SOFTFOCUS_BAD_ARGUMENT);
  CHECK(softfocus_message(nullptr) == std::string{"there is no context (a null pointer)"});
  softfocus_close(nullptr);
  softfocus_init_settings(nullptr, sizeof call.settings);

  check_refused([](Call& c) { c.picture.red = nullptr; }, "picture.red: a null pointer");
  check_refused([](Call& c) { c.picture.depth = nullptr; }, "picture.depth: a null pointer");
  check_refused([](Call& c) { c.target.blue = nullptr; }, "target.blue: a null pointer");
  check_refused([](Call& c) { c.settings.method = nullptr; }, "settings.method: a null pointer");
  check_refused([](Call& c) { c.settings.profile = nullptr; }, "settings.profile: a null pointer");
  check_refused([](Call& c) { c.picture.behind_count = 1; }, "picture.behind: a null pointer");
  check_refused(
      [](Call& c) {
        static const softfocus_picture* nothing = nullptr;
        c.picture.transparent = c.picture.opacity = &nothing;
        c.picture.transparent_count = 1;
      },
      "picture.transparent[0]: a null pointer");
}

TEST_CASE("the C interface: threads from 0 to 256 open a context") {
  softfocus_context* context = nullptr;
  CHECK(softfocus_open(nullptr, 1) == SOFTFOCUS_BAD_ARGUMENT);
  for (const int threads : {-1, 257, 1 << 30}) {
    CHECK(softfocus_open(&context, threads) == SOFTFOCUS_BAD_ARGUMENT);
    CHECK(context == nullptr);
  }
  CHECK(softfocus_open(&context, 0) == SOFTFOCUS_OK);
  softfocus_close(context);
}

TEST_CASE("the C interface: sizes, types and strides are checked") {
  for (const std::int32_t side : {0, -1, 16385, INT32_MAX}) {
    check_refused([&](Call& c) { c.picture.width = side; }, "from 1 to 16384");
    check_refused([&](Call& c) { c.picture.height = side; }, "from 1 to 16384");
  }
  for (const std::int32_t type : {0, 5, -1}) {
    check_refused([&](Call& c) { c.picture.colour_type = type; }, "picture.colour_type: ");
    check_refused([&](Call& c) { c.target.colour_type = type; }, "target.colour_type: ");
  }
  check_refused([](Call& c) { c.picture.depth_type = SOFTFOCUS_SRGB8; }, "no type of depths");
  check_refused([](Call& c) { c.target.depth_type = 0; }, "target.depth_type: 0 is no type");

  for (const std::ptrdiff_t far : {kFarthest, kFarthestBack, kFarthest / 8, kFarthestBack / 8}) {
    check_refused([&](Call& c) { c.picture.row_bytes = far; }, "outside of memory");
    check_refused([&](Call& c) { c.picture.depth_pixel_bytes = far; }, "outside of memory");
    check_refused([&](Call& c) { c.target.pixel_bytes = far; }, "outside of memory");
  }
  for (const std::ptrdiff_t short_of : {0, 1, -1, 8, 121}) {
    check_refused([&](Call& c) { c.target.row_bytes = short_of; }, "lie over each other");
  }
  check_refused([](Call& c) { c.target.depth_pixel_bytes = 0; }, "target.depth: ");
  check_refused([](Call& c) { c.picture.objects = reinterpret_cast<const std::uint16_t*>(1); },
                "picture.objects: not aligned");
}

TEST_CASE("the C interface: a lens that cannot be is refused by the field") {
  const auto refused = [](double softfocus_settings::*field, const std::vector<double>& values,
                          const std::string& name) {
    for (const double value : values) {
      check_refused([&](Call& c) { c.settings.*field = value; }, name);
    }
  };
  using Settings = softfocus_settings;
  refused(&Settings::focal_length_mm, {kNan, 0.0, -50.0, kInfinity}, "settings.focal_length_mm: ");
  refused(&Settings::focal_length_mm, {2000.0}, "shorter than the focus distance");
  refused(&Settings::f_number, {kNan, 0.0, -1.0, kInfinity}, "settings.f_number: ");
  check_refused(
      [](Call& c) {
        c.settings.f_number = 1e-9, c.settings.coc_scale = 1e9, c.settings.sensor_height_mm = 1e-9;
        c.settings.focal_length_mm = std::nextafter(1e3 * c.settings.focus_m, 0.0);
      },
      "too large");
  refused(&Settings::focus_m, {kNan, 0.0, -1.0, kInfinity, 1e300}, "settings.focus_m: ");
  refused(&Settings::sensor_width_mm, {kNan, 0.0, -36.0, kInfinity}, "settings.sensor_width_mm: ");
  refused(&Settings::sensor_height_mm, {kNan, 0.0}, "settings.sensor_height_mm: ");
  refused(&Settings::fov_y_degrees, {kNan, -1.0, 180.0, 1e9}, "settings.fov_y_degrees: ");
  refused(&Settings::coc_scale, {kNan, -1.0, 3e38, kInfinity}, "settings.coc_scale: ");
  refused(&Settings::blur_at_infinity_px, {kNan, -1.0, kInfinity}, "settings.blur_at_infinity_px");
  refused(&Settings::max_radius_px, {kNan, -1.0, 1025.0}, "settings.max_radius_px: ");
  refused(&Settings::leak, {kNan, -1.0, 1e300}, "settings.leak: ");
  refused(&Settings::budget, {kNan, -0.1, 1.1}, "settings.budget: ");
  refused(&Settings::max_error, {kNan, -0.1}, "settings.max_error: ");
  check_refused([](Call& c) { c.settings.method = "two_pass"; },
                "there are auto, pinhole, two-pass");
  check_refused([](Call& c) { c.settings.method = "accumulation"; }, "there is no 'accumulation'");
  check_refused([](Call& c) { c.settings.profile = ""; }, "there is no ''; there are ieee");
}

TEST_CASE("the C interface: layers are pictures of the same size without any of their own") {
  const Call other;
  std::array<softfocus_picture, 1> layer{};
  const softfocus_picture* const list[1] = {layer.data()};
  const auto refused = [&](const std::function<void(softfocus_picture&)>& change,
                           const std::string& words) {
    layer[0] = other.picture;
    change(layer[0]);
    check_refused(
        [&](Call& c) {
          c.picture.behind = list;
          c.picture.behind_count = 1;
        },
        "picture.behind[0]" + words);
  };
  refused([](auto& picture) { picture.width = 15; }, ": it has not the size of the picture");
  refused([](auto& picture) { picture.behind_count = 1; }, ": a layer has no");
  refused([](auto& picture) { picture.struct_size = 0; }, ".struct_size: 0");
  refused([](auto& picture) { picture.green = nullptr; }, ".green: a null pointer");
  for (const std::int32_t count : {-1, 4}) {
    check_refused([&](Call& c) { c.picture.behind_count = count; }, "is not from 0 to 3");
  }
  check_refused([](Call& c) { c.picture.transparent_count = 5; }, "is not from 0 to 4");
  const std::vector<float> radii_px(kSide * kSide, std::numeric_limits<float>::infinity());
  check_refused([&](Call& c) { c.picture.radii_px = radii_px.data(); }, "a radius is not finite");
}

TEST_CASE("the C interface: a struct of a later version is taken if what it adds is not set") {
  struct Later {
    softfocus_settings settings;
    std::array<double, 2> more;
  };
  Later later;
  std::memset(static_cast<void*>(&later), 0x7F, sizeof later);
  softfocus_init_settings(&later.settings, sizeof later);
  CHECK(later.settings.struct_size == sizeof later);
  CHECK(later.settings.focal_length_mm == 50.0);
  CHECK(later.more[0] == 0.0);
  CHECK(later.more[1] == 0.0);
  const Context context = open_context(1);
  Call call;
  CHECK(softfocus_refocus(context.get(), &call.picture, &later.settings, &call.target, nullptr) ==
        SOFTFOCUS_OK);
  later.more[1] = 1.0;
  CHECK(softfocus_refocus(context.get(), &call.picture, &later.settings, &call.target, nullptr) ==
        SOFTFOCUS_BAD_ARGUMENT);
  CHECK(std::string{softfocus_message(context.get())} ==
        "settings: a field is set that this library does not know; a newer libsoftfocus does");

  struct LaterReport {
    softfocus_report report;
    double more;
  } report{};
  report.report.struct_size = sizeof report;
  report.more = 1.0;
  REQUIRE(softfocus_plan(context.get(), &call.picture, &call.settings, &report.report) ==
          SOFTFOCUS_OK);
  CHECK(report.report.method == std::string{"two-pass"});
  CHECK(report.report.struct_size == sizeof report);
  CHECK(report.more == 0.0);

  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, sizeof(softfocus_picture) - 1,
                                 std::size_t{4097}, SIZE_MAX}) {
    check_refused([&](Call& c) { c.picture.struct_size = size; }, "picture.struct_size: ");
    check_refused([&](Call& c) { c.target.struct_size = std::min(size, std::size_t{8}); },
                  "target.struct_size: ");
    check_refused([&](Call& c) { c.report.struct_size = std::min(size, std::size_t{8}); },
                  "report.struct_size: ");
  }
}

TEST_CASE("the C interface: any bits of colour and depth are a picture") {
  Call call;
  Random random{12};
  for (std::byte& byte : call.scene.bytes) byte = static_cast<std::byte>(random.next());
  const Context context = open_context(1);
  for (std::size_t i = 0; softfocus_method_name(i) != nullptr; ++i) {
    call.settings.method = softfocus_method_name(i);
    CAPTURE(call.settings.method);
    CHECK(softfocus_refocus(context.get(), &call.picture, &call.settings, &call.target,
                            &call.report) == SOFTFOCUS_OK);
  }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
TEST_CASE("the C interface: too little memory is a code, and the context lives on") {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    // One pixel, shown 8192 x 8192 times: half a gigabyte as halves.
    const Context context = open_context(1);
    const float light = 1.0f;
    Call call;
    softfocus_picture& picture = call.picture;
    picture.width = picture.height = 8192;
    picture.colour_type = picture.depth_type = SOFTFOCUS_FLOAT;
    picture.red = picture.green = picture.blue = picture.depth = &light;
    picture.pixel_bytes = picture.row_bytes = 0;
    picture.depth_pixel_bytes = picture.depth_row_bytes = 0;
    const rlimit limit{rlim_t{256} << 20, rlim_t{256} << 20};
    ::setrlimit(RLIMIT_AS, &limit);
    bool fine = softfocus_plan(context.get(), &picture, &call.settings, &call.report) ==
                SOFTFOCUS_NO_MEMORY;
    fine = fine && std::string{softfocus_message(context.get())} == "there is not enough memory";
    Call good;
    fine = fine && softfocus_plan(context.get(), &good.picture, &good.settings, &good.report) ==
                       SOFTFOCUS_OK;
    ::_exit(fine ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
}
#endif
