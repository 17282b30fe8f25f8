// Steps that are one, and registers that several values share.

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <queue>
#include <span>
#include <string>
#include <utility>

#include "raster/shaders/shader_program.h"

namespace softfocus {
namespace {

// --- steps that are one ---

/// How often each register that varies is read.
std::vector<std::uint32_t> reads_of(const ShaderProgram& program) {
  std::vector<std::uint32_t> reads(program.varying_count);
  const auto count = [&](const ShaderRegister& of) {
    if (of.is_there && of.varies) ++reads[of.number];
  };
  for (const ShaderStep& step : program.steps) {
    for (const ShaderRegister& of : {step.a, step.b, step.c, step.d}) count(of);
  }
  for (const ShaderSampleRegisters& sample : program.samples) {
    for (const ShaderRegister& of : sample.at) count(of);
    for (const ShaderRegister& of : sample.more) count(of);
    for (const ShaderRegister& of : sample.offset) count(of);
    for (const ShaderRegister& of : {sample.texture, sample.sampler, sample.compared}) count(of);
  }
  return reads;
}

/// `v = a b` and soon after `w = v + c`, with v used nowhere else: one step. One step alone makes
/// each of a, b and v, so none between makes them anew.
void join_products(ShaderProgram& program) {
  constexpr std::size_t kFarthest = 16;
  const std::vector<std::uint32_t> reads = reads_of(program);
  const auto is_jump = [](const ShaderStep& step) { return step.op >= number_of(StepOp::jump); };
  std::vector<bool> begins(program.steps.size() + 1);
  for (const ShaderStep& step : program.steps) {
    if (is_jump(step)) begins[std::min<std::size_t>(step.place, program.steps.size())] = true;
  }
  for (std::size_t i = 0; i < program.steps.size(); ++i) {
    const ShaderStep& product = program.steps[i];
    if (product.op != number_of(ShaderOp::multiply) || !product.to.varies) continue;
    if (reads[product.to.number] != 1) continue;
    const auto is = [](const ShaderRegister& a, const ShaderRegister& b) {
      return a.is_there && b.is_there && a.varies == b.varies && a.number == b.number;
    };
    for (std::size_t k = i + 1; k < std::min(program.steps.size(), i + kFarthest); ++k) {
      ShaderStep& step = program.steps[k];
      if (begins[k] || step.op == number_of(ShaderOp::sample)) break;
      if (step.op == number_of(StepOp::jump) && step.place == k + 1) continue;  // dropped
      if (is_jump(step)) break;
      if (step.op == number_of(ShaderOp::add) &&
          (is(step.a, product.to) || is(step.b, product.to))) {
        step.c = is(step.a, product.to) ? step.b : step.a;
        step.a = product.a;
        step.b = product.b;
        step.op = number_of(StepOp::multiply_add);
        program.steps[i].op = number_of(StepOp::jump);  // to the next: dropped with the copies
        program.steps[i].place = static_cast<std::uint32_t>(i) + 1;
        program.steps[i].to = program.steps[i].a = program.steps[i].b = {};
        break;
      }
    }
  }
}

/// `v = ...` and then `variable = v`, with v used nowhere else: the variable is made at once.
void join_copies(ShaderProgram& program) {
  const std::vector<std::uint32_t> reads = reads_of(program);
  for (std::size_t i = 1; i < program.steps.size(); ++i) {
    ShaderStep& step = program.steps[i];
    ShaderStep& before = program.steps[i - 1];
    if (step.op != number_of(ShaderOp::copy) || !step.a.varies || !step.to.varies) continue;
    if (before.op >= number_of(ShaderOp::load) || !before.to.is_there || !before.to.varies)
      continue;
    if (before.to.number != step.a.number || reads[step.a.number] != 1) continue;
    before.to = step.to;
    step.to = step.a = {};
    step.op = number_of(StepOp::jump);  // to the next: dropped below
    step.place = static_cast<std::uint32_t>(i) + 1;
  }
  // Jumps to the next step go.
  std::vector<std::uint32_t> place(program.steps.size() + 1);
  std::vector<ShaderStep> kept;
  for (std::size_t i = 0; i < program.steps.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(kept.size());
    const ShaderStep& step = program.steps[i];
    if (step.op == number_of(StepOp::jump) && step.place == i + 1) continue;
    kept.push_back(step);
  }
  place.back() = static_cast<std::uint32_t>(kept.size());
  for (ShaderStep& step : kept) {
    if (step.op == number_of(StepOp::jump) || step.op == number_of(StepOp::jump_if_none) ||
        step.op == number_of(StepOp::jump_if_false)) {
      step.place = place[step.place];
    }
  }
  program.steps = std::move(kept);
}

// --- registers shared by what is not there at the same time ---

class Sharing {
 public:
  Sharing(ShaderProgram& program, std::span<const RegisterRow> rows)
      : program_(program), rows_(rows) {}

