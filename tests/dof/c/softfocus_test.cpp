// The C interface gives apply()'s bits, whatever memory the picture lies in.

#include "dof/c/softfocus.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "dof/auto/auto_method.h"
#include "dof/dof.h"
#include "dof/lens.h"
#include "tests/support/c_pictures.h"
#include "tests/support/test_images.h"

using namespace softfocus;
using namespace softfocus::test;

namespace {

constexpr int kWidth = 61, kHeight = 37;

/// A lens whose largest circles have some ten pixels.
softfocus_settings strong_lens() {
  softfocus_settings settings = c_settings();
  settings.blur_at_infinity_px = 9.0;
  settings.focus_m = 2.0;
  settings.max_radius_px = 12.0;
  return settings;
}

DofInput strong_input(const Image& scene) {
  return {.scene = scene,
          .settings = {.coc = {9.0f, 2.0f}, .max_coc_px = 12.0f},
          .profile = *find_profile("ieee")};
}

Image expected_of(const Method& method, const DofInput& input) {
  ThreadPool pool(1);
  return apply(method, input, pool);
}

Image refocused(const softfocus_picture& picture, const softfocus_settings& settings) {
  const Context context = open_context();
  Image result = make_image(Format::rgba16f, picture.width, picture.height);
  const softfocus_target target = c_target(result);
  const int status = softfocus_refocus(context.get(), &picture, &settings, &target, nullptr);
  INFO(softfocus_message(context.get()));
  CHECK(status == SOFTFOCUS_OK);
  return result;
}

/// How planes lie in memory: bytes from pixel to pixel, row to row, channel to channel; a depth.
struct Order {
  const char* name;
  std::ptrdiff_t pixel, row, channel;  // in values
  std::ptrdiff_t first;
  std::ptrdiff_t values;
};
constexpr std::array kOrders{
    Order{"interleaved", 3, 3 * kWidth, 1, 0, 3 * kWidth* kHeight},
    Order{"of four", 4, 4 * kWidth + 5, 1, 0, (4 * kWidth + 5) * kHeight},
    Order{"planes", 1, kWidth, kWidth* kHeight, 0, 3 * kWidth* kHeight},
    Order{"columns", kHeight, 1, kWidth* kHeight, 0, 3 * kWidth* kHeight},
    Order{"upside down", 3, -3 * kWidth, 1, 3 * kWidth*(kHeight - 1), 3 * kWidth* kHeight},
    Order{"mirrored", -3, 3 * kWidth, 1, 3 * (kWidth - 1), 3 * kWidth* kHeight}};

constexpr std::byte kUntouched{0x5A};

/// Numbers of one type in one order, not aligned.
struct Values {
  ChannelType type;
  const Order* order;
  std::vector<std::byte> memory;

  Values(ChannelType type_of, const Order& order_of)
      : type(type_of),
        order(&order_of),
        memory(static_cast<std::size_t>(1 + order_of.values * bytes_per_channel(type_of)),
               kUntouched) {}
  std::ptrdiff_t bytes(std::ptrdiff_t values) const { return values * bytes_per_channel(type); }
  std::byte* channel(int index) {
    return memory.data() + 1 + bytes(order->first + index * order->channel);
  }
  ColourTarget view() {
    return {type, channel(0), channel(1), channel(2), bytes(order->pixel), bytes(order->row)};
  }
};

}  // namespace

TEST_CASE("the C interface: every method and profile gives apply()'s bits") {
  const Image scene = random_scene_image(kWidth, kHeight, 1);
  const softfocus_picture picture = c_picture(scene);
  softfocus_settings settings = strong_lens();
  std::size_t count = 0;
  for (; softfocus_method_name(count) != nullptr; ++count) {
    const Method& method = methods()[count];
    settings.method = softfocus_method_name(count);
    CAPTURE(settings.method);
    CHECK(settings.method == std::string{method.name});
    CHECK(softfocus_method_summary(count) == std::string{method.summary});
    CHECK(equal(refocused(picture, settings), expected_of(method, strong_input(scene))));
  }
  CHECK(count == methods().size());
  CHECK(softfocus_method_summary(count) == nullptr);

  settings.method = "two-pass";
  for (count = 0; softfocus_profile_name(count) != nullptr; ++count) {
    const NamedProfile& profile = profiles()[count];
    settings.profile = softfocus_profile_name(count);
    CAPTURE(settings.profile);
    CHECK(settings.profile == std::string{profile.name});
    CHECK(softfocus_profile_summary(count) == std::string{profile.summary});
    DofInput input = strong_input(scene);
    input.profile = profile.profile;
    CHECK(equal(refocused(picture, settings), expected_of(*find_method("two-pass"), input)));
  }
  CHECK(count == profiles().size());
  CHECK(softfocus_profile_summary(count) == nullptr);
}

