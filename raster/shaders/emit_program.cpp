#include <algorithm>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "raster/shaders/shader_program.h"
#include "raster/shaders/simplify_tree.h"

namespace softfocus {
namespace {

using enum ShaderNodeKind;

// --- what varies ---

/// Which values and variables differ between pixels, and which scopes some pixels may leave before
/// others. Found again and again until nothing is added.
struct Varying {
  std::vector<bool> values, variables, scopes;
  std::unordered_set<const ShaderNode*> exits{};  ///< which only some pixels may take at a time
  bool grew = false;

  explicit Varying(const ShaderTree& tree)
      : values(tree.values.size()), variables(tree.variable_count), scopes(tree.scope_count) {
    // What an index chooses from lies in the memory of lanes.
    mark_indexed(tree.main);
    // Each time finds what varies by a turn of a loop more. Whoever takes longer varies as a whole.
    constexpr int kMostTimes = 256;
    int times = 0;
    do {
      grew = false;
      std::vector<std::uint32_t> left;
      run(tree, tree.main, false, left);
    } while (grew && ++times < kMostTimes);
    if (!grew) return;
    for (std::vector<bool>* all : {&values, &variables, &scopes}) all->assign(all->size(), true);
    std::vector<std::uint32_t> left;
    run(tree, tree.main, true, left);
  }

  void mark_indexed(const ShaderRegion& region) {
    for (const ShaderNode& node : region) {
      const ShaderInstruction& in = node.instruction;
      if (node.kind == instruction &&
          (in.op == ShaderOp::load_indexed || in.op == ShaderOp::store_indexed)) {
        // The elements and what lies between them: structures have members side by side.
        for (std::uint32_t i = 0; i <= (in.count - 1) * in.stride; ++i) {
          variables[in.place + i] = true;
        }
      }
      if (node.first) mark_indexed(*node.first);
      if (node.second) mark_indexed(*node.second);
    }
  }

  void mark(std::vector<bool>& of, std::uint32_t number) {
    if (of[number]) return;
    of[number] = true;
    grew = true;
  }

  bool varies(const ShaderTree& tree, const ShaderInstruction& in) const {
    using enum ShaderOp;
    if (in.op == input) return tree.inputs[in.place].uniform < 0;
    if (in.op == load_indexed || (in.op >= derivative_x && in.op <= derivative_y_coarse)) {
      return true;
    }
    if (in.op == load) return variables[in.place];
    bool any = false;
    const auto look = [&](ShaderValue of) { any = any || (of != kNoValue && values[of]); };
    look(in.a);
    look(in.b);
    look(in.c);
    look(in.d);
    if (in.op != sample) return any;
    const ShaderSample& of = tree.samples[in.place];
    for (const ShaderValue value : of.at) look(value);
    for (const ShaderValue value : of.more) look(value);
    for (const ShaderValue value : of.offset) look(value);
    for (const ShaderValue value : {of.texture, of.sampler, of.compared}) look(value);
    return any || of.kind == SampleKind::implicit || of.kind == SampleKind::query_lod;
  }

  /// `apart`: whether some pixels may be elsewhere. Adds the scopes that some of them leave to
  /// `left`.
  void run(const ShaderTree& tree, const ShaderRegion& region, bool apart,
           std::vector<std::uint32_t>& left) {
    for (const ShaderNode& node : region) {
      const ShaderInstruction& in = node.instruction;
      switch (node.kind) {
        case instruction:
          if (varies(tree, in)) {
            for_each_result(tree, in, [&](ShaderValue of) { mark(values, of); });
          }
          if (in.op == ShaderOp::store && (apart || values[in.a])) mark(variables, in.place);
          break;
        case branch: {
          std::vector<std::uint32_t> inner;
          const bool inside = apart || values[in.a];
          run(tree, *node.first, inside, inner);
          run(tree, *node.second, inside, inner);
          apart = apart || !inner.empty();
          left.insert(left.end(), inner.begin(), inner.end());
          break;
        }
        case scope: {
          std::vector<std::uint32_t> inner;
          run(tree, *node.first, apart || (node.loops && scopes[node.scope]), inner);
          // Who leaves a loop for good while others go on makes its next turn apart.
          if (node.loops && !inner.empty()) mark(scopes, node.scope);
          inner.erase(std::remove(inner.begin(), inner.end(), node.scope), inner.end());
          apart = apart || !inner.empty();
          left.insert(left.end(), inner.begin(), inner.end());
          break;
        }
        case ShaderNodeKind::exit:
          if (apart) {
            exits.insert(&node);
            mark(scopes, node.scope);
            left.push_back(node.scope);
          }
          break;
      }
    }
    std::sort(left.begin(), left.end());
    left.erase(std::unique(left.begin(), left.end()), left.end());
  }
};

// --- steps ---

class Emitter {
 public:
  Emitter(const ShaderTree& tree, ShaderProgram& to)
      : tree_(tree),
        to_(to),
        varying_(tree),
        of_value_(tree.values.size()),
        of_variable_(tree.variable_count) {}

