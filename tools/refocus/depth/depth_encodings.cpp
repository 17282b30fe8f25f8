#include "tools/refocus/depth/depth_encodings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/cli/errors.h"

namespace softfocus {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double scale_of(const DepthNumbers& n) { return n.scale.value_or(1.0); }
double offset_of(const DepthNumbers& n) { return n.offset.value_or(0.0); }

// z = scale d + offset
double metres_of(double d, const DepthNumbers& n) { return scale_of(n) * d + offset_of(n); }
double of_metres(double z, const DepthNumbers& n) { return (z - offset_of(n)) / scale_of(n); }

double metres_of_mm(double d, const DepthNumbers&) { return d / 1000.0; }
double mm_of_metres(double z, const DepthNumbers&) { return z * 1000.0; }

double metres_of_tum(double d, const DepthNumbers&) { return d / 5000.0; }
double tum_of_metres(double z, const DepthNumbers&) { return z * 5000.0; }

double metres_of_cm(double d, const DepthNumbers&) { return d / 100.0; }
double cm_of_metres(double z, const DepthNumbers&) { return z * 100.0; }

// Geiger et al. 2013
double metres_of_kitti(double d, const DepthNumbers&) { return d / 256.0; }
double kitti_of_metres(double z, const DepthNumbers&) { return z * 256.0; }

// Whole millimetres whose 16 bits are turned left by three (Song et al. 2015); between whole ones
// the rest is added.
double turned_left(double number, unsigned bits) {
  const double whole = std::floor(std::clamp(number, 0.0, 65535.0));
  const auto code = static_cast<std::uint32_t>(whole);
  return ((code << bits | code >> (16 - bits)) & 0xFFFF) + (number - whole);
}
double metres_of_sun(double d, const DepthNumbers&) { return turned_left(d, 13) / 1000.0; }
double sun_of_metres(double z, const DepthNumbers&) { return turned_left(z * 1000.0, 3); }

// z = 1 / (scale d + offset)
double metres_of_inverse(double d, const DepthNumbers& n) {
  const double inverse = metres_of(d, n);
  return inverse == 0.0 ? kInfinity : 1.0 / inverse;
}
double inverse_of_metres(double z, const DepthNumbers& n) { return of_metres(1.0 / z, n); }

// z = focal_px baseline / (scale d + offset); the offset is Middlebury's doffs
double metres_of_disparity(double d, const DepthNumbers& n) {
  const double pixels = metres_of(d, n);
  return pixels == 0.0 ? kInfinity : *n.focal_px * *n.baseline_m / pixels;
}
double disparity_of_metres(double z, const DepthNumbers& n) {
  return of_metres(*n.focal_px * *n.baseline_m / z, n);
}

// d = (p - 1) / 256 (Cordts et al. 2016)
double metres_of_cityscapes(double p, const DepthNumbers& n) {
  const double pixels = (p - 1.0) / 256.0;
  return pixels == 0.0 ? kInfinity : *n.focal_px * *n.baseline_m / pixels;
}
double cityscapes_of_metres(double z, const DepthNumbers& n) {
  return *n.focal_px * *n.baseline_m / z * 256.0 + 1.0;
}

// z = near far / (far - d (far - near)): a perspective projection onto [0, 1]
double metres_of_device(double d, const DepthNumbers& n) {
  return *n.near_m * *n.far_m / (*n.far_m - d * (*n.far_m - *n.near_m));
}
double device_of_metres(double z, const DepthNumbers& n) {
  return *n.far_m * (z - *n.near_m) / (z * (*n.far_m - *n.near_m));
}
double metres_of_reversed(double d, const DepthNumbers& n) { return metres_of_device(1.0 - d, n); }
double reversed_of_metres(double z, const DepthNumbers& n) { return 1.0 - device_of_metres(z, n); }

// metres_of_device() with far at infinity: d = 1 - near / z
double metres_of_infinite(double d, const DepthNumbers& n) {
  return d >= 1.0 ? kInfinity : *n.near_m / (1.0 - d);
}
double infinite_of_metres(double z, const DepthNumbers& n) { return 1.0 - *n.near_m / z; }
double metres_of_infinite_reversed(double d, const DepthNumbers& n) {
  return d <= 0.0 ? kInfinity : *n.near_m / d;
}
double infinite_reversed_of_metres(double z, const DepthNumbers& n) { return *n.near_m / z; }

// z = near + d (far - near)
double metres_of_linear(double d, const DepthNumbers& n) {
  return *n.near_m + d * (*n.far_m - *n.near_m);
}
double linear_of_metres(double z, const DepthNumbers& n) {
  return (z - *n.near_m) / (*n.far_m - *n.near_m);
}
double metres_of_white_near(double d, const DepthNumbers& n) {
  return metres_of_linear(1.0 - d, n);
}
double white_near_of_metres(double z, const DepthNumbers& n) {
  return 1.0 - linear_of_metres(z, n);
}

// 1/z runs in a line from 1/far at the least code to 1/near at the largest; one code alone is far
double span_of_codes(const DepthNumbers& n) {
  return n.largest_code > n.least_code ? n.largest_code - n.least_code : 1.0;
}
double metres_of_midas(double d, const DepthNumbers& n) {
  const double share = (d - n.least_code) / span_of_codes(n);
  return 1.0 / (1.0 / *n.far_m + share * (1.0 / *n.near_m - 1.0 / *n.far_m));
}
double midas_of_metres(double z, const DepthNumbers& n) {
  const double share = (1.0 / z - 1.0 / *n.far_m) / (1.0 / *n.near_m - 1.0 / *n.far_m);
  return n.least_code + share * span_of_codes(n);
}

// Blender writes 1e10 where there is nothing.
constexpr double kBlendersNothing = 1e10;
double metres_of_blender(double d, const DepthNumbers&) {
  return d >= 0.99 * kBlendersNothing ? kInfinity : d;
}
double blender_of_metres(double z, const DepthNumbers&) {
  return z == kInfinity ? kBlendersNothing : z;
}

// Mist with its usual falloff: the square of the share of the way from start to end
double metres_of_mist(double d, const DepthNumbers& n) {
  return d < 0.0 ? 0.0 : metres_of_linear(std::sqrt(d), n);
}
double mist_of_metres(double z, const DepthNumbers& n) {
  const double share = linear_of_metres(z, n);
  return share * share;
}

constexpr double kCirclesFocus = 16.0;
double horizon_of(const DepthNumbers& n) { return std::max(1.125 * n.largest_code, 4.0); }
double metres_of_circle(double radius, const DepthNumbers& n) {
  return kCirclesFocus * horizon_of(n) / (horizon_of(n) - radius);
}
double circle_of_metres(double z, const DepthNumbers& n) {
  return horizon_of(n) * (z - kCirclesFocus) / z;
}

constexpr DepthAlong kAxis = DepthAlong::axis, kRay = DepthAlong::ray;
// name, summary, needs, takes, along, by full scale, 0 is missing, infinity is far, functions
constexpr std::array kEncodings{
    DepthEncoding{"metres", "metres, times --scale, plus --offset", "", "scale offset", kAxis,
                  false, true, true, metres_of, of_metres},
    DepthEncoding{"millimetres", "whole millimetres (Kinect, RealSense)", "", "", kAxis, false,
                  true, false, metres_of_mm, mm_of_metres},
    DepthEncoding{"centimetres", "centimetres (Unreal, Virtual KITTI)", "", "", kAxis, false, true,
                  true, metres_of_cm, cm_of_metres},
    DepthEncoding{"kitti", "256 a metre (KITTI's depth)", "", "", kAxis, false, true, false,
                  metres_of_kitti, kitti_of_metres},
    DepthEncoding{"sun-rgb-d", "whole millimetres, their 16 bits turned left by 3 (SUN RGB-D)", "",
                  "", kAxis, false, true, false, metres_of_sun, sun_of_metres},
    DepthEncoding{"tum", "5000 a metre (TUM RGB-D)", "", "", kAxis, false, true, false,
                  metres_of_tum, tum_of_metres},
    DepthEncoding{"inverse", "1/metres, dioptres, a phone's disparity: 1 / (scale d + offset)", "",
                  "scale offset", kAxis, false, false, false, metres_of_inverse, inverse_of_metres},
    DepthEncoding{"disparity", "pixels between two cameras: focal-px baseline / (scale d + offset)",
                  "baseline focal-px", "scale offset", kAxis, false, true, false,
                  metres_of_disparity, disparity_of_metres},
    DepthEncoding{"middlebury", "the same, infinity where unknown; --offset is its doffs",
                  "baseline focal-px", "scale offset", kAxis, false, false, false,
                  metres_of_disparity, disparity_of_metres},
    DepthEncoding{"cityscapes", "disparity of (p - 1) / 256 pixels, 0 where unknown",
                  "baseline focal-px", "", kAxis, false, true, false, metres_of_cityscapes,
                  cityscapes_of_metres},
    DepthEncoding{"device", "a depth buffer of [0, 1], 0 near", "near far", "", kAxis, true, false,
                  false, metres_of_device, device_of_metres},
    DepthEncoding{"device-reversed", "a depth buffer of [0, 1], 1 near", "near far", "", kAxis,
                  true, false, false, metres_of_reversed, reversed_of_metres},
    DepthEncoding{"device-infinite", "a depth buffer without a far plane, 0 near", "near", "",
                  kAxis, true, false, false, metres_of_infinite, infinite_of_metres},
    DepthEncoding{"device-infinite-reversed", "a depth buffer without a far plane, 1 near", "near",
                  "", kAxis, true, false, false, metres_of_infinite_reversed,
                  infinite_reversed_of_metres},
    DepthEncoding{"white-far", "a grey picture, black at near, white at far", "near far", "", kAxis,
                  true, false, false, metres_of_linear, linear_of_metres},
    DepthEncoding{"white-near", "a grey picture, white at near, black at far", "near far", "",
                  kAxis, true, false, false, metres_of_white_near, white_near_of_metres},
    DepthEncoding{"gdepth-inverse", "Google's GDepth, RangeInverse: 0 near, in steps of 1/metres",
                  "near far", "", kAxis, true, false, false, metres_of_device, device_of_metres},
    DepthEncoding{"gdepth-linear", "Google's GDepth, RangeLinear: 0 near, in steps of metres",
                  "near far", "", kAxis, true, false, false, metres_of_linear, linear_of_metres},
    DepthEncoding{"midas", "1/metres of unknown scale (MiDaS and its like): largest code at near",
                  "near far", "", kAxis, false, false, false, metres_of_midas, midas_of_metres,
                  true},
    DepthEncoding{"blender-z", "metres, 1e10 where there is nothing", "", "", kAxis, false, true,
                  true, metres_of_blender, blender_of_metres},
    DepthEncoding{"blender-mist", "mist of quadratic falloff from near to far, along the ray",
                  "near far", "", kRay, true, false, false, metres_of_mist, mist_of_metres}};

bool lists(std::string_view list, std::string_view word) {
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t blank = std::min(list.find(' ', at), list.size());
    if (list.substr(at, blank - at) == word) return true;
    at = blank + 1;
  }
  return false;
}

}  // namespace

