// Stages `coverage`, `depth`, `attributes` and `samples`: triangles in clip space, in batches.

#include <array>
#include <cmath>
#include <glm/vec2.hpp>

#include "raster/images/texel.h"
#include "raster/pipeline/draw.h"
#include "raster/pipeline/multisample.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

constexpr std::size_t kValues = 12;  // 4 with perspective, 4 in the window, 4 flat

/// A vertex as both sides get it; for coverage only the first value counts.
struct Vertex {
  glm::vec4 position;
  std::array<float, kValues> values;
};

// How a case makes its triangles: three vertices' clip positions.
using MakeTriangle = std::array<glm::vec4, 3> (*)(RandomNumbers&);

// A point of the window, -1 to 1 each way, in clip space with that w.
glm::vec4 clip_position(float x, float y, float depth, float w) {
  return glm::vec4{x, y, depth, 1.0f} * w;
}

// Corners around a centre, most triangles small: a side of 2 to 256 of 256 pixels.
std::array<glm::vec4, 3> around(glm::vec2 centre, float reach, RandomNumbers& random, bool use_w) {
  std::array<glm::vec4, 3> corners;
  for (glm::vec4& corner : corners) {
    const float x = centre.x + random.between(-reach, reach);
    const float y = centre.y + random.between(-reach, reach);
    corner = clip_position(x, y, random.between(-0.99f, 0.99f),
                           use_w ? random.between(0.3f, 4.0f) : 1.0f);
  }
  return corners;
}

float random_reach(RandomNumbers& random) {
  static constexpr std::array<float, 8> kReach{0.008f, 0.008f, 0.016f, 0.016f,
                                               0.03f,  0.06f,  0.12f,  0.5f};
  return kReach[static_cast<std::size_t>(random.below(kReach.size()))];
}

std::array<glm::vec4, 3> inside_viewport(RandomNumbers& random) {
  const float reach = random_reach(random);
  const float room = 0.999f - reach;
  const glm::vec2 centre{random.between(-room, room), random.between(-room, room)};
  return around(centre, reach, random, random.below(2) == 0);
}

std::array<glm::vec4, 3> across_edges(RandomNumbers& random) {
  const float reach = 2.0f * random_reach(random);
  glm::vec2 centre{random.between(-1.1f, 1.1f), random.between(-1.1f, 1.1f)};
  centre[random.below(2)] = random.below(2) == 0 ? -1.0f : 1.0f;
  return around(centre, reach, random, true);
}

// Some corners before the near plane, or behind the eye.
std::array<glm::vec4, 3> through_near_plane(RandomNumbers& random) {
  std::array<glm::vec4, 3> corners;
  for (glm::vec4& corner : corners) {
    corner = {random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f), random.between(-2.0f, 2.0f),
              random.between(-0.5f, 2.0f)};
  }
  return corners;
}

// Corners on centres and borders of pixels of a 256 x 256 target.
std::array<glm::vec4, 3> centre_aligned(RandomNumbers& random) {
  std::array<glm::vec4, 3> corners;
  const int x = random.below(480), y = random.below(480);
  const int reach = random.below(4) == 0 ? 200 : 24;
  for (glm::vec4& corner : corners) {
    const auto along = [&](int from) {
      const int half_pixels = std::min(from + random.below(reach), 511);
      return static_cast<float>(half_pixels) / 256.0f - 1.0f;
    };
    corner = clip_position(along(x), along(y), 0.0f, 1.0f);
  }
  return corners;
}

// Long, and much less than a pixel wide.
std::array<glm::vec4, 3> sliver(RandomNumbers& random) {
  const glm::vec2 from{random.between(-0.99f, 0.99f), random.between(-0.99f, 0.99f)};
  const glm::vec2 to{random.between(-0.99f, 0.99f), random.between(-0.99f, 0.99f)};
  const float along = random.between(0.0f, 1.0f);
  const float off = random.between(-0.004f, 0.004f);
  const glm::vec2 middle = from + (to - from) * along + glm::vec2{off, -off};
  return {clip_position(from.x, from.y, 0.0f, 1.0f), clip_position(middle.x, middle.y, 0.0f, 1.0f),
          clip_position(to.x, to.y, 0.0f, 1.0f)};
}

std::vector<Vertex> random_triangles(int count, MakeTriangle make, RandomNumbers& random) {
  std::vector<Vertex> vertices;
  vertices.reserve(static_cast<std::size_t>(count) * 3);
  for (int i = 0; i < count; ++i) {
    for (const glm::vec4& position : make(random)) {
      Vertex vertex{position, {}};
      for (float& value : vertex.values) value = random.between(-10.0f, 10.0f);
      vertices.push_back(vertex);
    }
  }
  return vertices;
}

