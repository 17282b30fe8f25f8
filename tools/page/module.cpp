// The page as a WebAssembly module: what JavaScript calls, all from one worker.

#include <cstddef>
#include <cstdint>
#include <string>

#include "tools/page/page.h"

namespace {

struct Module {
  softfocus::Page page;
  std::string reply;
};

Module& module() {
  static Module the_module;
  return the_module;
}

}  // namespace

extern "C" {

/// Answers a request, JSON in UTF-8 that ends with a 0. Returns the length of the reply in bytes.
int softfocus_request(const char* json) {
  module().reply = softfocus::answer(module().page, json);
  return static_cast<int>(module().reply.size());
}

/// The last reply, JSON that ends with a 0.
const char* softfocus_reply() { return module().reply.c_str(); }

/// The picture on the screen: RGBA of 8 bits, rows from the top, of the size that the last reply
/// with a `width` told.
const std::uint8_t* softfocus_pixels() { return module().page.pixels.rgba.data(); }

/// The file that the last `save` made, of the bytes that its reply told.
const std::byte* softfocus_saved() { return module().page.saved.data(); }

/// 1 here, written from another thread, ends the request that runs.
std::int32_t* softfocus_cancel() {
  static_assert(sizeof(std::atomic<std::int32_t>) == sizeof(std::int32_t));
  return reinterpret_cast<std::int32_t*>(&module().page.cancel);
}
}