std::span<const DepthEncoding> depth_encodings() { return kEncodings; }

const DepthEncoding& circles_encoding() {
  static constexpr DepthEncoding kCircles{
      "circles",        "radii in pixels", "",  "", kAxis, false, false, false,
      metres_of_circle, circle_of_metres,  true};
  return kCircles;
}

PixelCoc coc_of_circles(const DepthNumbers& numbers) {
  return {static_cast<float>(horizon_of(numbers)), static_cast<float>(kCirclesFocus)};
}

const DepthEncoding* find_depth_encoding(std::string_view name) {
  for (const DepthEncoding& encoding : kEncodings) {
    if (encoding.name == name) return &encoding;
  }
  return nullptr;
}

void check_depth_numbers(const DepthEncoding& encoding, const DepthNumbers& numbers) {
  struct NamedNumber {
    std::string_view name;
    const std::optional<double>& value;
    bool may_be_idle;  // focal-px gives the field of view, too
  };
  const std::array named{NamedNumber{"near", numbers.near_m, false},
                         NamedNumber{"far", numbers.far_m, false},
                         NamedNumber{"scale", numbers.scale, false},
                         NamedNumber{"offset", numbers.offset, false},
                         NamedNumber{"baseline", numbers.baseline_m, false},
                         NamedNumber{"focal-px", numbers.focal_px, true}};
  const std::string what = "--depth-encoding " + std::string{encoding.name};
  for (const NamedNumber& number : named) {
    const std::string option = "--" + std::string{number.name};
    if (lists(encoding.needs, number.name) && !number.value) {
      throw UsageError(std::string{what}.append(" needs ").append(option).append(
          "; --help says which others it knows"));
    }
    if (number.value && !number.may_be_idle && !lists(encoding.needs, number.name) &&
        !lists(encoding.takes, number.name)) {
      throw UsageError(std::string{option}.append(": ").append(what).append(
          " makes no use of it; leave it out"));
    }
  }
  if (numbers.near_m && numbers.far_m && !(*numbers.near_m < *numbers.far_m)) {
    throw UsageError("--near must be less than --far");
  }
}

