// make_frame PICTURE.npy FRAME FORMAT RADIUS_PX RADIUS_AT_INFINITY_Q16 FOCUS_UM NEAR_UM FAR_UM
//
// FORMAT is rgb565, rgba8 or rgba16f.
//
// The picture that `softfocus render --show pinhole` writes (RGBA as halves, depth in
// metres in alpha) as the file that a board reads: frame.h.

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "tools/boards/frame.h"

using namespace softfocus::boards;

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

void put_bytes(std::string& to, std::uint32_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to += static_cast<char>(value >> 8 * i);
}

FrameFormat format_named(const std::string& name) {
  if (name == "rgb565") return FrameFormat::rgb565;
  if (name == "rgba8") return FrameFormat::rgba8;
  if (name == "rgba16f") return FrameFormat::rgba16f;
  give_up("there is no format " + name);
}

struct Row {
  std::string colours;
  std::string depths;
};

void put_pixel(Row& row, const FrameSettings& settings, const std::uint16_t* rgba) {
  const auto depth_code = [&](int largest) {
    return depth_code_of_half(rgba[3], settings.near_um, settings.far_um, largest);
  };
  switch (settings.format) {
    case FrameFormat::rgb565:
      put_bytes(row.colours, rgb565_of_halves(rgba), 2);
      put_bytes(row.depths, depth_code(255), 1);
      break;
    case FrameFormat::rgba8:
      for (int i = 0; i < 3; ++i) put_bytes(row.colours, level_of_half(rgba[i], 255), 1);
      // Alpha goes through the filter as it is. The low byte, because it changes all the time.
      put_bytes(row.colours, depth_code(65535) & 255u, 1);
      put_bytes(row.depths, depth_code(65535), 2);
      break;
    case FrameFormat::rgba16f:
      for (int i = 0; i < 4; ++i) put_bytes(row.colours, rgba[i], 2);
      break;
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 9) give_up("wants a picture, a frame, a format and five numbers");
  FrameSettings settings{};
  settings.format = format_named(arguments[3]);
  std::uint32_t* const numbers[] = {&settings.max_radius_px, &settings.radius_at_infinity_q16,
                                    &settings.focus_um, &settings.near_um, &settings.far_um};
  for (int i = 0; i < 5; ++i) {
    *numbers[i] = static_cast<std::uint32_t>(std::strtoul(arguments[4 + i], nullptr, 10));
  }

  // NPY 1.0: eight bytes, the header's length, the header, rows from the top.
  const std::string npy = whole_file(arguments[1]);
  if (npy.size() < 10) give_up("not an NPY file");
  const std::size_t begin = 10u + word_at(npy, 8);
  const std::string header = npy.substr(10, begin - 10);
  const std::size_t shape = header.find("'shape': (");
  if (header.find("'<f2'") == std::string::npos || shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "'shape': (%u, %u, 4)", &settings.height,
                  &settings.width) != 2 ||
      npy.size() - begin != std::size_t{8} * settings.width * settings.height) {
    give_up("not a picture of four halves a pixel");
  }

  std::ofstream frame(arguments[2], std::ios::binary);
  std::string words;
  for (const std::uint32_t word :
       {static_cast<std::uint32_t>(settings.format), settings.width, settings.height,
        settings.max_radius_px, settings.radius_at_infinity_q16, settings.focus_um,
        settings.near_um, settings.far_um}) {
    put_bytes(words, word, 4);
  }
  frame << words;
  std::size_t offset = begin;
  for (unsigned y = 0; y < settings.height; ++y) {
    Row row;
    for (unsigned x = 0; x < settings.width; ++x) {
      std::uint16_t rgba[4];
      for (std::uint16_t& half : rgba) {
        half = word_at(npy, offset);
        offset += 2;
      }
      put_pixel(row, settings, rgba);
    }
    frame << row.colours << row.depths;
  }
  if (!frame.flush()) give_up("cannot write " + std::string{arguments[2]});
}
