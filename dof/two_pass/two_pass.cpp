#include "dof/two_pass/two_pass.h"

#include <algorithm>
#include <vector>

#include "dof/two_pass/two_pass_strips.h"
#include "dof/weights.h"
#include "raster/images/texel.h"

namespace softfocus {
namespace {

// Columns that one thread filters together: as many as a cache line of 64 bytes holds.
constexpr int kColumns = 8;

// A row or a column, its ends repeated `taps` times, so that no tap needs a test.
struct Line {
  int taps;
  std::vector<FilterTexel> texels;
  std::vector<float> depths;

  Line(int length, int tap_limit)
      : taps(tap_limit),
        texels(static_cast<std::size_t>(length + 2 * tap_limit)),
        depths(static_cast<std::size_t>(length)) {}
};

int length(const Line& line) { return static_cast<int>(line.depths.size()); }

template <class Fetch>
void fill_line(Line& line, const DofSettings& settings, const Fetch& fetch) {
  const auto taps = static_cast<std::size_t>(line.taps);
  for (int i = 0; i < length(line); ++i) {
    const glm::vec4 texel = fetch(i);
    const auto at = static_cast<std::size_t>(i);
    line.texels[at + taps] = filter_texel(settings, glm::vec3{texel.x, texel.y, texel.z}, texel.w);
    line.depths[at] = texel.w;
  }
  const FilterTexel first = line.texels[taps];
  const FilterTexel last = line.texels[line.depths.size() - 1 + taps];
  std::fill_n(line.texels.begin(), taps, first);
  std::fill_n(line.texels.end() - line.taps, taps, last);
}

template <class Store>
void filter_line(const Line& line, float leak, const Store& store) {
  for (int i = 0; i < length(line); ++i) {
    const FilterTexel* centre = &line.texels[static_cast<std::size_t>(i + line.taps)];
    const float receiver_leakage = leakage(centre->radius_px, leak);
    Gather gather = begin_gather(*centre);
    for (int d = 1; d <= line.taps; ++d) {
      const auto distance = static_cast<float>(d);
      add_neighbour(gather, *(centre - d), distance, receiver_leakage);
      add_neighbour(gather, *(centre + d), distance, receiver_leakage);
    }
    store(i, glm::vec4{resolve(gather), line.depths[static_cast<std::size_t>(i)]});
  }
}

template <Format between_format>
void two_pass_lines(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  const ConstImageView& scene = input.scene;
  const DofSettings& settings = input.settings;
  const int taps = tap_count(largest_filter_radius(input, pool));

  Image between = make_image(between_format, scene.width, scene.height);
  pool.for_each((scene.height + kColumns - 1) / kColumns, [&](int block) {
    Line line(scene.width, taps);
    const int end = std::min((block + 1) * kColumns, scene.height);
    for (int y = block * kColumns; y < end; ++y) {
      fill_line(line, settings, [&](int x) { return load_texel<Format::rgba16f>(scene, x, y); });
      filter_line(line, settings.leak, [&](int x, glm::vec4 value) {
        store_texel<between_format>(between, x, y, value, input.profile);
      });
    }
  });

  pool.for_each((scene.width + kColumns - 1) / kColumns, [&](int block) {
    Line line(scene.height, taps);
    const int end = std::min((block + 1) * kColumns, scene.width);
    for (int x = block * kColumns; x < end; ++x) {
      fill_line(line, settings, [&](int y) { return load_texel<between_format>(between, x, y); });
      filter_line(line, settings.leak, [&](int y, glm::vec4 value) {
        store_texel<Format::rgba16f>(result, x, y, value, input.profile);
      });
    }
  });
}

}  // namespace

void two_pass(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    two_pass_lines<Format::rgba16f>(input, result, pool);
  } else {
    two_pass_strips(input, Between::half, result, pool);
  }
}

void two_pass_single(const DofInput& input, const ImageView& result, ThreadPool& pool) {
  if (pool.isa() == Isa::scalar) {
    two_pass_lines<Format::rgba32f>(input, result, pool);
  } else {
    two_pass_strips(input, Between::single, result, pool);
  }
}

}  // namespace softfocus