TEST_CASE("the C interface: colours and depths of every type and order are as pack() has them") {
  const Image scene = random_scene_image(kWidth, kHeight, 2);
  ThreadPool pool(1);
  const Context context = open_context();
  const softfocus_settings settings = strong_lens();
  constexpr std::array kTypes{ChannelType::half, ChannelType::single, ChannelType::unorm8,
                              ChannelType::srgb8};
  for (std::size_t type = 0; type < kTypes.size(); ++type) {
    for (const Order& order : kOrders) {
      for (const ChannelType depth_type : {ChannelType::half, ChannelType::single}) {
        INFO(order.name, ", type ", type + 1, ", depth ", static_cast<int>(depth_type));
        Values colours{kTypes[type], order}, depths{depth_type, order};
        unpack(scene, colours.view(), pool);
        softfocus_picture picture{};
        picture.struct_size = sizeof picture;
        picture.width = kWidth;
        picture.height = kHeight;
        picture.colour_type = static_cast<std::int32_t>(type) + 1;
        picture.red = colours.channel(0);
        picture.green = colours.channel(1);
        picture.blue = colours.channel(2);
        picture.pixel_bytes = colours.bytes(order.pixel);
        picture.row_bytes = colours.bytes(order.row);
        picture.depth_type = depth_type == ChannelType::half ? SOFTFOCUS_HALF : SOFTFOCUS_FLOAT;
        picture.depth = depths.channel(0);
        picture.depth_pixel_bytes = depths.bytes(order.pixel);
        picture.depth_row_bytes = depths.bytes(order.row);
        Image packed = make_image(Format::rgba16f, kWidth, kHeight);
        std::vector<float> metres;
        for (int y = 0; y < kHeight; ++y) {
          for (int x = 0; x < kWidth; ++x) {
            const std::uint16_t half =
                row<std::uint16_t>(scene, y)[static_cast<std::size_t>(4 * x + 3)];
            const float depth_m = half_to_float(half);
            metres.push_back(depth_m);
            std::byte* to =
                depths.channel(0) + x * picture.depth_pixel_bytes + y * picture.depth_row_bytes;
            if (depth_type == ChannelType::half) {
              std::memcpy(to, &half, sizeof half);
            } else {
              std::memcpy(to, &depth_m, sizeof depth_m);
            }
          }
        }
        pack(colours.view(), {metres.data(), 4, 4 * kWidth}, HalfRounding::nearest_even, packed,
             pool);
        const Image expected = expected_of(*find_method("two-pass"), strong_input(packed));

        // The result goes over the picture.
        softfocus_target target{};
        target.struct_size = sizeof target;
        target.colour_type = picture.colour_type;
        target.depth_type = picture.depth_type;
        target.red = colours.channel(0);
        target.green = colours.channel(1);
        target.blue = colours.channel(2);
        target.pixel_bytes = picture.pixel_bytes;
        target.row_bytes = picture.row_bytes;
        target.depth = depths.channel(0);
        target.depth_pixel_bytes = picture.depth_pixel_bytes;
        target.depth_row_bytes = picture.depth_row_bytes;
        const std::vector<std::byte> depths_before = depths.memory;
        CHECK(softfocus_refocus(context.get(), &picture, &settings, &target, nullptr) ==
              SOFTFOCUS_OK);
        Values wanted{kTypes[type], order};
        unpack(expected, wanted.view(), pool);
        CHECK(colours.memory == wanted.memory);  // and what lies between is untouched
        CHECK(depths.memory == depths_before);
      }
    }
  }
}

TEST_CASE("the C interface: halves with depth are refocused in place and upside down") {
  const Image scene = random_scene_image(kWidth, kHeight, 3);
  const Image expected = expected_of(*find_method("disc-layers"), strong_input(scene));
  const Context context = open_context();
  softfocus_settings settings = strong_lens();
  settings.method = "disc-layers";
  Image image = scene;
  const softfocus_picture picture = c_picture(image);
  softfocus_target target = c_target(image);
  REQUIRE(softfocus_refocus(context.get(), &picture, &settings, &target, nullptr) == SOFTFOCUS_OK);
  CHECK(equal(image, expected));

  image = scene;
  const softfocus_picture again = c_picture(image);
  Image flipped = make_image(Format::rgba16f, kWidth, kHeight);
  target = c_target(flipped);
  const auto last = target.row_bytes * (kHeight - 1);
  for (void** channel : {&target.red, &target.green, &target.blue, &target.depth}) {
    *channel = static_cast<std::byte*>(*channel) + last;
  }
  target.row_bytes = target.depth_row_bytes = -target.row_bytes;
  REQUIRE(softfocus_refocus(context.get(), &again, &settings, &target, nullptr) == SOFTFOCUS_OK);
  for (int y = 0; y < kHeight; ++y) {
    const auto a = row<std::uint16_t>(std::as_const(flipped), kHeight - 1 - y);
    const auto b = row<std::uint16_t>(expected, y);
    CHECK(std::equal(a.begin(), a.end(), b.begin()));
  }
}

