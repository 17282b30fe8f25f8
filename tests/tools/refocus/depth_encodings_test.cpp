// The table of depth encodings: each encoding's inverse is the oracle.

#include "tools/refocus/depth/depth_encodings.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tools/cli/errors.h"
#include "tools/refocus/depth/depth_map.h"

using namespace softfocus;

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Numbers that fit every encoding.
DepthNumbers all_numbers() {
  return {.near_m = 0.5,
          .far_m = 20.0,
          .scale = 0.25,
          .offset = 0.01,
          .baseline_m = 0.2,
          .focal_px = 1000.0};
}

DepthMap known_depths() {
  DepthMap map{8, 6, {}};
  for (int i = 0; i < 48; ++i) {
    map.metres.push_back(0.5f + 19.5f * static_cast<float>(i) / 47.0f);
  }
  return map;
}

double metres(const char* name, double code, DepthNumbers numbers = all_numbers()) {
  return find_depth_encoding(name)->distance_m(code, numbers);
}

DepthMap read(const char* name, const PlaneValues& codes, int width, int height,
              NumberType type = NumberType::single) {
  return depth_of_codes(codes, type, width, height,
                        {.encoding = find_depth_encoding(name), .numbers = all_numbers()}, {});
}

}  // namespace

TEST_CASE("depth encodings: codes of known depths give these depths, of every encoding") {
  const DepthMap known = known_depths();
  for (const DepthEncoding& encoding : depth_encodings()) {
    CAPTURE(encoding.name);
    for (const DepthAlong along : {DepthAlong::axis, DepthAlong::ray}) {
      DepthReading reading{.encoding = &encoding,
                           .numbers = all_numbers(),
                           .along = along,
                           .pixels_per_tangent = 5.0};
      // midas knows its least and largest code from the map alone: those of far and near.
      reading.numbers.least_code = 3.0;
      reading.numbers.largest_code = 11.0;
      if (encoding.name == "midas" && along == DepthAlong::ray) continue;
      const PlaneValues codes = codes_of_depth(known, NumberType::single, reading);
      const DepthMap back = depth_of_codes(codes, NumberType::single, 8, 6, reading, {});
      for (std::size_t i = 0; i < known.metres.size(); ++i) {
        CHECK(back.metres[i] == doctest::Approx(known.metres[i]).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("depth encodings: whole numbers count as parts of their largest where that is meant") {
  const DepthMap known = known_depths();
  for (const char* name : {"white-far", "white-near", "gdepth-linear", "gdepth-inverse", "device",
                           "device-reversed"}) {
    CAPTURE(name);
    const DepthReading reading{.encoding = find_depth_encoding(name), .numbers = all_numbers()};
    for (const NumberType type : {NumberType::unsigned8, NumberType::unsigned16}) {
      PlaneValues codes = codes_of_depth(known, type, reading);
      float largest = 0.0f;
      for (float& code : codes) {
        code = std::round(code);
        largest = std::max(largest, code);
      }
      CHECK(static_cast<double>(largest) == full_scale(type));
      const DepthMap back = depth_of_codes(codes, type, 8, 6, reading, {});
      CHECK(back.metres.front() == doctest::Approx(0.5f));
      CHECK(back.metres.back() == doctest::Approx(20.0f));
    }
  }
}

TEST_CASE("depth encodings: the equations of their sources, by hand") {
  CHECK(metres("millimetres", 1500) == 1.5);
  CHECK(metres("tum", 5000) == 1.0);
  CHECK(metres("centimetres", 250) == 2.5);
  CHECK(metres("kitti", 1536) == 6.0);
  CHECK(metres("sun-rgb-d", 1500 << 3) == 1.5);
  CHECK(metres("sun-rgb-d", (9001 << 3 | 9001 >> 13) & 0xFFFF) == 9.001);
  CHECK(metres("inverse", 2.0, {}) == 0.5);
  CHECK(metres("metres", 2.5, {}) == 2.5);
  // Middlebury 2014, Adirondack: f 4161.221, doffs 209.059, baseline 176.252 mm
  DepthNumbers adirondack;
  adirondack.focal_px = 4161.221;
  adirondack.baseline_m = 0.176252;
  adirondack.offset = 209.059;
  CHECK(metres("middlebury", 80.0, adirondack) == doctest::Approx(2.5372).epsilon(1e-4));
  // Cityscapes: p = 257 is a disparity of one pixel
  CHECK(metres("cityscapes", 257.0) == 200.0);
  CHECK(metres("device", 0.0) == 0.5);
  CHECK(metres("device", 1.0) == 20.0);
  CHECK(metres("device-reversed", 1.0) == 0.5);
  CHECK(metres("device-infinite", 0.5) == 1.0);
  CHECK(metres("device-infinite-reversed", 0.5) == 1.0);
  CHECK(metres("gdepth-inverse", 0.0) == 0.5);
  CHECK(metres("gdepth-linear", 0.5) == 10.25);
  CHECK(metres("white-near", 1.0) == 0.5);
  CHECK(metres("blender-mist", 0.25) == 10.25);
}

TEST_CASE("depth encodings: where nothing is, depth is infinite") {
  CHECK(std::isinf(metres("blender-z", 1e10)));
  CHECK(std::isinf(metres("device-infinite", 1.0)));
  CHECK(std::isinf(metres("device-infinite-reversed", 0.0)));
  CHECK(std::isinf(metres("inverse", 0.0, {})));
  CHECK(std::isinf(read("metres", {kInfinite, 1.0f}, 2, 1).metres[0]));
}

TEST_CASE("depth encodings: NaN, what an encoding says and what the user says is missing") {
  const auto missing = [](const char* name, float code) {
    const double known = find_depth_encoding(name)->code(3.0, all_numbers());
    return missing_depths(read(name, {code, static_cast<float>(known)}, 2, 1)) == 1;
  };
  for (const DepthEncoding& encoding : depth_encodings()) {
    CAPTURE(encoding.name);
    CHECK(missing(encoding.name.data(), kNone));
    CHECK(missing(encoding.name.data(), -kInfinite));
  }
  CHECK(missing("millimetres", 0.0f));
  CHECK(missing("metres", -1.0f));
  CHECK(missing("cityscapes", 0.0f));
  CHECK(missing("middlebury", kInfinite));
  CHECK_FALSE(missing("metres", kInfinite));
  const DepthReading reading{.encoding = find_depth_encoding("millimetres"),
                             .missing_codes = {65535.0}};
  const DepthMap map = depth_of_codes({65535.0f, 1000.0f, 2000.0f}, NumberType::unsigned16, 3, 1,
                                      reading, {1.0f, 1.0f, 0.0f});
  CHECK(missing_depths(map) == 2);  // the code, and what the mask hides
  CHECK(map.metres[1] == 1.0f);
}

TEST_CASE("depth encodings: what is nearer than a nanometre counts as so near") {
  const DepthReading reading{.encoding = find_depth_encoding("metres")};
  const DepthMap map =
      depth_of_codes({1e-40f, 2e-32f, 1e-9f, 1e-6f}, NumberType::single, 4, 1, reading, {});
  CHECK(map.metres == std::vector<float>{1e-9f, 1e-9f, 1e-9f, 1e-6f});
}

TEST_CASE("depth map: a hole is filled from the far side") {
  DepthMap map{5, 1, {1.0f, kNone, kNone, 7.0f, 2.0f}};
  fill_holes(map, Holes::far_side);
  CHECK(map.metres == std::vector<float>{1.0f, 7.0f, 7.0f, 7.0f, 2.0f});
}

TEST_CASE("depth map: one known pixel fills a map") {
  DepthMap map{7, 5, std::vector<float>(35, kNone)};
  map.metres[17] = 3.0f;
  fill_holes(map, Holes::far_side);
  CHECK(missing_depths(map) == 0);
  CHECK(map.metres[0] == 3.0f);
}

TEST_CASE("depth map: infinity fills holes beside it") {
  DepthMap map{3, 1, {1.0f, kNone, kInfinite}};
  fill_holes(map, Holes::far_side);
  CHECK(std::isinf(map.metres[1]));
}

TEST_CASE("depth map: a distance along the ray is longer than along the axis, but in the middle") {
  const DepthReading reading{.encoding = find_depth_encoding("metres"),
                             .along = DepthAlong::ray,
                             .pixels_per_tangent = 1.0};
  const DepthMap map = depth_of_codes({3.0f, 3.0f, 3.0f}, NumberType::single, 3, 1, reading, {});
  CHECK(map.metres[1] == 3.0f);
  CHECK(map.metres[0] == doctest::Approx(3.0 / std::sqrt(2.0)));
  CHECK(map.metres[2] == map.metres[0]);
}

TEST_CASE("depth encodings: a number that an encoding needs, or cannot use, is named") {
  const auto refused = [](const char* name, const DepthNumbers& numbers, const char* option) {
    try {
      check_depth_numbers(*find_depth_encoding(name), numbers);
    } catch (const UsageError& error) {
      return std::string{error.what()}.find(option) != std::string::npos;
    }
    return false;
  };
  DepthNumbers near_far;
  near_far.near_m = 1.0;
  CHECK(refused("device", near_far, "--far"));
  near_far.far_m = 0.5;
  CHECK(refused("device", near_far, "--near"));
  near_far.far_m = 5.0;
  CHECK_FALSE(refused("device", near_far, "--"));
  CHECK(refused("metres", near_far, "--near"));
  CHECK(refused("disparity", {}, "--baseline"));
}

TEST_CASE("believed encoding: millimetres, metres and Blender's Z are told by their numbers") {
  const auto believed = [](const PlaneValues& values, NumberType type) {
    const auto found = believed_encoding(numbers_seen(values, type), type, false, "Y");
    CHECK_FALSE(found.why.empty());
    return found.encoding == nullptr ? std::string_view{"none"} : found.encoding->name;
  };
  CHECK(believed({0, 700, 4000}, NumberType::unsigned16) == "millimetres");
  CHECK(believed({0, 700, 65535}, NumberType::unsigned16) == "none");
  CHECK(believed({0, 7, 255}, NumberType::unsigned8) == "none");
  CHECK(believed({1, 7, 1e10f}, NumberType::single) == "blender-z");
  CHECK(believed({1, 7, 20}, NumberType::single) == "metres");
  CHECK(believed({0, 0.5f, 1}, NumberType::single) == "none");
  CHECK(believed({-2, 0.5f, 7}, NumberType::half) == "none");
  PlaneValues sun;
  for (int mm = 1000; mm < 1040; ++mm) sun.push_back(static_cast<float>(mm << 3));
  CHECK(believed(sun, NumberType::unsigned16) == "none");
  CHECK(believed({8, 16, 8000}, NumberType::unsigned16) == "millimetres");
  const auto unreal = believed_encoding(numbers_seen({150, 9000}, NumberType::half),
                                        NumberType::half, false, "FinalImageWorldDepth.R");
  CHECK(unreal.encoding == find_depth_encoding("centimetres"));
}

namespace {

/// 64x64 metres: a disc of 1.5 m with a hole of `hole` pixels on a side, and `outside` around it.
DepthMap disc_with_hole(float outside, int hole) {
  DepthMap map{64, 64, {}};
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const int dx = x - 32, dy = y - 32;
      const bool in_hole = std::max(std::abs(dx), std::abs(dy)) * 2 < hole;
      map.metres.push_back(in_hole ? kNone : dx * dx + dy * dy < 400 ? 1.5f : outside);
    }
  }
  return map;
}

}  // namespace

TEST_CASE("holes: what touches the border or is larger than things is background") {
  DepthMap all_around = disc_with_hole(kNone, 6);
  const std::size_t missing = missing_depths(all_around);
  CHECK(fill_holes(all_around, Holes::background) == missing);  // the disc's hole, too
  CHECK(std::isinf(all_around.metres[0]));
  CHECK(std::isinf(all_around.metres[32 * 64 + 32]));
  CHECK(all_around.metres[32 * 64 + 20] == 1.5f);

  DepthMap in_room = disc_with_hole(4.0f, 6);
  CHECK(fill_holes(in_room, Holes::background) == 0);
  CHECK(in_room.metres[32 * 64 + 32] == 1.5f);

  DepthMap stripe = disc_with_hole(4.0f, 0);
  for (std::size_t y = 0; y < 64; ++y) stripe.metres[y * 64] = stripe.metres[y * 64 + 1] = kNone;
  CHECK(fill_holes(stripe, Holes::background) == 0);
  CHECK(stripe.metres[64 * 32] == 4.0f);

  DepthMap frame{64, 64, std::vector<float>(64 * 64, kNone)};
  for (std::size_t i = 0; i < 64; ++i) {
    frame.metres[i] = frame.metres[i * 64] = frame.metres[i * 64 + 63] = 2.0f;
    frame.metres[63 * 64 + i] = 2.0f;
  }
  CHECK(fill_holes(frame, Holes::background) == 62 * 62);
}

TEST_CASE("holes: all from the near side, the far side, or infinitely far") {
  const DepthMap map{5, 1, {1.0f, kNone, kNone, 7.0f, kNone}};
  const auto filled = [&](Holes holes) {
    DepthMap copy = map;
    fill_holes(copy, holes);
    return copy.metres;
  };
  CHECK(filled(Holes::near_side) == std::vector<float>{1, 1, 1, 7, 7});
  CHECK(filled(Holes::far_side) == std::vector<float>{1, 7, 7, 7, 7});
  CHECK(filled(Holes::infinity) == std::vector<float>{1, kInfinite, kInfinite, 7, kInfinite});
}
