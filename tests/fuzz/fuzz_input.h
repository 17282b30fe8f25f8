#pragma once
// The fuzz targets, and what they share: the input as a file or as numbers, and claims that must
// hold.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include <unistd.h>

/// libFuzzer's own mutator.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace softfocus {

struct PictureFileReader;

/// Writes the bytes to this process's own file of that extension, which its end removes, and
/// returns its path.
inline std::filesystem::path fuzz_file(const std::uint8_t* data, std::size_t size,
                                       const char* extension) {
  static const struct Place {
    std::filesystem::path file;
    ~Place() { std::filesystem::remove(file); }
  } place{std::filesystem::temp_directory_path() /
          ("softfocus-fuzz-" + std::to_string(::getpid()) + extension)};
  std::ofstream stream(place.file, std::ios::binary | std::ios::trunc);
  stream.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return place.file;
}

/// The input, number by number; zeros when it has ended.
struct FuzzNumbers {
  const std::uint8_t* data;
  std::size_t size;

  template <class Number>
  Number next() {
    Number number{};
    const std::size_t some = std::min(size, sizeof number);
    if (some > 0) std::memcpy(&number, data, some);
    data += some;
    size -= some;
    return number;
  }
};

/// The last inputs that the target's reader took.
inline std::vector<std::string> accepted_inputs;

/// Counts what a reader takes, and prints its share when the process ends. Returns what the target
/// returns.
inline int counted(bool is_accepted, const std::uint8_t* data, std::size_t size) {
  static struct Count {
    std::size_t accepted = 0, all = 0;
    ~Count() { std::fprintf(stderr, "accepted: %zu of %zu inputs\n", accepted, all); }
  } count;
  constexpr std::size_t kMostKept = 256;
  ++count.all;
  if (!is_accepted) return 0;
  const std::size_t place = count.accepted++ % kMostKept;
  if (place == accepted_inputs.size()) accepted_inputs.emplace_back();
  accepted_inputs[place].assign(reinterpret_cast<const char*>(data), size);
  return 0;
}

/// A mutator for files whose head says how long they are, and which a change of length would make
/// nothing of: most mutants are of an input that was taken, with another byte in one place.
/// libFuzzer does this five times on end.
inline std::size_t mutate_in_place(std::uint8_t* data, std::size_t size, std::size_t most,
                                   unsigned seed) {
  std::minstd_rand random{seed};
  if (!accepted_inputs.empty() && random() % 2 == 0) {
    const std::string& base = accepted_inputs[random() % accepted_inputs.size()];
    size = std::min(base.size(), most);
    std::memcpy(data, base.data(), size);
  }
  if (size == 0 || random() % 32 == 0) return LLVMFuzzerMutate(data, size, most);
  LLVMFuzzerMutate(data + random() % size, 1, 1);
  return size;
}

/// Random words of SPIR-V, damaged where they mean something.
std::size_t mutate_spirv(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

/// What a target does with an input; the head of its file says what it claims. Returns as
/// LLVMFuzzerTestOneInput() does: -1 keeps the input out of the corpus.
using FuzzOneInput = int(const std::uint8_t* data, std::size_t size);
FuzzOneInput fuzz_fixed, fuzz_glsl, fuzz_gltf, fuzz_mtl, fuzz_notes, fuzz_obj, fuzz_options,
    fuzz_ply, fuzz_profile, fuzz_refocus, fuzz_relief, fuzz_scene, fuzz_sequence, fuzz_shader,
    fuzz_stl, fuzz_sums, fuzz_texture;
int fuzz_picture(const PictureFileReader& reader, const std::uint8_t* data, std::size_t size);

/// Ends the program, which is a finding, unless it holds.
inline void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace softfocus