NumberCounter::NumberCounter(NumberType type)
    : least_(std::numeric_limits<double>::infinity()),
      largest_(-least_),
      there_(type == NumberType::unsigned8 || type == NumberType::unsigned16 ? 65536 : 0) {}

void NumberCounter::add(std::span<const float> values) {
  seen_.count += values.size();
  for (const float value : values) {
    seen_.nans += value != value;
    seen_.infinities += std::isinf(value);
    seen_.zeros += value == 0.0f;
    seen_.negatives += value < 0.0f;
    if (!std::isfinite(value)) continue;
    least_ = std::min(least_, static_cast<double>(value));
    largest_ = std::max(largest_, static_cast<double>(value));
    if (!there_.empty()) there_[static_cast<std::size_t>(value)] = true;
  }
}

NumbersSeen NumberCounter::seen() const {
  NumbersSeen seen = seen_;
  seen.different = static_cast<std::size_t>(std::count(there_.begin(), there_.end(), true));
  for (std::size_t i = 0; i < there_.size(); ++i) seen.eighths += there_[i] && i % 8 == 0;
  if (least_ <= largest_) {
    seen.least = least_;
    seen.largest = largest_;
  }
  return seen;
}

NumbersSeen numbers_seen(const PlaneValues& values, NumberType type) {
  NumberCounter counter{type};
  counter.add(values);
  return counter.seen();
}