// Each triangle adds a number of its own to its pixels, so that two errors cancel in a sum once in
// a thousand.
std::vector<Vertex> counted_triangles(int count, MakeTriangle make, RandomNumbers& random) {
  std::vector<Vertex> vertices = random_triangles(count, make, random);
  for (std::size_t i = 0; i < vertices.size(); i += 3) {
    const auto amount = static_cast<float>(1 + random.below(1021));
    for (std::size_t corner = i; corner < i + 3; ++corner) vertices[corner].values[0] = amount;
  }
  return vertices;
}

// A grid of quads with jittered corners over the middle of the target, cut along a
// random diagonal each: every pixel in it is covered exactly once.
std::vector<Vertex> shared_edge_mesh(RandomNumbers& random) {
  constexpr int kCells = 40;
  std::array<std::array<glm::vec4, kCells + 1>, kCells + 1> corners;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const bool rim = i == 0 || j == 0 || i == kCells || j == kCells;
      const float jitter = rim ? 0.0f : 0.45f;
      const auto along = [&](int index) {
        const float at = static_cast<float>(index) + random.between(-jitter, jitter);
        return at / static_cast<float>(kCells) * 1.8f - 0.9f;
      };
      corners[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
          clip_position(along(i), along(j), 0.0f, 1.0f);
    }
  }
  std::vector<Vertex> vertices;
  for (std::size_t j = 0; j < kCells; ++j) {
    for (std::size_t i = 0; i < kCells; ++i) {
      const glm::vec4 quad[4] = {corners[j][i], corners[j][i + 1], corners[j + 1][i + 1],
                                 corners[j + 1][i]};
      const int turn = random.below(2);
      for (const int corner : {0, 1, 2, 0, 2, 3}) {
        Vertex vertex{quad[(corner + turn) % 4], {}};
        vertex.values[0] = 1.0f;
        vertices.push_back(vertex);
      }
    }
  }
  return vertices;
}

struct ListedVertices {
  std::span<const Vertex> vertices;
};

struct CountVertexStage : ListedVertices {
  VertexOutput<1> operator()(std::uint32_t index) const {
    return {vertices[index].position, {vertices[index].values[0]}};
  }
};

struct CountFragmentStage {
  static constexpr std::array<Interpolation, 1> kInterpolation{Interpolation::flat};
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<1> operator()(const Fragment<1>& in) const {
    return {{glm::vec4{in.varyings[0], 0.0f, 0.0f, 0.0f}}, false};
  }
};

struct ValuesVertexStage : ListedVertices {
  VertexOutput<kValues> operator()(std::uint32_t index) const {
    return {vertices[index].position, vertices[index].values};
  }
};

template <bool centroid = false>
struct ValuesFragmentStage {
  static constexpr bool kCentroid = centroid;
  static constexpr auto kInterpolation = [] {
    std::array<Interpolation, kValues> kinds{};
    for (std::size_t i = 0; i < kValues; ++i) {
      kinds[i] = i < 4   ? Interpolation::perspective
                 : i < 8 ? Interpolation::linear
                         : Interpolation::flat;
    }
    return kinds;
  }();
  static constexpr bool kNeedsDerivatives = false;
  static constexpr bool kDiscards = false;
  FragmentOutput<3> operator()(const Fragment<kValues>& in) const {
    FragmentOutput<3> output;
    for (std::size_t i = 0; i < kValues; ++i) {
      output.colour[i / 4][static_cast<int>(i % 4)] = in.varyings[i];
    }
    return output;
  }
};

std::vector<std::uint32_t> in_order(std::size_t count) {
  std::vector<std::uint32_t> indices(count);
  for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<std::uint32_t>(i);
  return indices;
}

void draw_on_gl(const GlTarget& target, const GlProgram& program,
                std::span<const Vertex> vertices) {
  GLuint name = 0;
  glGenBuffers(1, &name);
  const GlBuffer buffer{name};
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_STREAM_DRAW);
  // The values follow the position in fours; count.vert takes the first alone.
  for (GLuint location = 0; location < 4; ++location) {
    glVertexAttribPointer(location, 4, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          // NOLINTNEXTLINE(performance-no-int-to-ptr): an offset
                          reinterpret_cast<const void*>(std::size_t{location} * 16));
    glEnableVertexAttribArray(location);
  }
  bind(target);
  glUseProgram(program);
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
  for (GLuint location = 0; location < 4; ++location) glDisableVertexAttribArray(location);
}

