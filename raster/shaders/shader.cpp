#include "raster/shaders/shader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <utility>
#include <variant>

#include "raster/pipeline/assemble.h"
#include "raster/pipeline/interpolate.h"
#include "raster/shaders/link_shaders.h"
#include "raster/shaders/shader_batches.h"
#include "raster/shaders/simplify_tree.h"
#include "raster/threads/loops.h"

namespace softfocus {
namespace {

/// Pixels of a batch: a run of a row, or with differences two rows of half as many.
struct Batch {
  int x = 0, y = 0, lanes = 0;
  bool quads = false;

  int column(int lane) const { return x + (quads ? lane / 4 * 2 + (lane & 1) : lane); }
  int row(int lane) const { return y + (quads ? lane >> 1 & 1 : 0); }
};

int width_of(const ShaderPass& pass) {
  for (const ImageView& target : pass.targets) {
    if (target.texels != nullptr) return target.width;
  }
  return 0;
}

/// The place in the picture on a GPU: a varying of a triangle with corners (-1, -1), (3, -1) and
/// (-1, 3), or of what clipping leaves of it.
class PlacePlanes {
 public:
  static constexpr std::array kKinds{Interpolation::perspective, Interpolation::perspective};

  PlacePlanes(const TriangleSetup& setup, const std::array<Varyings<2>, 3>& corners,
              const Profile& profile)
      : setup_(setup), planes_(planes_of({setup, corners, 2}, profile)) {}

  /// The pixels of a row that are its own.
  Span span(int y, int x_begin, int x_end) const {
    const Rectangle& bounds = setup_.bounds;
    if (y < bounds.y_begin || y >= bounds.y_end) return {};
    x_begin = std::max(x_begin, bounds.x_begin);
    x_end = std::min(x_end, bounds.x_end);
    return x_begin < x_end ? covered_span(setup_, y, x_begin, x_end) : Span{};
  }

  /// u or v at each pixel of the batch.
  void fill(std::size_t component, const Batch& batch, std::span<std::uint32_t> to) const {
    std::visit(
        [&](const auto& planes) {
          for (int lane = 0; lane < batch.lanes; ++lane) {
            const auto pixel = planes.pixel(batch.column(lane), batch.row(lane));
            to[static_cast<std::size_t>(lane)] =
                std::bit_cast<std::uint32_t>(planes.varying(pixel, component));
          }
        },
        planes_);
  }

 private:
  using FromOrigin = PlaneInterpolator<PlanesFromOrigin, 2>;
  using ByQuad = PlaneInterpolator<PlanesByQuad, 2>;
  TriangleSetup setup_;
  std::variant<FromOrigin, ByQuad> planes_;

  static std::variant<FromOrigin, ByQuad> planes_of(const Triangle<2>& triangle,
                                                    const Profile& profile) {
    if (profile.attributes == AttributeSetup::planes_by_quad) {
      return ByQuad{triangle, profile, kKinds};
    }
    return FromOrigin{triangle, profile, kKinds};
  }
};

/// None where attributes are no planes: there the place is (x + 1/2) / width.
std::vector<PlacePlanes> place_planes(int width, int height, const Profile& profile) {
  std::vector<PlacePlanes> made;
  if (profile.attributes == AttributeSetup::exact_barycentric) return made;
  const Rectangle all{0, 0, width, height};
  const std::array<VertexOutput<2>, 3> corners{
      {{{-1, -1, 0, 1}, {0, 0}}, {{3, -1, 0, 1}, {2, 0}}, {{-1, 3, 0, 1}, {0, 2}}}};
  to_window_triangles(
      corners, PlacePlanes::kKinds, ProvokingVertex::last, all, profile,
      [&](const std::array<WindowVertex, 3>& window, const std::array<Varyings<2>, 3>& varyings) {
        const auto setup = set_up_triangle(window, Cull::none, FrontFace::clockwise, all, profile);
        if (setup) made.emplace_back(*setup, varyings, profile);
      });
  return made;
}

class Run {
 public:
  Run(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool)
      : program_(program),
        pass_(pass),
        pool_(pool),
        batches_(program,
                 {.textures = pass.textures,
                  .profile = pass.profile,
                  .budget = pass.budget,
                  .lanes = pass.lanes,
                  .row_lanes = width_of(pass) * (program.has_derivatives ? 2 : 1),
                  .uniforms = pass.uniforms},
                 pool.isa()),
        lanes_(batches_.lanes()) {
    for (const ImageView& target : pass.targets) {
      if (target.texels == nullptr) continue;
      width_ = target.width;
      height_ = target.height;
    }
    find_columns();
    planes_ = place_planes(width_, height_, pass.profile);
    for (const auto& output : program.outputs) {
      if (output.output.builtin >= 0) continue;
      const auto location = static_cast<std::size_t>(output.output.location);
      const auto component = static_cast<std::size_t>(output.output.component);
      if (location >= outputs_.size() || component >= 4) continue;
      outputs_[location][component] = &output.from;
      are_bits_[location] = output.output.is_integer;
    }
  }