bool knows_nothing(const NumbersSeen& seen) { return seen.count > 0 && seen.nans == seen.count; }

BelievedEncoding believed_encoding(const NumbersSeen& seen, NumberType type, bool is_ours,
                                   std::string_view channel) {
  // A sensor has noise: that so many numbers have three bits of 0 is no chance.
  constexpr std::size_t kManyNumbers = 32;
  if (is_ours) return {find_depth_encoding("metres"), "softfocus wrote it, in metres"};
  if (knows_nothing(seen)) return {nullptr, "all its numbers are NaN, or beyond the data window"};
  switch (type) {
    case NumberType::unsigned8:
      return {nullptr,
              "8 bits may be white-near, white-far, gdepth-inverse or midas, which look alike; "
              "their near "
              "and far must be said anyway"};
    case NumberType::unsigned16:
      if (seen.largest >= 60000.0) {
        return {nullptr,
                "16 bits that use the whole range may be a depth buffer, a grey picture, tum, "
                "sun-rgb-d or cityscapes"};
      }
      if (seen.different > kManyNumbers && seen.eighths == seen.different) {
        return {nullptr,
                "16 bits that are all multiples of 8 may be sun-rgb-d, or millimetres in steps "
                "of 8"};
      }
      return {find_depth_encoding("millimetres"),
              "16 bits that stay below 60000: millimetres, as most depth cameras write, but not "
              "kitti, tum and sun-rgb-d"};
    default: break;
  }
  for (const std::string_view unreal : {"WorldDepth", "SceneDepth"}) {
    if (channel.find(unreal) != channel.npos) {
      return {find_depth_encoding("centimetres"), "Unreal's " + std::string{unreal} + " has them"};
    }
  }
  if (seen.largest >= 9.9e9) {
    return {find_depth_encoding("blender-z"), "1e10 is what Blender writes where there is nothing"};
  }
  if (seen.negatives > 0) {
    return {nullptr,
            "there are numbers below 0, which are no distances: perhaps midas, or metres, where "
            "they are missing"};
  }
  if (seen.infinities + seen.nans == seen.count) {
    return {nullptr, "no number is finite: metres, if all of it is infinitely far"};
  }
  if (seen.largest <= 1.0) {
    return {nullptr,
            "all numbers are within 0 and 1: what a network gives (midas), a depth buffer "
            "(device), a grey picture (white-far, white-near), or metres"};
  }
  if (seen.largest > 1000.0 && seen.least > 100.0) {
    return {nullptr, "numbers from " + std::to_string(static_cast<long long>(seen.least)) +
                         " on are far for metres: perhaps millimetres, or midas"};
  }
  return {find_depth_encoding("metres"),
          "numbers of " + std::string{name_of(type)} + " beyond 1 are metres in most programs"};
}

}  // namespace softfocus