void clear_on_gl(const GlTarget& target) {
  bind(target);
  glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

struct TargetSize {
  int width = 256;
  int height = 256;
  int samples = 1;
};

GlTarget make_target(std::span<const Format> formats, const TargetSize& size, bool with_depth) {
  return make_target(formats, size.width, size.height, with_depth, size.samples);
}

Image make_image(Format format, const TargetSize& size) {
  return make_image(format, size.width, size.height * size.samples);
}

Image read_all([[maybe_unused]] const Bench& bench, const GlTarget& target, std::size_t index) {
#ifndef SOFTFOCUS_WEBGL
  if (target.samples > 1) return read_samples(bench.gl, target, index);
#endif
  return read_colour(target, index);
}

template <class MakeBatch>
void count_both(const Bench& bench, Tally& tally, int batches, TargetSize size,
                const MakeBatch& make_batch) {
  const GlProgram program = link_program(bench.gl, bench.shaders, "count.vert", "count.frag");
  const GlTarget target = make_target(std::array{Format::r32f}, size, false);
  DrawState state;
  state.cull = Cull::none;
  state.depth.reset();
  constexpr BlendEquation kAdd{BlendFactor::one, BlendFactor::one, BlendOp::add};
  state.colour[0].blend = BlendState{kAdd, kAdd};
  for (int i = 0; i < batches; ++i) {
    const std::vector<Vertex> vertices = make_batch(i);
    clear_on_gl(target);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    draw_on_gl(target, program, vertices);
    glDisable(GL_BLEND);

    Image emulated = make_image(Format::r32f, size);
    RenderPass pass;
    pass.targets.samples = size.samples;
    pass.targets.colour[0] = &emulated;
    pass.profile = bench.profile;
    const auto indices = in_order(vertices.size());
    draw(pass, state, indices, static_cast<std::uint32_t>(indices.size()),
         CountVertexStage{{vertices}}, CountFragmentStage{});
    finish(pass, bench.pool);
    add_pictures(tally, read_all(bench, target, 0), emulated, "batch " + std::to_string(i));
  }
}

enum class Compared : std::uint8_t { depth, attributes, centroid, alpha_to_coverage, resolved };

void attributes_both(const Bench& bench, Tally& tally, MakeTriangle make, int batches,
                     unsigned seed, TargetSize size, Compared compared) {
  using enum Compared;
  constexpr int kBatch = 200;
  RandomNumbers random{seed};
  const GlProgram program =
      link_program(bench.gl, bench.shaders, "interpolate.vert", "interpolate.frag",
                   compared == centroid ? "#define PLACE centroid\n" : "");
  const std::array formats{compared == resolved ? Format::rgba16f : Format::rgba32f,
                           Format::rgba32f, Format::rgba32f};
  const GlTarget target = make_target(formats, size, true);
  DrawState state;
  state.cull = Cull::none;
  state.alpha_to_coverage = compared == alpha_to_coverage;
  for (int i = 0; i < batches; ++i) {
    const std::vector<Vertex> vertices = random_triangles(kBatch, make, random);
    clear_on_gl(target);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDisable(GL_CULL_FACE);
#ifndef SOFTFOCUS_WEBGL
    if (state.alpha_to_coverage) glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);
#endif
    draw_on_gl(target, program, vertices);
#ifndef SOFTFOCUS_WEBGL
    if (state.alpha_to_coverage) glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
#endif

    std::array<Image, 3> emulated;
    Image depth = make_image(Format::r32f, size);
    clear_image(depth, glm::vec4{1.0f}, bench.profile);
    RenderPass pass;
    for (std::size_t k = 0; k < 3; ++k) {
      emulated[k] = make_image(formats[k], size);
      pass.targets.colour[k] = &emulated[k];
    }
    pass.targets.depth = &depth;
    pass.targets.samples = size.samples;
    pass.profile = bench.profile;
    const auto indices = in_order(vertices.size());
    const auto count = static_cast<std::uint32_t>(indices.size());
    if (compared == centroid) {
      draw(pass, state, indices, count, ValuesVertexStage{{vertices}}, ValuesFragmentStage<true>{});
    } else {
      draw(pass, state, indices, count, ValuesVertexStage{{vertices}}, ValuesFragmentStage<>{});
    }
    finish(pass, bench.pool);
    const std::string batch = "batch " + std::to_string(i);
#ifndef SOFTFOCUS_WEBGL
    if (compared == resolved) {
      add_pictures(tally, read_resolved(target), resolve(emulated[0], size.samples, bench.profile),
                   batch);
      continue;
    }
#endif
    if (compared == Compared::depth || compared == alpha_to_coverage) {
      add_pictures(tally, read_depth(bench.gl, target), depth, batch);
    }
    if (compared == Compared::depth) continue;
    static constexpr const char* kKinds[] = {"perspective, ", "linear, ", "flat, "};
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == 1 && !bench.gl.has_linear_varyings()) continue;
      add_pictures(tally, read_all(bench, target, k), emulated[k], kKinds[k] + batch);
    }
  }
}

}  // namespace

