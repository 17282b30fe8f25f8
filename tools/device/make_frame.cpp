// make_frame PICTURE.npy FRAME RADIUS_PX RADIUS_AT_INFINITY_Q16 FOCUS_UM NEAR_UM FAR_UM
//
// The picture that `softfocus render --show pinhole` writes (RGBA as halves, depth in
// metres in alpha) as the file that a device reads: frame_settings.h.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tools/device/frame_settings.h"
#include "tools/device/half_codes.h"

namespace {

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "make_frame: %s\n", why.c_str());
  std::exit(1);
}

std::string whole_file(const char* name) {
  std::ifstream file(name, std::ios::binary);
  if (!file) give_up("cannot read " + std::string{name});
  return {std::istreambuf_iterator<char>(file), {}};
}

std::uint16_t word_at(const std::string& bytes, std::size_t offset) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  return static_cast<std::uint16_t>(byte(offset) | byte(offset + 1) << 8);
}

void put_bytes(std::ofstream& file, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) file.put(static_cast<char>(value >> 8 * i));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 8) give_up("wants a picture, a frame and five numbers");
  std::uint32_t number[5];
  for (int i = 0; i < 5; ++i) {
    number[i] = static_cast<std::uint32_t>(std::strtoul(arguments[3 + i], nullptr, 10));
  }
  const std::uint32_t near_um = number[3];
  const std::uint32_t far_um = number[4];

  // NPY 1.0: eight bytes, the header's length, the header, rows from the top.
  const std::string npy = whole_file(arguments[1]);
  if (npy.size() < 10) give_up("not an NPY file");
  const std::size_t begin = 10u + word_at(npy, 8);
  const std::string header = npy.substr(10, begin - 10);
  const std::size_t shape = header.find("'shape': (");
  unsigned height = 0;
  unsigned width = 0;
  if (header.find("'<f2'") == std::string::npos || shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "'shape': (%u, %u, 4)", &height, &width) != 2 ||
      npy.size() - begin != std::size_t{8} * width * height) {
    give_up("not a picture of four halves a pixel");
  }

  std::ofstream frame(arguments[2], std::ios::binary);
  for (const std::uint32_t word :
       {width, height, number[0], number[1], number[2], near_um, far_um}) {
    put_bytes(frame, word, 4);
  }
  for (unsigned y = 0; y < height; ++y) {
    std::vector<std::uint8_t> codes;
    for (unsigned x = 0; x < width; ++x) {
      std::uint16_t pixel[4];
      for (std::size_t i = 0; i < 4; ++i) {
        pixel[i] = word_at(npy, begin + 8 * (std::size_t{y} * width + x) + 2 * i);
      }
      put_bytes(frame, softfocus::device::rgb565_of_halves(pixel), 2);
      codes.push_back(softfocus::device::depth_code_of_half(pixel[3], near_um, far_um));
    }
    for (const std::uint8_t code : codes) put_bytes(frame, code, 1);
  }
  if (!frame.flush()) give_up("cannot write " + std::string{arguments[2]});
}