  void run() {
    const int rows = program_.has_derivatives ? 2 : 1;
    const int columns = lanes_ / rows;
    const int across = (width_ + columns - 1) / columns, down = (height_ + rows - 1) / rows;
    for_each_band_with<BatchMemory>(pool_, down, 4, [&](int first, int end, BatchMemory& memory) {
      for (int j = first; j < end; ++j) {
        for (int i = 0; i < across; ++i) {
          const Batch batch{i * columns, j * rows, lanes_, rows == 2};
          if (planes_.empty()) run_batch(batch, nullptr, memory);
          for (const PlacePlanes& planes : planes_) run_batch(batch, &planes, memory);
        }
      }
    });
  }

 private:
  static constexpr std::size_t kMostTargets = 8;
  const ShaderProgram& program_;
  const ShaderPass& pass_;
  ThreadPool& pool_;
  ShaderBatches batches_;
  int width_ = 0, height_ = 0, lanes_ = 0;
  std::array<std::array<const ShaderRegister*, 4>, kMostTargets> outputs_{};
  std::array<bool, kMostTargets> are_bits_{};

  /// Of columns, as many as batches have: x + 1/2, and their place in the picture. With
  /// differences each two columns twice, as the lanes of a block have them.
  std::vector<float> columns_{}, u_{};
  std::vector<PlacePlanes> planes_{};

  void find_columns() {
    const bool quads = program_.has_derivatives;
    const auto count = static_cast<std::size_t>(width_ + lanes_) * (quads ? 2 : 1);
    columns_.resize(count);
    u_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      columns_[i] = static_cast<float>(quads ? i / 4 * 2 + (i & 1) : i) + 0.5f;
      u_[i] = columns_[i] / static_cast<float>(width_);
    }
  }

  /// An input's numbers by column; null if they do not depend on it.
  const float* by_column(const ShaderInput& of) const {
    if (of.builtin >= 0) {
      const bool is_x =
          static_cast<SpirvBuiltin>(of.builtin) == SpirvBuiltin::frag_coord && of.part == 0;
      return is_x ? columns_.data() : nullptr;
    }
    return of.component == 0 && !given(of) ? u_.data() : nullptr;
  }

  const PassVarying* given(const ShaderInput& of) const {
    for (const PassVarying& varying : pass_.varyings) {
      if (varying.location == of.location && varying.component == of.component) return &varying;
    }
    return nullptr;
  }

  /// An input of a row that does not depend on the column.
  std::uint32_t of_row(const ShaderInput& of, int row) const {
    const auto bits = [](float value) { return std::bit_cast<std::uint32_t>(value); };
    const float y = static_cast<float>(row) + 0.5f;
    switch (static_cast<SpirvBuiltin>(of.builtin)) {
      case SpirvBuiltin::frag_coord: return bits(of.part == 1 ? y : of.part == 2 ? 0.5f : 1.0f);
      case SpirvBuiltin::point_coord: return bits(0.5f);
      case SpirvBuiltin::front_facing: return ~0u;
      default: break;
    }
    if (of.builtin >= 0) return 0;
    if (const PassVarying* varying = given(of)) return bits(varying->value);
    // The place in the picture: u, v, 0, 1.
    if (of.component == 1) return bits(y / static_cast<float>(height_));
    return bits(of.component == 3 ? 1.0f : 0.0f);
  }

