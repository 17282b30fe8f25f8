#include "tools/refocus/depth/believed_encoding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfocus {

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

BelievedEncoding believed_encoding(const NumbersSeen& seen, NumberType type, bool is_ours) {
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
                "16 bits that use the whole range may be a depth buffer, a grey picture, tum or "
                "cityscapes"};
      }
      return {find_depth_encoding("millimetres"),
              "16 bits that stay below 60000: millimetres, as most depth cameras write"};
    default: break;
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
            "all numbers are within 0 and 1: a depth buffer (device), a grey picture, or metres"};
  }
  if (seen.largest > 1000.0 && seen.least > 100.0) {
    return {nullptr, "numbers from " + std::to_string(static_cast<long long>(seen.least)) +
                         " on are far for metres: perhaps millimetres, or midas"};
  }
  return {find_depth_encoding("metres"),
          "numbers of " + std::string{name_of(type)} + " beyond 1 are metres in most programs"};
}

}  // namespace softfocus