  void run() {
    const std::uint32_t count = program_.varying_count;
    begin_.assign(count, kNever);
    end_.assign(count, 0);
    find_blocks();
    find_live();
    for (const auto& input : program_.inputs) {
      if (input.to.varies) touch(input.to.number, 0);
    }
    const auto last = 2 * static_cast<std::uint32_t>(program_.steps.size());
    for (const auto& output : program_.outputs) {
      if (output.from.varies) touch(output.from.number, last);
    }
    for (const auto& [first, length] : rows_) {
      for (std::uint32_t i = first; i < first + length; ++i) {
        touch(i, 0);
        touch(i, last);
      }
    }
    if (program_.killed.is_there) {
      touch(program_.killed.number, 0);
      touch(program_.killed.number, last);
    }
    assign();
    rename();
  }

 private:
  static constexpr std::uint32_t kNever = 0xFFFFFFFF;
  ShaderProgram& program_;
  std::span<const RegisterRow> rows_;
  std::vector<std::uint32_t> begin_{}, end_{}, given_{};
  struct Block {
    std::uint32_t first = 0, end = 0;
    std::vector<std::uint32_t> next{};
    std::vector<std::uint64_t> uses{}, makes{}, in{}, out{};
  };
  std::vector<Block> blocks_{};

  void touch(std::uint32_t number, std::uint32_t at) {
    begin_[number] = std::min(begin_[number], at);
    end_[number] = std::max(end_[number], at);
  }

  static bool is_jump(const ShaderStep& step) {
    return step.op == number_of(StepOp::jump) || step.op == number_of(StepOp::jump_if_none) ||
           step.op == number_of(StepOp::jump_if_false);
  }
  template <class Body>
  void for_each_read(const ShaderStep& step, const Body& body) const {
    for (const ShaderRegister& of : {step.a, step.b, step.c, step.d}) {
      if (of.is_there && of.varies) body(of.number);
    }
    // What stays in other lanes is read, too.
    if ((step.op == number_of(StepOp::masked_copy) ||
         step.op == number_of(ShaderOp::store_indexed)) &&
        step.to.varies) {
      body(step.to.number);
    }
    if (step.op != number_of(ShaderOp::sample)) return;
    const ShaderSampleRegisters& sample = program_.samples[step.place];
    const auto each = [&](const auto& list) {
      for (const ShaderRegister& of : list) {
        if (of.is_there && of.varies) body(of.number);
      }
    };
    each(sample.at);
    each(sample.more);
    each(sample.offset);
    each(std::array{sample.texture, sample.sampler, sample.compared});
  }
  template <class Body>
  void for_each_made(const ShaderStep& step, const Body& body) const {
    if (step.to.is_there && step.to.varies) body(step.to.number);
    if (step.op != number_of(ShaderOp::sample)) return;
    for (const ShaderRegister& of : program_.samples[step.place].to) {
      if (of.is_there && of.varies) body(of.number);
    }
  }

  void find_blocks() {
    const std::vector<ShaderStep>& steps = program_.steps;
    std::vector<bool> begins(steps.size() + 1);
    begins[0] = true;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (!is_jump(steps[i])) continue;
      begins[steps[i].place] = begins[i + 1] = true;
    }
    std::vector<std::uint32_t> block_at(steps.size() + 1);
    for (std::uint32_t i = 0; i < steps.size(); ++i) {
      if (begins[i]) blocks_.push_back({.first = i});
      block_at[i] = static_cast<std::uint32_t>(blocks_.size()) - 1;
      blocks_.back().end = i + 1;
    }
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const ShaderStep& last = steps[blocks_[b].end - 1];
      if (is_jump(last) && last.place < steps.size())
        blocks_[b].next.push_back(block_at[last.place]);
      if (last.op != number_of(StepOp::jump) && b + 1 < blocks_.size()) {
        blocks_[b].next.push_back(static_cast<std::uint32_t>(b) + 1);
      }
    }
  }

  static bool has(const std::vector<std::uint64_t>& set, std::uint32_t i) {
    return (set[i / 64] >> (i % 64) & 1) != 0;
  }
  static void put(std::vector<std::uint64_t>& set, std::uint32_t i) {
    set[i / 64] |= std::uint64_t{1} << (i % 64);
  }

  template <class Body>
  static void for_each_in(const std::vector<std::uint64_t>& set, const Body& body) {
    for (std::uint32_t word = 0; word < set.size(); ++word) {
      for (std::uint64_t left = set[word]; left != 0; left &= left - 1) {
        body(64 * word + static_cast<std::uint32_t>(std::countr_zero(left)));
      }
    }
  }