  void fill(const ShaderInput& of, const Batch& batch, std::span<std::uint32_t> to) const {
    const float* const columns = by_column(of);
    if (!batch.quads) {
      if (columns != nullptr) {
        std::memcpy(to.data(), columns + batch.x, to.size_bytes());
      } else {
        std::fill(to.begin(), to.end(), of_row(of, batch.y));
      }
      return;
    }
    if (columns != nullptr) {
      std::memcpy(to.data(), columns + 2 * batch.x, to.size_bytes());
      return;
    }
    const std::uint32_t upper = of_row(of, batch.y), lower = of_row(of, batch.y + 1);
    const std::array block{upper, upper, lower, lower};
    for (std::size_t lane = 0; lane < to.size(); lane += 4) {
      std::memcpy(&to[lane], block.data(), sizeof block);
    }
  }

  /// Of the pixels of `planes`, if they are not null.
  void run_batch(const Batch& batch, const PlacePlanes* planes, BatchMemory& memory) {
    const int rows = batch.quads ? 2 : 1, x_end = std::min(batch.x + lanes_ / rows, width_);
    std::array<Span, 2> spans{};
    for (int row = 0; row < rows && batch.y + row < height_; ++row) {
      spans[static_cast<std::size_t>(row)] =
          planes != nullptr ? planes->span(batch.y + row, batch.x, x_end) : Span{batch.x, x_end};
    }
    const auto is_empty = [](const Span& span) { return span.x_begin >= span.x_end; };
    if (std::all_of(spans.begin(), spans.end(), is_empty)) return;
    batches_.run(memory, [&](const ShaderInput& of, std::span<std::uint32_t> to) {
      const bool is_place = of.builtin < 0 && of.component < 2 && !given(of);
      if (planes != nullptr && is_place) {
        planes->fill(static_cast<std::size_t>(of.component), batch, to);
      } else {
        fill(of, batch, to);
      }
    });
    for (std::size_t i = 0; i < std::min(pass_.targets.size(), kMostTargets); ++i) {
      if (pass_.targets[i].texels != nullptr) store(i, batch, spans, memory);
    }
  }

