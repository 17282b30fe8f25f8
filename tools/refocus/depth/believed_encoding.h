#pragma once
// The encoding that a depth map's numbers suggest if nobody says.

#include <span>
#include <string>
#include <vector>

#include "tools/pictures/picture_file.h"
#include "tools/refocus/depth/depth_encodings.h"

namespace softfocus {

/// Findings in a plane's numbers.
struct NumbersSeen {
  std::size_t count = 0;
  std::size_t nans = 0;
  std::size_t infinities = 0;
  std::size_t zeros = 0;
  std::size_t negatives = 0;
  std::size_t different = 0;  ///< distinct whole numbers, of types that are; else 0
  double least = 0.0;         ///< of finite numbers; 0 if there is none
  double largest = 0.0;
};

/// Looks at numbers that come in pieces.
class NumberCounter {
 public:
  explicit NumberCounter(NumberType type);
  void add(std::span<const float> values);
  NumbersSeen seen() const;

 private:
  NumbersSeen seen_{};
  double least_, largest_;
  std::vector<bool> there_;  // of whole numbers up to 16 bits
};

/// Whether there are numbers, but all are NaN.
bool knows_nothing(const NumbersSeen& seen);

NumbersSeen numbers_seen(const PlaneValues& values, NumberType type);

struct BelievedEncoding {
  const DepthEncoding* encoding = nullptr;  ///< or none: it cannot be told
  std::string why;                          ///< one sentence without its full stop
};

/// `is_ours`: the file has softfocus's notes, whose depths are metres.
BelievedEncoding believed_encoding(const NumbersSeen& seen, NumberType type, bool is_ours);

}  // namespace softfocus