TEST_CASE("the C interface: what is infinitely far has the horizon's circle") {
  Image scene = random_scene_image(kWidth, kHeight, 12);
  const auto with_sky = [&](float sky_m) {
    set_depth(scene, [&](int x, int y) { return y < 9 && x < 40 ? sky_m : 1.5f; });
    return scene;
  };
  const Image expected = expected_of(*find_method("two-pass"), strong_input(with_sky(65504.0f)));
  const Image sky = with_sky(std::numeric_limits<float>::infinity());
  CHECK(equal(refocused(c_picture(sky), strong_lens()), expected));
  std::vector<float> metres(kWidth * kHeight, 1.5f);
  for (int y = 0; y < 9; ++y) std::fill_n(metres.begin() + y * kWidth, 40, 1e9f);
  softfocus_picture picture = c_picture(sky);
  picture.depth = metres.data();
  picture.depth_type = SOFTFOCUS_FLOAT;
  picture.depth_pixel_bytes = 4;
  picture.depth_row_bytes = 4 * kWidth;
  CHECK(equal(refocused(picture, strong_lens()), expected));
}

TEST_CASE("the C interface: objects, radii and layers reach the methods") {
  const Image scene = random_scene_image(kWidth, kHeight, 4);
  std::vector<std::uint16_t> objects;
  std::vector<float> radii_px;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    objects.push_back(static_cast<std::uint16_t>(i / 300));
    radii_px.push_back(static_cast<float>(i % 7) - 3.0f);
  }
  softfocus_picture picture = c_picture(scene);
  softfocus_settings settings = strong_lens();

  picture.objects = objects.data();
  settings.method = "object-identification";
  DofInput input = strong_input(scene);
  input.objects = objects;
  CHECK(equal(refocused(picture, settings), expected_of(*find_method(settings.method), input)));

  picture.radii_px = radii_px.data();
  settings.method = "generalised-diffusion";
  input.radii_px = radii_px;
  CHECK(equal(refocused(picture, settings), expected_of(*find_method(settings.method), input)));
  picture.radii_px = nullptr;
  input.radii_px = {};

  const Image behind = random_scene_image(kWidth, kHeight, 5);
  const softfocus_picture behind_picture = c_picture(behind);
  const std::array behind_list{&behind_picture};
  const std::array<ConstImageView, 1> behind_views{behind};
  picture.behind = behind_list.data();
  picture.behind_count = 1;
  settings.method = "layered";
  input.behind = behind_views;
  CHECK(equal(refocused(picture, settings), expected_of(*find_method(settings.method), input)));

  const Image glass = random_scene_image(kWidth, kHeight, 6);
  Image opacity = random_scene_image(kWidth, kHeight, 7);
  const softfocus_picture glass_picture = c_picture(glass);
  softfocus_picture opacity_picture = c_picture(opacity);
  opacity_picture.depth = nullptr;  // not read
  const std::array glass_list{&glass_picture}, opacity_list{&std::as_const(opacity_picture)};
  picture.transparent = glass_list.data();
  picture.opacity = opacity_list.data();
  picture.transparent_count = 1;
  settings.method = "scatter-sorted";
  set_depth(opacity, [&](int x, int y) { return load_texel(glass, x, y).w; });
  const std::array<TransparentLayer, 1> layers{TransparentLayer{glass, opacity}};
  input.transparent = layers;
  CHECK(equal(refocused(picture, settings), expected_of(*find_method(settings.method), input)));
}

TEST_CASE("the C interface: the lens is a field of view, a sensor, or its blur at infinity") {
  const Image scene = random_scene_image(kWidth, kHeight, 8);
  const softfocus_picture picture = c_picture(scene);
  const Context context = open_context();
  const auto radius_of = [&](const softfocus_settings& settings) {
    softfocus_report report{};
    report.struct_size = sizeof report;
    CHECK(softfocus_plan(context.get(), &picture, &settings, &report) == SOFTFOCUS_OK);
    CHECK(report.method == std::string{"two-pass"});
    return report.radius_at_infinity_px;
  };
  softfocus_settings settings = c_settings();
  settings.focal_length_mm = 80.0;
  settings.f_number = 1.4;
  settings.focus_m = 3.0;
  settings.coc_scale = 2.0;
  const ThinLens lens{80.0, 1.4, 3.0};
  // Full frame, of which the picture has the whole height: 37 pixels for 24 mm.
  const double image_mm = 80.0 * 3000.0 / (3000.0 - 80.0);
  CHECK(radius_of(settings) ==
        doctest::Approx(80.0 / 1.4 / 2.0 / 3000.0 * image_mm * 61.0 / 36.0 * 2.0));
  settings.fov_y_degrees = 25.0;
  CHECK(radius_of(settings) ==
        static_cast<double>(pixel_coc(lens, 25.0, kHeight, 2.0).radius_at_infinity_px));
  settings.blur_at_infinity_px = 3.5;
  CHECK(radius_of(settings) == 3.5);
}

