// Depth of field on a picture in memory: floats are packed, filtered and made bytes again.
// Prints a hash of the filtered halves, which is the same on every machine.
#include <softfocus/dof.h>

#include <cstdio>
#include <vector>

using namespace softfocus;

int main() {
  constexpr int kWidth = 250, kHeight = 130;
  // The program's own picture: tiles that recede from 1 to 9 metres, linear light.
  std::vector<float> rgb, depth_m;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const float light = ((x ^ y) & 16) != 0 ? 4.0f : 0.25f;
      rgb.insert(rgb.end(), {light, light * 0.5f, static_cast<float>(x) / 256.0f});
      depth_m.push_back(1.0f + static_cast<float>(x) / 32.0f);
    }
  }

  ThreadPool pool(hardware_threads());
  std::vector<std::uint16_t> scene(4 * kWidth * kHeight), result(scene.size());
  const ImageView scene_view = view_of(Format::rgba16f, scene.data(), kWidth, kHeight);
  const ImageView result_view = view_of(Format::rgba16f, result.data(), kWidth, kHeight);
  pack(interleaved(ChannelType::single, rgb.data(), 3, 12 * kWidth),
       {depth_m.data(), 4, 4 * kWidth}, HalfRounding::nearest_even, scene_view, pool);

  DofInput input{scene_view, {}, {}};  // 85 mm, f/2, focused at 3 m; 30 degrees high
  input.settings.coc = pixel_coc({85.0, 2.0, 3.0}, 30.0, kHeight, 1.0);
  if (const char* error = input_error(input, result_view)) return std::puts(error), 1;
  apply(*find_method("two-pass"), input, result_view, pool);

  std::vector<unsigned char> bytes(3 * kWidth * kHeight);  // to show
  unpack(result_view, interleaved(ChannelType::srgb8, bytes.data(), 3, 3 * kWidth), pool);

  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const std::uint16_t half : result) hash = (hash ^ half) * 1099511628211u;
  for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  std::printf("%016llx\n", static_cast<unsigned long long>(hash));
}