  void store(std::size_t target, const Batch& batch, const std::array<Span, 2>& spans,
             const BatchMemory& memory) const {
    const ImageView& to = pass_.targets[target];
    constexpr int kMostLanes = 1024;
    alignas(64) std::array<std::array<float, kMostLanes>, 4> values;
    alignas(64) std::array<std::int32_t, kMostLanes> killed;
    const int rows = batch.quads ? 2 : 1, columns = lanes_ / rows;
    for (int row = 0; row < rows && batch.y + row < to.height; ++row) {
      const int count = std::min(columns, to.width - batch.x);
      std::array<const float*, 4> channels{};
      for (std::size_t c = 0; c < 4; ++c) {
        const ShaderRegister* from = outputs_[target][c];
        if (from != nullptr && from->varies && rows == 1) {
          channels[c] = reinterpret_cast<const float*>(batches_.place(memory, *from));
          continue;
        }
        channels[c] = values[c].data();
        const float* const all =
            from == nullptr ? nullptr
                            : reinterpret_cast<const float*>(batches_.place(memory, *from));
        if (from == nullptr || !from->varies) {
          std::fill_n(values[c].begin(), columns, all != nullptr ? all[0] : 0.0f);
          continue;
        }
        for (int i = 0; i < columns; ++i) {
          values[c][static_cast<std::size_t>(i)] = all[i / 2 * 4 + row * 2 + (i & 1)];
        }
      }
      const Span& span = spans[static_cast<std::size_t>(row)];
      const std::int32_t* dead = nullptr;
      if (program_.killed.is_there || span.x_end - span.x_begin < count) {
        const auto* all =
            program_.killed.is_there
                ? reinterpret_cast<const std::int32_t*>(batches_.place(memory, program_.killed))
                : nullptr;
        for (int i = 0; i < columns; ++i) {
          const int x = batch.x + i, lane = rows == 1 ? i : i / 2 * 4 + row * 2 + (i & 1);
          const bool is_mine = x >= span.x_begin && x < span.x_end;
          killed[static_cast<std::size_t>(i)] = !is_mine ? -1 : all != nullptr ? all[lane] : 0;
        }
        dead = killed.data();
      }
      store_lanes(pool_.isa(), channels.data(), dead, count, to.format, pass_.profile,
                  to.texels + (batch.y + row) * to.stride_bytes +
                      static_cast<std::ptrdiff_t>(batch.x) *
                          static_cast<std::ptrdiff_t>(bytes_per_texel(to.format)),
                  are_bits_[target]);
    }
  }
};

/// Inputs that are the place in the picture: of each component one, and 0 and 1 are known.
void join_places(ShaderTree& tree, ShaderRegion& region) {
  for (ShaderNode& node : region) {
    if (node.first) join_places(tree, *node.first);
    if (node.second) join_places(tree, *node.second);
    ShaderInstruction& in = node.instruction;
    if (node.kind != ShaderNodeKind::instruction || in.op != ShaderOp::input) continue;
    const ShaderInput& of = tree.inputs[in.place];
    if (of.builtin >= 0 || of.uniform >= 0) continue;
    if (of.component >= 2) {
      in.op = ShaderOp::copy;
      in.a = tree.constant(std::bit_cast<std::uint32_t>(of.component == 3 ? 1.0f : 0.0f));
      continue;
    }
    const auto same =
        std::find_if(tree.inputs.begin(), tree.inputs.end(), [&](const ShaderInput& i) {
          return i.builtin < 0 && i.uniform < 0 && i.component == of.component;
        });
    in.place = static_cast<std::uint32_t>(same - tree.inputs.begin());
  }
}

}  // namespace

UserShader make_shader(std::vector<std::uint32_t> words) {
  UserShader made;
  made.module = std::make_unique<SpirvModule>(read_spirv(std::move(words)));
  give_locations(*made.module);
  made.uniforms = uniforms_of(*made.module);
  return made;
}

const ShaderUniform* find_uniform(const UserShader& shader, std::string_view name) {
  for (const ShaderUniform& uniform : shader.uniforms.all) {
    if (uniform.name == name) return &uniform;
  }
  return nullptr;
}

std::optional<std::uint32_t> uniform_word(const ShaderUniform& of, double value) {
  if (of.kind == SpirvKind::floating) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  if (of.kind == SpirvKind::boolean) return value != 0.0 ? ~0u : 0u;
  const double least = of.is_signed ? -0x1p31 : 0.0, most = of.is_signed ? 0x1p31 : 0x1p32;
  if (!(value >= least && value < most) || value != std::floor(value)) return {};
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(value));
}

ShaderProgram compile_shader(const UserShader& shader, std::span<const std::uint32_t> words,
                             const std::vector<bool>& is_late, bool are_places) {
  ShaderTree tree = lower_spirv(*shader.module, words, is_late);
  if (are_places) join_places(tree, tree.main);
  simplify(tree);
  ShaderProgram program = emit_program(tree);
  if (shader.module->stage == ShaderStage::vertex && program.has_derivatives) {
    throw ShaderError("a vertex shader has no derivatives: vertices have no neighbours");
  }
  program.files = shader.module->strings;
  return program;
}

std::vector<bool> sampled_textures(const ShaderProgram& program, std::size_t count) {
  std::vector<bool> sampled(count);
  for (const ShaderSampleRegisters& sample : program.samples) {
    for (const ShaderProgram::Constant& constant : program.constants) {
      if (!sample.texture.varies && constant.number == sample.texture.number &&
          constant.bits < count) {
        sampled[constant.bits] = true;
      }
    }
  }
  return sampled;
}

void run_shader(const ShaderProgram& program, const ShaderPass& pass, ThreadPool& pool) {
  Run{program, pass, pool}.run();
}

}  // namespace softfocus
