#pragma once
// A C program's context: threads, the last message, and how a call's work becomes a status.

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>

#include "dof/c/settings.h"
#include "dof/c/softfocus.h"
#include "raster/shaders/shader_error.h"
#include "raster/threads/float_environment.h"
#include "raster/threads/parallel.h"

struct softfocus_context {
  explicit softfocus_context(int threads) : pool(threads) {}
  std::mutex one_call;
  softfocus::ThreadPool pool;
  std::array<char, 512> message{};  // no memory is needed to say that there is none
};

namespace softfocus {

inline void put_message(softfocus_context& context, const char* text) {
  const std::size_t length = std::min(std::strlen(text), context.message.size() - 1);
  std::copy_n(text, length, context.message.data());
  context.message[length] = '\0';
}

/// Runs a call's work; what it throws becomes a status and a message.
template <class Call>
int guarded(softfocus_context* context, const Call& call) {
  if (context == nullptr) return SOFTFOCUS_BAD_ARGUMENT;
  try {
    const std::lock_guard lock{context->one_call};
    try {
      const DefaultFloatEnvironment environment;
      put_message(*context, "");
      call(context->pool);
      return SOFTFOCUS_OK;
    } catch (const BadArgument& error) {
      put_message(*context, error.what());
      return SOFTFOCUS_BAD_ARGUMENT;
    } catch (const ShaderError& error) {
      put_message(*context, error.what());
      return SOFTFOCUS_BAD_SHADER;
    } catch (const std::bad_alloc&) {
      put_message(*context, "there is not enough memory");
      return SOFTFOCUS_NO_MEMORY;
    } catch (const std::exception& error) {
      put_message(*context, error.what());
      return SOFTFOCUS_FAILED;
    }
  } catch (...) {
    return SOFTFOCUS_FAILED;
  }
}

}  // namespace softfocus
