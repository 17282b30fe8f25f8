// Any lens, settings and picture for the fixed-point filter: an error code, or the bits of
// the plain evaluation in wide integers, row by row and on every vector unit.

#include "dof/fixed_pictures/fixed_two_pass.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/support/fixed_oracle.h"

namespace {

using namespace softfocus;
using namespace softfocus::fixed;

void check_picture(FuzzNumbers& input, const Settings& settings,
                   const std::vector<Weights>& table) {
  const int width = settings.width, height = settings.height;
  Image picture = make_image(Format::rgba8, width, height);
  Image rows = picture, lanes = picture;
  std::vector<std::uint8_t> codes;
  std::vector<Weights> weights;
  Picture3<std::int64_t> channels{width, height, {}};
  for (int y = 0; y < height; ++y) {
    const auto bytes = row<std::uint8_t>(picture, y);
    for (std::size_t x = 0; x < bytes.size(); x += 4) {
      for (std::size_t c = 0; c < 4; ++c) bytes[x + c] = input.next<std::uint8_t>();
      channels.pixels.push_back({bytes[x], bytes[x + 1], bytes[x + 2]});
      codes.push_back(input.next<std::uint8_t>());
      weights.push_back(table[codes.back()]);
    }
  }
  std::vector<std::uint32_t> memory(memory_bytes(settings) / 4);
  Stream stream;
  demand(softfocus_fixed_begin(&stream, &settings, table.data(), memory.data(),
                               memory.size() * 4) == 0);
  int out = 0;
  for (int y = 0; y < height; ++y) {
    out += softfocus_fixed_put_row(&stream, static_cast<std::uint32_t>(y),
                                   row<std::uint8_t>(picture, y).data(), codes.data() + y * width,
                                   row<std::uint8_t>(rows, std::min(out, height - 1)).data());
  }
  while (out < height) {
    demand(softfocus_fixed_finish_row(&stream, row<std::uint8_t>(rows, out).data()) == 1);
    ++out;
  }
  const Picture3<std::int64_t> expected = wide_filter8(channels, weights);
  for (const Isa isa : available_isas()) {
    ThreadPool pool(1, isa);
    fixed_two_pass(picture, codes, fixed_table(table), lanes, pool);
    for (int y = 0; y < height; ++y) {
      const auto a = row<std::uint8_t>(rows, y), b = row<std::uint8_t>(lanes, y);
      demand(std::equal(a.begin(), a.end(), b.begin()));
      for (std::size_t i = 0; i < a.size(); ++i) {
        const int x = static_cast<int>(i / 4);
        demand(i % 4 == 3 ? a[i] == row<std::uint8_t>(picture, y)[i]
                          : a[i] == expected.at(x, y)[i % 4]);
      }
    }
  }
}

/// Checks a frame of RGBA16F in the same way.
void check_halves(FuzzNumbers& input, const Settings& settings, const std::vector<Weights>& table) {
  Image picture = make_image(Format::rgba16f, settings.width, settings.height);
  std::vector<std::uint8_t> codes;
  std::vector<Weights> weights;
  Picture3<std::int64_t> channels{settings.width, settings.height, {}};
  for (int y = 0; y < picture.height; ++y) {
    const auto halves = row<std::uint16_t>(picture, y);
    for (std::size_t x = 0; x < halves.size(); x += 4) {
      for (std::size_t c = 0; c < 4; ++c) halves[x + c] = input.next<std::uint16_t>();
      channels.pixels.push_back(
          {half_units(halves[x]), half_units(halves[x + 1]), half_units(halves[x + 2])});
      codes.push_back(input.next<std::uint8_t>());
      weights.push_back(table[codes.back()]);
    }
  }
  const Picture3<std::int64_t> expected = wide_filter16(channels, weights);
  for (const Isa isa : available_isas()) {  // scalar ones are the rows
    ThreadPool pool(1, isa);
    Image result = picture;
    fixed_two_pass(picture, codes, fixed_table(table), result, pool);
    for (int y = 0; y < picture.height; ++y) {
      const auto halves = row<std::uint16_t>(result, y);
      for (std::size_t i = 0; i < halves.size(); ++i) {
        const int x = static_cast<int>(i / 4);
        demand(halves[i] ==
               (i % 4 == 3 ? row<std::uint16_t>(picture, y)[i] : expected.at(x, y)[i % 4]));
      }
    }
  }
}

}  // namespace

int softfocus::fuzz_fixed(const std::uint8_t* data, std::size_t size) {
  FuzzNumbers input{data, size};
  const Camera camera{input.next<std::uint32_t>(), input.next<std::uint32_t>(),
                      input.next<std::uint32_t>(), input.next<std::uint32_t>(),
                      input.next<std::uint32_t>()};
  Lens lens{input.next<std::uint32_t>(), input.next<std::uint32_t>(), input.next<std::uint32_t>(),
            input.next<std::uint32_t>()};
  softfocus_fixed_radius_at_infinity(&camera, &lens.radius_at_infinity);
  lens.largest_radius %= (SOFTFOCUS_FIXED_LARGEST_REACH + 1u) * SOFTFOCUS_FIXED_ONE_PIXEL + 2;
  std::vector<Weights> table(256);
  const auto near_um = input.next<std::uint32_t>(), far_um = input.next<std::uint32_t>();
  if (softfocus_fixed_table8(&lens, near_um, far_um, table.data()) != 0) return 0;
  // Small, for the plain evaluation has 127 taps a pixel and pass.
  const auto width = static_cast<std::uint16_t>(1 + input.next<std::uint8_t>() % 40);
  const auto height = static_cast<std::uint16_t>(1 + input.next<std::uint8_t>() % 24);
  const std::uint8_t reach = reach_of(lens.largest_radius);
  if (input.next<std::uint8_t>() % 2 == 0) {
    check_picture(input, {width, height, reach, SOFTFOCUS_FIXED_RGBA8, SOFTFOCUS_FIXED_DEPTH8},
                  table);
  } else {
    check_halves(input, {width, height, reach, SOFTFOCUS_FIXED_RGBA16F, SOFTFOCUS_FIXED_DEPTH8},
                 table);
  }
  return 0;
}