TEST_CASE("a sensor: the picture is its largest part of that shape, turned if the picture is") {
  CHECK(pixels_per_sensor_mm(36.0, 24.0, 3600, 2400) == 100.0);
  CHECK(pixels_per_sensor_mm(36.0, 24.0, 2400, 3600) == 100.0);
  CHECK(pixels_per_sensor_mm(36.0, 24.0, 3600, 1200) == 100.0);  // as wide as the sensor
  CHECK(pixels_per_sensor_mm(36.0, 24.0, 2400, 2400) == 100.0);  // as high
  const ThinLens lens{85.0, 2.0, 3.0};
  CHECK(sensor_coc(lens, 1000.0, 1.0).radius_at_infinity_px ==
        doctest::Approx(85.0 / 2.0 / 2.0 / 3000.0 * 1000.0));
}

TEST_CASE("the C interface: auto picks as auto_filter() does, and the report tells it") {
  const Image scene = random_scene_image(kWidth, kHeight, 9);
  const softfocus_picture picture = c_picture(scene);
  ThreadPool pool(1);
  softfocus_settings settings = strong_lens();
  settings.method = "auto";
  settings.max_radius_px = 0.0;
  settings.max_error = 0.1;
  const AutoMethod choice = auto_filter(scene, {9.0f, 2.0f}, {.max_error = 0.1}, {}, pool);
  const Context context = open_context();
  softfocus_report report{};
  report.struct_size = sizeof report;
  Image result = make_image(Format::rgba16f, kWidth, kHeight);
  const softfocus_target target = c_target(result);
  REQUIRE(softfocus_refocus(context.get(), &picture, &settings, &target, &report) == SOFTFOCUS_OK);
  CHECK(report.method == std::string{choice.method});
  CHECK(report.predicted_error == choice.predicted_error);
  CHECK(report.max_radius_px == static_cast<double>(choice.radius_px));
  const CircleSizes sizes = circle_sizes(scene, {9.0f, 2.0f}, choice.radius_px, pool);
  CHECK(report.largest_radius_px == static_cast<double>(sizes.largest_px));
  CHECK(report.share_cut == sizes.beyond_limit);
  DofInput input = strong_input(scene);
  input.settings.max_coc_px = choice.radius_px;
  CHECK(equal(result, expected_of(*find_method(choice.method), input)));
}

TEST_CASE("the C interface: without a largest radius nothing is cut, a caller's radii neither") {
  const Image scene = random_scene_image(kWidth, kHeight, 10);
  softfocus_picture picture = c_picture(scene);
  softfocus_settings settings = strong_lens();
  settings.max_radius_px = 0.0;
  const Context context = open_context();
  softfocus_report report{};
  report.struct_size = sizeof report;
  REQUIRE(softfocus_plan(context.get(), &picture, &settings, &report) == SOFTFOCUS_OK);
  CHECK(report.largest_radius_px > 12.0);
  CHECK(report.max_radius_px == std::ceil(report.largest_radius_px));
  CHECK(report.share_cut == 0.0);
  const std::vector<float> radii_px(kWidth * kHeight, -700.0f);
  picture.radii_px = radii_px.data();
  REQUIRE(softfocus_plan(context.get(), &picture, &settings, &report) == SOFTFOCUS_OK);
  CHECK(report.max_radius_px == 700.0);
}

TEST_CASE("the C interface: calls of several threads on one context wait for each other" *
          doctest::test_suite("threads")) {
  const Image scene = random_scene_image(kWidth, kHeight, 11);
  const Image expected = expected_of(*find_method("two-pass"), strong_input(scene));
  const softfocus_picture picture = c_picture(scene);
  const softfocus_settings settings = strong_lens();
  const Context context = open_context(2);
  std::array<Image, 3> results;
  std::array<int, 3> statuses{};
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i] = make_image(Format::rgba16f, kWidth, kHeight);
    threads.emplace_back([&, i] {
      const softfocus_target target = c_target(results[i]);
      for (int n = 0; n < 5; ++n) {
        statuses[i] += softfocus_refocus(context.get(), &picture, &settings, &target, nullptr);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < results.size(); ++i) {
    CHECK(statuses[i] == SOFTFOCUS_OK);
    CHECK(equal(results[i], expected));
  }
}
