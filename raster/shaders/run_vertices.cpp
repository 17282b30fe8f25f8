#include "raster/shaders/run_vertices.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "raster/threads/loops.h"

namespace softfocus {
namespace {

/// The bits of an input at vertices first, first + 1 and so on, and again the last.
void fill_vertices(const ShaderInput& of, const VertexRun& run, std::uint32_t first,
                   std::uint32_t last, std::span<std::uint32_t> to) {
  if (of.builtin >= 0) {
    const auto builtin = static_cast<SpirvBuiltin>(of.builtin);
    const bool is_number =
        builtin == SpirvBuiltin::vertex_id || builtin == SpirvBuiltin::vertex_index;
    for (std::uint32_t i = 0; i < to.size(); ++i) {
      to[i] = is_number ? std::min(first + i, last) : 0;
    }
    return;
  }
  const auto found = std::find_if(
      run.attributes.begin(), run.attributes.end(), [&](const VertexAttribute& attribute) {
        return attribute.location == of.location && of.component < attribute.components;
      });
  if (found == run.attributes.end()) {
    const std::uint32_t one = of.is_whole ? 1 : std::bit_cast<std::uint32_t>(1.0f);
    std::fill(to.begin(), to.end(), of.component == 3 ? one : 0);
    return;
  }
  const std::byte* from = found->first + 4 * of.component;
  for (std::uint32_t i = 0; i < to.size(); ++i) {
    std::memcpy(&to[i], from + std::min(first + i, last) * found->stride, 4);
  }
}

/// The register of an output, or one that is not there.
template <class Is>
ShaderRegister output_of(const ShaderProgram& program, const Is& is) {
  for (const ShaderProgram::Output& output : program.outputs) {
    if (is(output.output)) return output.from;
  }
  return {};
}

}  // namespace

void run_vertices(const ShaderBatches& batches, const VertexRun& run, std::uint32_t begin,
                  std::uint32_t end, BatchMemory& memory) {
  const auto lanes = static_cast<std::uint32_t>(batches.lanes());
  const auto number = [&](const ShaderRegister& of, std::uint32_t lane) {
    std::uint32_t bits = 0;
    if (of.is_there) {
      std::memcpy(&bits, batches.place(memory, of) + (of.varies ? 4 * lane : 0), sizeof bits);
    }
    return bits;
  };
  for (std::uint32_t first = begin; first < end; first += lanes) {
    const std::uint32_t count = std::min(lanes, end - first);
    batches.run(memory, [&](const ShaderInput& of, std::span<std::uint32_t> to) {
      fill_vertices(of, run, first, first + count - 1, to);
    });
    for (int part = 0; part < 4 && !run.positions.empty(); ++part) {
      const ShaderRegister from = output_of(batches.program(), [&](const ShaderOutput& output) {
        return output.builtin == static_cast<int>(SpirvBuiltin::position) &&
               output.component == part;
      });
      for (std::uint32_t lane = 0; lane < count; ++lane) {
        run.positions[first + lane][part] = std::bit_cast<float>(number(from, lane));
      }
    }
    for (std::size_t k = 0; k < run.varyings.size(); ++k) {
      const ShaderRegister from = output_of(batches.program(), [&](const ShaderOutput& output) {
        return output.builtin < 0 && output.location == run.varyings[k].location &&
               output.component == run.varyings[k].component;
      });
      for (std::uint32_t lane = 0; lane < count; ++lane) {
        run.values[(first + lane) * run.varyings.size() + k] = number(from, lane);
      }
    }
  }
}

void run_vertices(const ShaderProgram& program, const VertexRun& run, ThreadPool& pool) {
  assert(run.values.size() >= run.varyings.size() * run.vertex_count);
  assert(run.positions.empty() || run.positions.size() >= run.vertex_count);
  const ShaderBatches batches{program,
                              {.textures = run.textures,
                               .profile = run.profile,
                               .budget = run.budget,
                               .lanes = run.lanes,
                               .uniforms = run.uniforms},
                              pool.isa()};
  constexpr std::uint32_t kTogether = 1024;
  const std::uint32_t tasks = (run.vertex_count + kTogether - 1) / kTogether;
  for_each_with<BatchMemory>(pool, static_cast<int>(tasks), [&](int task, BatchMemory& memory) {
    const std::uint32_t begin = static_cast<std::uint32_t>(task) * kTogether;
    run_vertices(batches, run, begin, std::min(begin + kTogether, run.vertex_count), memory);
  });
}

}  // namespace softfocus
