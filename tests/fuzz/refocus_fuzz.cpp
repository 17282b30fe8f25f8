// Any numbers as colour and depth, and some of the options: a refocused picture, or the error that
// is meant for the user.

#include <array>
#include <bit>
#include <string>
#include <vector>

#include "raster/threads/parallel.h"
#include "tests/fuzz/fuzz_input.h"
#include "tools/cli/errors.h"
#include "tools/cli/parser.h"
#include "tools/refocus/options.h"
#include "tools/refocus/picture_with_depth.h"
#include "tools/refocus/refocused.h"

namespace {

using namespace softfocus;

constexpr std::array kOptions{"--depth-encoding=metres",
                              "--depth-encoding=millimetres",
                              "--depth-encoding=tum",
                              "--depth-encoding=inverse",
                              "--depth-encoding=disparity",
                              "--depth-encoding=middlebury",
                              "--depth-encoding=cityscapes",
                              "--depth-encoding=device",
                              "--depth-encoding=device-reversed",
                              "--depth-encoding=device-infinite",
                              "--depth-encoding=device-infinite-reversed",
                              "--depth-encoding=white-near",
                              "--depth-encoding=gdepth-inverse",
                              "--depth-encoding=gdepth-linear",
                              "--depth-encoding=midas",
                              "--depth-encoding=blender-z",
                              "--depth-encoding=blender-mist",
                              "--near=0.5",
                              "--near=1e-9",
                              "--far=20",
                              "--far=1e9",
                              "--scale=-1",
                              "--scale=1e9",
                              "--offset=0.25",
                              "--baseline=0.1",
                              "--focal-px=600",
                              "--depth-along=ray",
                              "--depth-along=axis",
                              "--missing=0",
                              "--missing=1e30",
                              "--holes=refuse",
                              "--mend-edges",
                              "--mend-bands",
                              "--upsample=nearest",
                              "--focus=2.5",
                              "--focus=1e-6",
                              "--focus=1e9",
                              "--focus-nearest",
                              "--focus-at=1,1",
                              "--focus-range=1..3",
                              "--f-number=1.4",
                              "--f-number=1e-6",
                              "--f-number=22",
                              "--focal-length=50",
                              "--focal-length=1e9",
                              "--sensor=full-frame",
                              "--fov=90",
                              "--fov=179",
                              "--blur-at-infinity=9",
                              "--coc-scale=1000",
                              "--highlights=4,0.9",
                              "--border=mirror",
                              "--border=black",
                              "--border=clamp",
                              "--aperture-blades=5",
                              "--anamorphic=2",
                              "--arithmetic=fixed-8",
                              "--arithmetic=fixed-16",
                              "--show=coc",
                              "--show=depth",
                              "--leak=1"};
constexpr std::array kMethods{"two-pass", "one-pass",  "disc-layers", "scatter-aperture",
                              "mipmap",   "diffusion", "auto"};
/// Mirrored borders are as wide, and one-pass reads as many pixels squared for each.
constexpr int kMostRadiusPx = 24;
constexpr std::array kOutputs{"--output=a.exr", "--output=a.png", "--output=a.npy",
                              "--output=a.hdr", "--output=a.pfm", "--output=a.png"};

/// Two bytes are a pixel's number: a half, so that NaN, infinity and 0 come often.
PictureFile npy_file(FuzzNumbers& input, int width, int height) {
  Image image = make_image(Format::rgba16f, width, height);
  for (int y = 0; y < height; ++y) {
    for (std::uint16_t& half : row<std::uint16_t>(image, y)) half = input.next<std::uint16_t>();
  }
  return open_picture_file(encode_npy(image), "colour");
}

PictureFile pfm_file(FuzzNumbers& input, int width, int height) {
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (float& value : values) {
    const auto bits = input.next<std::uint16_t>();
    // The upper bits of any float, or a sensible depth.
    value = bits % 2 == 0 ? std::bit_cast<float>(std::uint32_t{bits} << 16)
                          : 0.5f + static_cast<float>(bits) / 4096.0f;
  }
  return open_picture_file(encode_grey_pfm(values, width, height), "depth");
}

void refocus_all(FuzzNumbers& input, const RefocusOptions& options) {
  const int width = 1 + input.next<std::uint8_t>() % 13;
  const int height = 1 + input.next<std::uint8_t>() % 13;
  const int part = 1 + input.next<std::uint8_t>() % 2;
  PictureSources sources{npy_file(input, width, height)};
  sources.colour = colour_layers(sources.colour_file)[0];
  sources.depth_file = pfm_file(input, std::max(1, width / part), std::max(1, height / part));
  ThreadPool pool{1, Isa::baseline};
  PictureOnItsWay source{read_colour(sources.colour_file, sources.colour, false).image};
  source.opacity = take_opacity(sources, source.picture);
  const ReadDepth depth = read_depth(sources, source.picture, options.reading, options.photo, pool);
  for (const float metres : depth.map.metres) demand(metres > 0.0f);
  UsedRefocus used;
  used.lens =
      settle_lens(options.photo, sources.notes, options.reading.numbers.focal_px, depth.map);
  const PictureOnItsWay result = refocused(std::move(source), depth.map, options, used, pool);
  demand(result.picture.width == width && result.picture.height == height);
  const Bytes bytes = refocused_file(options, sources, depth.map, used, result, {});
  open_picture_file(bytes, "result");
}

}  // namespace

int softfocus::fuzz_refocus(const std::uint8_t* data, std::size_t size) {
  FuzzNumbers input{data, size};
  std::vector<std::string> arguments{"refocus", "colour.npy", "depth.pfm"};
  const auto add_of = [&](const auto& table) {
    arguments.emplace_back(table[input.next<std::uint8_t>() % table.size()]);
  };
  add_of(kOutputs);
  arguments.push_back("--method");
  add_of(kMethods);
  arguments.push_back("--max-coc=" +
                      std::to_string(input.next<std::uint8_t>() % (kMostRadiusPx + 1)));
  for (int count = input.next<std::uint8_t>() % 7; count > 0; --count) add_of(kOptions);
  const auto program = make_program("softfocus", "0", "");
  RefocusOptions options;
  CLI::App* const parser = add_command(*program, "refocus", "");
  add_refocus_options(*parser, options);
  try {
    parse(*program, arguments);
    complete(options, *parser);
    refocus_all(input, options);
  } catch (const UsageError&) {
  } catch (const FileError&) {
  }
  return 0;
}
