#pragma once
// What C programs hand over, checked: structs of any version, and planes of numbers in their
// memory.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include "dof/c/softfocus.h"
#include "dof/dof.h"

namespace softfocus {

/// The argument's name and what would be right, as a sentence.
struct BadArgument : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws BadArgument.
[[noreturn]] void refuse(const std::string& argument, const std::string& reason);

/// The bytes of a struct that begins with its size. Of these we know `our_bytes` or fewer.
/// `first_bytes`: of its first version. Throws BadArgument for a null pointer, less than the first
/// version, or a field that is set and unknown here.
std::size_t struct_bytes(const std::string& argument, const void* given, std::size_t first_bytes,
                         std::size_t our_bytes);

/// A struct of a caller of any version; `ours` has the values of fields that it does not have.
template <class Struct>
Struct read_struct(const std::string& argument, const Struct* given, Struct ours = {}) {
  const std::size_t bytes = struct_bytes(argument, given, sizeof(Struct), sizeof(Struct));
  std::memcpy(&ours, given, bytes < sizeof(Struct) ? bytes : sizeof(Struct));
  return ours;
}

/// Numbers in a caller's memory, one a pixel.
struct PixelPlane {
  std::string name;  ///< "picture.red"
  const void* first = nullptr;
  std::ptrdiff_t pixel_bytes = 0;
  std::ptrdiff_t row_bytes = 0;
  std::ptrdiff_t value_bytes = 0;
};

struct MemoryRange {
  std::uintptr_t begin = 0, end = 0;
};
inline bool overlap(const MemoryRange& a, const MemoryRange& b) {
  return a.begin < b.end && b.begin < a.end;
}

/// The memory of a plane of `width` x `height`. Throws BadArgument for a null pointer and for
/// strides that lead past the ends of the address space.
MemoryRange range_of(const PixelPlane& plane, int width, int height);

/// Throws BadArgument if two values of a plane that is written share memory. Needs range_of().
void check_apart(const PixelPlane& plane, int width, int height);

// A C program's settings: the lens, the method and the profile that they name.

/// How to blur a picture of some size.
struct ReadSettings {
  const Method* method = nullptr;  ///< null: auto
  DofSettings dof;                 ///< its max_coc_px is set if max_radius_px has a value
  std::optional<float> max_radius_px;
  double max_error = 0.0;  ///< of auto
  Profile profile;
};

/// The profile of that name. Throws BadArgument.
Profile profile_of(const std::string& argument, const char* name);

/// What softfocus_init_settings() gives.
softfocus_settings default_settings();

/// Throws BadArgument.
ReadSettings read_settings(const softfocus_settings* settings, int width_px, int height_px);

}  // namespace softfocus