  void find_live() {
    // Few are read in a block that does not make them before: only these are live from block to
    // block, and have bits.
    std::vector<std::uint32_t> bit_of(program_.varying_count, kNever), made_in(bit_of),
        number_of_bit;
    for (std::uint32_t b = 0; b < blocks_.size(); ++b) {
      for (std::uint32_t i = blocks_[b].first; i < blocks_[b].end; ++i) {
        for_each_read(program_.steps[i], [&](std::uint32_t of) {
          if (made_in[of] == b || bit_of[of] != kNever) return;
          bit_of[of] = static_cast<std::uint32_t>(number_of_bit.size());
          number_of_bit.push_back(of);
        });
        for_each_made(program_.steps[i], [&](std::uint32_t of) { made_in[of] = b; });
      }
    }
    const std::size_t words = (number_of_bit.size() + 63) / 64;
    constexpr std::size_t kMostWords = std::size_t{1} << 24;
    if (words * blocks_.size() > kMostWords) {
      throw ShaderError("the shader is too long: it has " + std::to_string(blocks_.size()) +
                        " branches and " + std::to_string(program_.varying_count) + " values");
    }
    for (Block& block : blocks_) {
      block.uses.resize(words);
      block.makes.resize(words);
      block.in.resize(words);
      block.out.resize(words);
      for (std::uint32_t i = block.first; i < block.end; ++i) {
        const ShaderStep& step = program_.steps[i];
        for_each_read(step, [&](std::uint32_t of) {
          if (bit_of[of] != kNever && !has(block.makes, bit_of[of])) put(block.uses, bit_of[of]);
        });
        for_each_made(step, [&](std::uint32_t of) {
          if (bit_of[of] != kNever) put(block.makes, bit_of[of]);
        });
      }
    }
    bool grew = true;
    while (grew) {
      grew = false;
      for (std::size_t b = blocks_.size(); b-- > 0;) {
        Block& block = blocks_[b];
        for (std::size_t w = 0; w < words; ++w) {
          std::uint64_t out = 0;
          for (const std::uint32_t next : block.next) out |= blocks_[next].in[w];
          const std::uint64_t in = block.uses[w] | (out & ~block.makes[w]);
          grew = grew || in != block.in[w] || out != block.out[w];
          block.in[w] = in;
          block.out[w] = out;
        }
      }
    }
    for (const Block& block : blocks_) {
      for_each_in(block.in, [&](std::uint32_t bit) { touch(number_of_bit[bit], 2 * block.first); });
      for_each_in(block.out, [&](std::uint32_t bit) { touch(number_of_bit[bit], 2 * block.end); });
      for (std::uint32_t i = block.first; i < block.end; ++i) {
        const ShaderStep& step = program_.steps[i];
        // A step reads at 2 i and writes at 2 i + 1: a result may take an operand's place. Those
        // that make several results, or read other lanes, begin before their operands end.
        const bool at_once = step.op == number_of(ShaderOp::sample) ||
                             step.op == number_of(ShaderOp::load_indexed) ||
                             step.op == number_of(ShaderOp::store_indexed);
        for_each_read(step, [&](std::uint32_t of) { touch(of, 2 * i + (at_once ? 2 : 0)); });
        for_each_made(step, [&](std::uint32_t of) { touch(of, 2 * i + 1); });
        for_each_made(step, [&](std::uint32_t of) {
          if (at_once) touch(of, 2 * i);
        });
      }
    }
  }

  void assign() {
    // Rows keep their order, at the front.
    given_.assign(program_.varying_count, kNever);
    std::uint32_t next = 0;
    for (const auto& [first, length] : rows_) {
      for (std::uint32_t i = 0; i < length; ++i) given_[first + i] = next++;
    }
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < program_.varying_count; ++i) {
      if (begin_[i] != kNever && given_[i] == kNever) order.push_back(i);
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return begin_[a] < begin_[b]; });
    // Places by when they become free, and free ones by number.
    using Least = std::greater<std::pair<std::uint32_t, std::uint32_t>>;
    std::priority_queue<std::pair<std::uint32_t, std::uint32_t>,
                        std::vector<std::pair<std::uint32_t, std::uint32_t>>, Least>
        taken;
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, std::greater<>> open;
    for (const std::uint32_t of : order) {
      for (; !taken.empty() && taken.top().first <= begin_[of]; taken.pop()) {
        open.push(taken.top().second);
      }
      given_[of] = open.empty() ? next++ : open.top();
      if (!open.empty()) open.pop();
      taken.emplace(std::max(end_[of], begin_[of] + 1), given_[of]);
    }
    program_.varying_count = next;
  }

  void rename() {
    const auto give = [&](ShaderRegister& of) {
      if (of.is_there && of.varies) of.number = given_[of.number];
    };
    for (ShaderStep& step : program_.steps) {
      for (ShaderRegister* of : {&step.to, &step.a, &step.b, &step.c, &step.d}) give(*of);
    }
    for (ShaderSampleRegisters& sample : program_.samples) {
      for (auto* list : {&sample.texture, &sample.sampler, &sample.compared}) give(*list);
      for (ShaderRegister& of : sample.at) give(of);
      for (ShaderRegister& of : sample.more) give(of);
      for (ShaderRegister& of : sample.offset) give(of);
      for (ShaderRegister& of : sample.to) give(of);
    }
    for (auto& input : program_.inputs) give(input.to);
    for (auto& output : program_.outputs) give(output.from);
    give(program_.killed);
  }
};

}  // namespace

void join_steps(ShaderProgram& program) {
  join_products(program);
  join_copies(program);
}

void share_registers(ShaderProgram& program, std::span<const RegisterRow> rows) {
  Sharing{program, rows}.run();
}

}  // namespace softfocus