void add_triangle_cases(std::vector<Case>& cases) {
  constexpr int kBatch = 4000;  // sums stay below 2^24, where floats are exact
  unsigned seed = 1000;
  const auto coverage = [&](const std::string& name, bool quick, bool slow_too, int triangles,
                            MakeTriangle make, TargetSize size = {}) {
    cases.push_back(
        {"coverage", name, quick, slow_too, [=, at = ++seed](const Bench& bench, Tally& tally) {
           RandomNumbers random{at};
           const int batches = (triangles + kBatch - 1) / kBatch;
           count_both(bench, tally, batches, size, [&](int i) {
             return counted_triangles(std::min(kBatch, triangles - i * kBatch), make, random);
           });
         }});
  };
  coverage("inside-20000", true, true, 20'000, inside_viewport);
  coverage("inside-1000000", false, false, 1'000'000, inside_viewport);
  coverage("across-edges-4000", true, true, 4'000, across_edges);
  coverage("across-edges-100000", false, false, 100'000, across_edges);
  coverage("near-plane-4000", true, true, 4'000, through_near_plane);
  coverage("near-plane-100000", false, false, 100'000, through_near_plane);
  coverage("centre-aligned-20000", true, true, 20'000, centre_aligned);
  coverage("slivers-20000", true, true, 20'000, sliver);
  coverage("odd-size-inside", true, true, 20'000, inside_viewport, {333, 117});
  coverage("odd-size-across-edges", true, true, 4'000, across_edges, {333, 117});
  coverage("one-pixel", false, true, 1'000, across_edges, {1, 1});
  coverage("one-column", false, true, 4'000, across_edges, {1, 300});
  cases.push_back(
      {"coverage", "shared-edge-meshes", true, true, [](const Bench& bench, Tally& tally) {
         RandomNumbers random{77};
         count_both(bench, tally, 8, {}, [&](int) { return shared_edge_mesh(random); });
       }});

  struct Kind {
    const char* name;
    MakeTriangle make;
  };
  for (const bool only_depth : {true, false}) {
    const char* stage = only_depth ? "depth" : "attributes";
    for (const Kind& kind : {Kind{"inside", inside_viewport}, Kind{"across-edges", across_edges},
                             Kind{"near-plane", through_near_plane}, Kind{"slivers", sliver}}) {
      const auto add = [&](const std::string& name, bool quick, bool slow_too, int batches,
                           TargetSize size) {
        cases.push_back({stage, name, quick, slow_too,
                         [=, make = kind.make, at = ++seed](const Bench& bench, Tally& tally) {
                           attributes_both(bench, tally, make, batches, at, size,
                                           only_depth ? Compared::depth : Compared::attributes);
                         }});
      };
      add(kind.name, true, true, 4, {});
      add(std::string(kind.name) + "-many", false, false, 50, {});
      add(std::string(kind.name) + "-odd-size", true, true, 4, {333, 117});
    }
  }

  // Four samples a pixel.
  constexpr TargetSize kSampled{200, 136, 4};
  const auto sampled = [&](const std::string& name, bool quick, const auto& run) {
    cases.push_back({"samples", name, quick, true,
                     [=, at = ++seed](const Bench& bench, Tally& tally) { run(bench, tally, at); },
                     true});
  };
  for (const Kind& kind : {Kind{"inside", inside_viewport}, Kind{"across-edges", across_edges},
                           Kind{"near-plane", through_near_plane},
                           Kind{"centre-aligned", centre_aligned}, Kind{"slivers", sliver}}) {
    const MakeTriangle make = kind.make;
    sampled(std::string("coverage-") + kind.name, true,
            [=](const Bench& bench, Tally& tally, unsigned at) {
              RandomNumbers random{at};
              count_both(bench, tally, 5, kSampled,
                         [&](int) { return counted_triangles(kBatch, make, random); });
            });
    for (const auto& [name, compared] : {std::pair{"depth-", Compared::depth},
                                         {"attributes-", Compared::attributes},
                                         {"centroid-", Compared::centroid},
                                         {"alpha-", Compared::alpha_to_coverage},
                                         {"resolved-", Compared::resolved}}) {
      sampled(std::string(name) + kind.name, true,
              [=, of = compared](const Bench& bench, Tally& tally, unsigned at) {
                attributes_both(bench, tally, make, 4, at, kSampled, of);
              });
    }
  }
}

}  // namespace softfocus