  void run() {
    give_indexed(tree_.main);
    if (tree_.has_derivatives) begin_variables();
    region(tree_.main, {});
    put_step(number_of(StepOp::end));
    for (const ShaderOutput& output : tree_.outputs) {
      if (of_variable_[output.variable].is_there) {
        to_.outputs.push_back({output, of_variable_[output.variable]});
      }
    }
    to_.tables = tree_.tables;
    to_.has_derivatives = tree_.has_derivatives;
  }

  /// Runs of registers that must lie one behind the other.
  std::vector<RegisterRow> rows{};

 private:
  const ShaderTree& tree_;
  ShaderProgram& to_;
  Varying varying_;
  std::vector<ShaderRegister> of_value_, of_variable_;

  struct Scope {
    std::uint32_t number = 0;
    ShaderRegister live{};             ///< lanes that have not left; if some may
    std::vector<std::size_t> jumps{};  ///< steps that go to its end
  };
  std::vector<Scope> scopes_{};  ///< around

  ShaderRegister new_register(bool varies) {
    return {varies ? to_.varying_count++ : to_.uniform_count++, varies, true};
  }
  ShaderRegister constant(std::uint32_t bits) {
    const ShaderRegister made = new_register(false);
    to_.constants.push_back({made.number, bits});
    return made;
  }
  std::optional<ShaderRegister> all_lanes_{};
  ShaderRegister all_lanes() {
    if (!all_lanes_) all_lanes_ = constant(~0u);
    return *all_lanes_;
  }

  ShaderRegister of(ShaderValue value) {
    if (value == kNoValue) return {};
    ShaderRegister& known = of_value_[value];
    if (!known.is_there) {
      known = tree_.is_constant(value) ? constant(tree_.bits(value))
                                       : new_register(varying_.values[value]);
    }
    return known;
  }
  ShaderRegister of_variable(ShaderVariable variable) {
    ShaderRegister& known = of_variable_[variable];
    if (!known.is_there) known = new_register(varying_.variables[variable]);
    return known;
  }

  /// Variables that an index chooses from get registers in a row.
  void give_indexed(const ShaderRegion& region) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> ranges;
    collect_indexed(region, ranges);
    std::sort(ranges.begin(), ranges.end());
    for (std::size_t i = 0; i < ranges.size();) {
      auto [begin, end] = ranges[i++];
      while (i < ranges.size() && ranges[i].first <= end) end = std::max(end, ranges[i++].second);
      const std::uint32_t first = to_.varying_count;
      for (std::uint32_t k = begin; k <= end; ++k) of_variable_[k] = new_register(true);
      rows.push_back({first, end - begin + 1});
    }
  }
  static void collect_indexed(const ShaderRegion& region,
                              std::vector<std::pair<std::uint32_t, std::uint32_t>>& to) {
    for (const ShaderNode& node : region) {
      const ShaderInstruction& in = node.instruction;
      if (node.kind == instruction &&
          (in.op == ShaderOp::load_indexed || in.op == ShaderOp::store_indexed)) {
        to.emplace_back(in.place, in.place + (in.count - 1) * in.stride);
      }
      if (node.first) collect_indexed(*node.first, to);
      if (node.second) collect_indexed(*node.second, to);
    }
  }

