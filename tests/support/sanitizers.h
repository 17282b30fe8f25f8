#pragma once
// What a test does less of where sanitizers run it: ten to thirty times as slow, they look at how
// memory is used, which a few inputs of a kind show as well as many.

#include <algorithm>

namespace softfocus {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHasSanitizers = true;
#elif defined(__has_feature)
inline constexpr bool kHasSanitizers =
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kHasSanitizers = false;
#endif

/// `count` inputs of a kind; with sanitizers an eighth of them, at least one.
template <class Number>
constexpr Number fewer(Number count) {
  return kHasSanitizers ? std::max(Number{1}, count / Number{8}) : count;
}

}  // namespace softfocus
