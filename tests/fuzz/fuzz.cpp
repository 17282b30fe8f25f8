// The fuzz targets as one program, whose first argument names one; the others are libFuzzer's.
// Linked one by one they would take minutes.

#include <algorithm>
#include <iterator>
#include <string_view>

#include "tests/fuzz/fuzz_input.h"
#include "tools/pictures/picture_file.h"

namespace {

using namespace softfocus;

/// libFuzzer's processes that it starts of itself have no first argument of ours.
constexpr const char* kVariable = "SOFTFOCUS_FUZZ_TARGET";

template <const PictureFileReader& reader>
int fuzz_pictures(const std::uint8_t* data, std::size_t size) {
  return fuzz_picture(reader, data, size);
}

std::size_t mutate_freely(std::uint8_t* data, std::size_t size, std::size_t most, unsigned) {
  return LLVMFuzzerMutate(data, size, most);
}

struct FuzzTarget {
  std::string_view name;
  FuzzOneInput* run;
  std::size_t (*mutate)(std::uint8_t* data, std::size_t size, std::size_t most,
                        unsigned seed) = mutate_freely;
};

// CMakeLists.txt and tools/test read the names here.
constexpr FuzzTarget kTargets[]{
    {"fixed", fuzz_fixed},
    {"glsl", fuzz_glsl},
    {"gltf", fuzz_gltf},
    {"mtl", fuzz_mtl},
    {"notes", fuzz_notes},
    {"obj", fuzz_obj},
    {"options", fuzz_options},
    {"ply", fuzz_ply},
    {"profile", fuzz_profile},
    {"refocus", fuzz_refocus},
    {"relief", fuzz_relief, mutate_in_place},
    {"scene", fuzz_scene},
    {"sequence", fuzz_sequence},
    {"shader", fuzz_shader, mutate_spirv},
    {"sums", fuzz_sums, mutate_in_place},
    {"stl", fuzz_stl},
    {"texture", fuzz_texture},
    {"hdr", fuzz_pictures<kHdrReader>, mutate_in_place},
    {"jpeg", fuzz_pictures<kJpegReader>, mutate_in_place},
    {"npy", fuzz_pictures<kNpyReader>, mutate_in_place},
    {"pfm", fuzz_pictures<kPfmReader>, mutate_in_place},
    {"png", fuzz_pictures<kPngReader>, mutate_in_place},
    {"exr", fuzz_pictures<kExrReader>, mutate_in_place},
    {"tiff", fuzz_pictures<kTiffReader>, mutate_in_place},
};

const FuzzTarget* chosen = nullptr;

const FuzzTarget* find_target(std::string_view name) {
  const auto* found = std::find_if(std::begin(kTargets), std::end(kTargets),
                                   [&](const FuzzTarget& target) { return target.name == name; });
  return found == std::end(kTargets) ? nullptr : found;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  if (*count > 1) chosen = find_target((*arguments)[1]);
  if (chosen != nullptr) {
    setenv(kVariable, (*arguments)[1], 1);
    std::copy(*arguments + 2, *arguments + *count, *arguments + 1);
    --*count;
    return 0;
  }
  const char* const inherited = std::getenv(kVariable);
  chosen = inherited == nullptr ? nullptr : find_target(inherited);
  if (chosen != nullptr) return 0;
  std::fputs("usage: softfocus_fuzz TARGET [OPTION OF LIBFUZZER...] [FOLDER...]\ntargets:", stderr);
  for (const FuzzTarget& target : kTargets) {
    std::fprintf(stderr, " %s", std::string{target.name}.c_str());
  }
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return chosen->mutate(data, size, most, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return chosen->run(data, size);
}