  ShaderStep& put_step(std::uint8_t op, ShaderRegister to = {}, ShaderRegister a = {},
                       ShaderRegister b = {}, ShaderRegister c = {}, ShaderRegister d = {}) {
    to_.steps.push_back({.op = op, .to = to, .a = a, .b = b, .c = c, .d = d});
    to_.steps.back().line = line_;
    return to_.steps.back();
  }
  ShaderLine line_{};
  std::size_t here() const { return to_.steps.size(); }
  void land(std::size_t jump) { to_.steps[jump].place = static_cast<std::uint32_t>(here()); }

  ShaderRegister mask_and(ShaderRegister mask, ShaderRegister also, bool turned) {
    const ShaderRegister made = new_register(true);
    const ShaderRegister from = mask.is_there ? mask : all_lanes();
    put_step(turned ? number_of(StepOp::and_not) : number_of(ShaderOp::bit_and), made, from, also);
    return made;
  }

  /// The innermost scope's lanes that have not left, of those around that some may leave.
  ShaderRegister innermost_live() const {
    for (std::size_t i = scopes_.size(); i-- > 0;) {
      if (scopes_[i].live.is_there) return scopes_[i].live;
    }
    return {};
  }

  /// `mask`: the lanes that are here; all if it is not there.
  void region(const ShaderRegion& all, ShaderRegister mask) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ShaderNode& node = all[i];
      line_ = node.instruction.line;
      switch (node.kind) {
        case instruction: run(all, i, mask); break;
        case branch: run_branch(node, mask); break;
        case scope: run_scope(node, mask); break;
        case ShaderNodeKind::exit: run_exit(node, mask); break;
      }
    }
  }

  /// Whether some lanes may leave scopes around from within.
  bool some_leave(const ShaderRegion& region) const {
    return std::any_of(region.begin(), region.end(), [&](const ShaderNode& node) {
      if (node.kind == ShaderNodeKind::exit) {
        return std::any_of(scopes_.begin(), scopes_.end(), [&](const Scope& of) {
          return of.number == node.scope && of.live.is_there;
        });
      }
      return (node.first && some_leave(*node.first)) || (node.second && some_leave(*node.second));
    });
  }
  void drop_left(ShaderRegister mask, bool some_left) {
    const ShaderRegister live = innermost_live();
    if (!some_left || !mask.is_there || !live.is_there || mask.number == live.number) return;
    put_step(number_of(ShaderOp::bit_and), mask, mask, live);
  }

  /// Whether it is worth while to run it over fewer lanes.
  static bool is_long(const ShaderRegion& region) {
    constexpr std::size_t kLong = 8;
    return region.size() >= kLong ||
           std::any_of(region.begin(), region.end(),
                       [](const ShaderNode& node) { return node.kind != instruction; });
  }
  /// A register that does not vary holds it: it has a number for each lane of a vector.
  ShaderRegister keep_range() {
    const ShaderRegister range = new_register(false);
    put_step(number_of(StepOp::keep_range), range);
    return range;
  }

  void run_branch(const ShaderNode& node, ShaderRegister mask) {
    const ShaderRegister condition = of(node.instruction.a);
    const bool some_left = some_leave(*node.first) || some_leave(*node.second);
    if (!condition.varies) {
      const std::size_t over = here();
      put_step(number_of(StepOp::jump_if_false), {}, condition);
      region(*node.first, mask);
      if (node.second->empty()) {
        land(over);
      } else {
        const std::size_t out = here();
        put_step(number_of(StepOp::jump));
        land(over);
        region(*node.second, mask);
        land(out);
      }
      drop_left(mask, some_left);
      return;
    }
    ShaderRegister range;
    if (is_long(*node.first) || is_long(*node.second)) range = keep_range();
    for (int side = 0; side < 2; ++side) {
      const ShaderRegion& inner = side == 0 ? *node.first : *node.second;
      if (inner.empty()) continue;
      const ShaderRegister here_mask = mask_and(mask, condition, side == 1);
      const std::size_t over = here();
      const bool narrows = is_long(inner);
      put_step(number_of(StepOp::jump_if_none), {}, here_mask).count = narrows ? 1 : 0;
      region(inner, here_mask);
      land(over);
      if (narrows) put_step(number_of(StepOp::widen_range), {}, range);
    }
    drop_left(mask, some_left);
  }

  void run_scope(const ShaderNode& node, ShaderRegister mask) {
    scopes_.push_back({.number = node.scope});
    ShaderRegister inner = mask;
    if (varying_.scopes[node.scope]) {
      inner = scopes_.back().live = new_register(true);
      put_step(number_of(ShaderOp::copy), inner, mask.is_there ? mask : all_lanes());
    }
    ShaderRegister range;
    if (node.loops && inner.is_there) range = keep_range();
    const std::size_t begin = here();
    if (node.loops) {
      if (inner.is_there) {
        scopes_.back().jumps.push_back(here());
        put_step(number_of(StepOp::jump_if_none), {}, inner).count = 1;
      }
      put_step(number_of(StepOp::check_budget));
    }
    region(*node.first, inner);
    if (node.loops) put_step(number_of(StepOp::jump)).place = static_cast<std::uint32_t>(begin);
    const Scope done = std::move(scopes_.back());
    scopes_.pop_back();
    for (const std::size_t jump : done.jumps) land(jump);
    if (range.is_there) put_step(number_of(StepOp::widen_range), {}, range);
    drop_left(mask, some_leave(*node.first));
  }

  void run_exit(const ShaderNode& node, ShaderRegister mask) {
    if (!varying_.exits.contains(&node)) {  // by all lanes that run
      for (Scope& of : scopes_) {
        if (of.number != node.scope) continue;
        of.jumps.push_back(here());
        put_step(number_of(StepOp::jump));
        return;
      }
      return;
    }
    bool inside = false;
    for (Scope& of : scopes_) {
      inside = inside || of.number == node.scope;
      if (!inside || !of.live.is_there) continue;
      put_step(number_of(StepOp::and_not), of.live, of.live, mask.is_there ? mask : all_lanes());
    }
  }

  void run(const ShaderRegion& all, std::size_t at, ShaderRegister mask) {
    const ShaderInstruction& in = all[at].instruction;
    using enum ShaderOp;
    switch (in.op) {
      case store: {
        const ShaderRegister variable = of_variable(in.place);
        const bool everywhere = !mask.is_there || !variable.varies || is_local(all, at);
        if (everywhere) {
          put_step(number_of(copy), variable, of(in.a));
        } else {
          put_step(number_of(StepOp::masked_copy), variable, of(in.a), mask);
        }
        return;
      }
      case load: put_step(number_of(copy), of(in.to), of_variable(in.place)); return;
      case kill: {
        if (!to_.killed.is_there) to_.killed = new_register(true);
        put_step(number_of(bit_or), to_.killed, to_.killed, mask.is_there ? mask : all_lanes());
        return;
      }
      case input: to_.inputs.push_back({tree_.inputs[in.place], of(in.to)}); return;
      case sample: run_sample(in); return;
      case load_indexed: {
        ShaderStep& step = put_step(number_of(in.op), of(in.to), of(in.a), of_variable(in.place));
        step.count = in.count;
        step.stride = in.stride;
        return;
      }
      case load_constant: {
        ShaderStep& step = put_step(number_of(in.op), of(in.to), of(in.a));
        step.place = in.place;
        step.count = in.count;
        step.stride = in.stride;
        return;
      }
      case store_indexed: {
        ShaderStep& step = put_step(number_of(in.op), of_variable(in.place), of(in.a), of(in.b),
                                    mask.is_there ? mask : all_lanes());
        step.count = in.count;
        step.stride = in.stride;
        return;
      }
      default: put_step(number_of(in.op), of(in.to), of(in.a), of(in.b), of(in.c), of(in.d));
    }
  }

  void run_sample(const ShaderInstruction& in) {
    const ShaderSample& sample = tree_.samples[in.place];
    ShaderSampleRegisters made{.sample = sample,
                               .texture = of(sample.texture),
                               .sampler = of(sample.sampler),
                               .compared = of(sample.compared)};
    for (std::size_t i = 0; i < 4; ++i) made.at[i] = of(sample.at[i]);
    for (std::size_t i = 0; i < 6; ++i) made.more[i] = of(sample.more[i]);
    for (std::size_t i = 0; i < 3; ++i) made.offset[i] = of(sample.offset[i]);
    for (std::size_t i = 0; i < 4; ++i) made.to[i] = of(sample.to[i]);
    put_step(number_of(ShaderOp::sample)).place = static_cast<std::uint32_t>(to_.samples.size());
    to_.samples.push_back(made);
  }

  // --- what differences see in lanes that were never there ---

  /// A variable that the shader does not begin with a store by all lanes is 0 before: a block's
  /// other pixels may be asked for it, and would have what the batch before left.
  void begin_variables() {
    std::vector<bool> is_known(tree_.variable_count);
    begin_variables(tree_.main, is_known);
  }
  void begin_variables(const ShaderRegion& all, std::vector<bool>& is_known) {
    for (std::size_t at = 0; at < all.size(); ++at) {
      const ShaderInstruction& in = all[at].instruction;
      const bool is_access =
          all[at].kind == instruction && (in.op == ShaderOp::load || in.op == ShaderOp::store);
      if (is_access && !is_known[in.place]) {
        is_known[in.place] = true;
        const bool is_begun =
            in.op == ShaderOp::store && (&all == &tree_.main || is_local(all, at));
        if (!is_begun && varying_.variables[in.place]) {
          put_step(number_of(ShaderOp::copy), of_variable(in.place), constant(0));
        }
      }
      for (const auto* side : {&all[at].first, &all[at].second}) {
        if (*side) begin_variables(**side, is_known);
      }
    }
  }

  // --- stores that no other lane minds ---

  /// Where a variable is used: the innermost region around all its loads and stores, and the first.
  struct Home {
    const ShaderRegion* region = nullptr;
    const ShaderRegion* first_in = nullptr;
    std::size_t first = 0;
    bool is_everywhere = false;  ///< outputs, and what an index chooses from
  };
  struct Parent {
    const ShaderRegion* region = nullptr;
    int depth = 0;
  };
  std::vector<Home> homes_{};
  std::unordered_map<const ShaderRegion*, Parent> parents_{};

  /// A store with which a variable begins: all its other loads and stores are behind it in this
  /// region, or in regions inside it. What other lanes have in it is not read.
  bool is_local(const ShaderRegion& all, std::size_t at) {
    if (homes_.empty()) {
      homes_.resize(tree_.variable_count);
      for (const ShaderOutput& output : tree_.outputs) homes_[output.variable].is_everywhere = true;
      find_homes(tree_.main, {});
    }
    const Home& home = homes_[all[at].instruction.place];
    return !home.is_everywhere && home.region == &all && home.first_in == &all && home.first == at;
  }
  void find_homes(const ShaderRegion& region, Parent parent) {
    parents_[&region] = parent;
    for (std::size_t at = 0; at < region.size(); ++at) {
      const ShaderNode& node = region[at];
      const ShaderInstruction& in = node.instruction;
      if (node.kind == instruction) {
        if (in.op == ShaderOp::load || in.op == ShaderOp::store) use(in.place, region, at);
        if (in.op == ShaderOp::load_indexed || in.op == ShaderOp::store_indexed) {
          for (std::uint32_t i = 0; i < in.count; ++i) {
            homes_[in.place + i * in.stride].is_everywhere = true;
          }
        }
      }
      for (const auto* side : {&node.first, &node.second}) {
        if (*side) find_homes(**side, {&region, parent.depth + 1});
      }
    }
  }
  void use(ShaderVariable variable, const ShaderRegion& region, std::size_t at) {
    Home& home = homes_[variable];
    if (home.region == nullptr) {
      home.region = home.first_in = &region;
      home.first = at;
      return;
    }
    const ShaderRegion* other = &region;
    while (home.region != other) {
      const ShaderRegion*& deeper =
          parents_.at(home.region).depth > parents_.at(other).depth ? home.region : other;
      deeper = parents_.at(deeper).region;
    }
  }
};

}  // namespace

ShaderProgram emit_program(const ShaderTree& tree) {
  ShaderProgram program;
  Emitter emitter{tree, program};
  emitter.run();
  join_steps(program);
  share_registers(program, emitter.rows);
  return program;
}

}  // namespace softfocus
