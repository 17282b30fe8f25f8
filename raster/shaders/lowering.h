#pragma once
// Lowering of one module: what lower_spirv.cpp (control flow), lower_instructions.cpp and
// lower_glsl.cpp share.

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "raster/shaders/lower_spirv.h"
#include "raster/shaders/shader_kernels.h"
#include "raster/shaders/simplify_tree.h"

namespace softfocus {

using Words = std::span<const std::uint32_t>;
using Scalars = std::vector<ShaderValue>;

inline constexpr std::size_t kMostNodes = std::size_t{1} << 20;
inline constexpr std::size_t kMostWork = std::size_t{1} << 22;
inline constexpr int kDeepestNodes = 200, kDeepestCalls = 64;

inline bool is_uniform(SpirvStorage storage) {
  return storage == SpirvStorage::uniform_constant || storage == SpirvStorage::uniform ||
         storage == SpirvStorage::push_constant;
}

/// What a pointer points to: numbers one after the other.
struct Place {
  enum class In : std::uint8_t { variables, uniforms, inputs, outputs } in{};
  SpirvId type = 0;         ///< of what is there
  std::uint32_t first = 0;  ///< number
  /// If it depends on an index: the numbers that may be meant begin at `first`, and `index`, which
  /// is from 0 to count - 1, counts `stride` of them.
  ShaderValue index = kNoValue;
  std::uint32_t count = 1, stride = 1;
};

struct Call {
  const SpirvFunction* function = nullptr;
  std::map<SpirvId, Scalars> values{};
  std::map<SpirvId, SpirvId> types{};  ///< of the values
  std::map<SpirvId, Place> places{};
  std::map<SpirvId, std::uint32_t> phis{};  ///< the first of the variables of each
  std::uint32_t scope = 0;
  std::uint32_t result = 0;  ///< the first variable of what is returned
  int depth = 0;
};

/// A label at which what is under way ends.
struct Target {
  SpirvId label = 0;
  std::uint32_t scope = 0;
  ShaderVariable falls = kNoValue;  ///< set instead of leaving: a switch's next case
};

class Lowering {
 public:
  Lowering(const SpirvModule& module, Words uniforms, ShaderTree& to)
      : module_(module), uniforms_(uniforms), tree_(to) {}

  void lower() {
    std::uint32_t first_uniform = 0;
    for (const auto& [id, variable] : module_.variables) {
      const std::uint32_t scalars = module_.pointed(variable.type).scalars;
      const SpirvId type = module_.type(variable.type).element;
      using enum SpirvStorage;
      if (is_uniform(variable.storage)) {
        globals_[id] = {Place::In::uniforms, type, first_uniform};
        first_uniform += scalars;
      } else if (variable.storage == input) {
        globals_[id] = {Place::In::inputs, type, static_cast<std::uint32_t>(tree_.inputs.size())};
        add_inputs(id, type, decorations_of(id));
      } else {
        globals_[id] = {Place::In::variables, type, new_variables(scalars)};
        set_initial(tree_.main, globals_[id].first, scalars, variable.initial);
        if (variable.storage == output) add_outputs(globals_[id].first, type, decorations_of(id));
      }
    }
    Call main{.function = &module_.functions.at(module_.main)};
    run_call(main, tree_.main);
  }

 private:
  const SpirvModule& module_;
  Words uniforms_;
  ShaderTree& tree_;
  std::map<SpirvId, Place> globals_{};
  std::vector<Target> targets_{};
  std::map<std::uint32_t, std::uint32_t> table_of_{};  ///< of uniforms from a number on
  std::map<SpirvId, std::uint32_t> constant_tables_{};
  std::size_t nodes_ = 0, work_ = 0;
  int depth_ = 0;
  std::uint32_t main_scope_ = 0;
  ShaderLine line_{};

  [[noreturn]] void refuse(const std::string& why) const {
    throw ShaderError(place_of(module_, line_) + why);
  }
  [[noreturn]] void damaged(const std::string& why) const {
    throw ShaderError(place_of(module_, line_) + "the SPIR-V is damaged: " + why);
  }

  const SpirvDecorations& decorations_of(SpirvId id) const {
    static const SpirvDecorations none;
    const auto found = module_.decorations.find(id);
    return found == module_.decorations.end() ? none : found->second;
  }
  const SpirvType& type(SpirvId id) const {
    const auto found = module_.types.find(id);
    if (found == module_.types.end()) damaged("a type is used that is not there");
    return found->second;
  }
  std::uint32_t scalars(SpirvId id) const { return type(id).scalars; }

  std::uint32_t new_variables(std::uint32_t count) {
    const std::uint32_t first = tree_.variable_count;
    tree_.variable_count += count;
    if (tree_.variable_count > 16 * kMostScalars) refuse("its variables hold too many numbers");
    return first;
  }

  // --- what main() is given and gives ---

  void add_inputs(SpirvId variable, SpirvId id, const SpirvDecorations& of) {
    const SpirvType& what = type(id);
    if (what.kind == SpirvKind::structure) {
      const SpirvDecorations& members = decorations_of(id);
      int location = of.location;
      for (std::size_t i = 0; i < what.members.size(); ++i) {
        SpirvDecorations member = i < members.members.size() ? members.members[i] : of;
        member.is_flat = member.is_flat || of.is_flat;
        member.is_linear = member.is_linear || of.is_linear;
        if (member.location < 0) member.location = location;
        add_inputs(variable, what.members[i], member);
        location = member.location + locations(what.members[i]);
      }
      return;
    }
    if (tree_.inputs.size() + what.scalars > kMostScalars) refuse("inputs have too many numbers");
    add_numbers(id, of, [&](int location, int component, int part) {
      tree_.inputs.push_back({of.builtin, location, component, part, of.is_flat, of.is_linear});
    });
  }
  void add_outputs(std::uint32_t first, SpirvId id, const SpirvDecorations& of) {
    const SpirvType& what = type(id);
    if (what.kind == SpirvKind::structure) {
      const SpirvDecorations& members = decorations_of(id);
      int location = of.location;
      for (std::size_t i = 0; i < what.members.size(); ++i) {
        SpirvDecorations member = i < members.members.size() ? members.members[i] : of;
        if (member.location < 0) member.location = location;
        add_outputs(first, what.members[i], member);
        location = member.location + locations(what.members[i]);
        first += scalars(what.members[i]);
      }
      return;
    }
    add_numbers(id, of, [&](int location, int component, int) {
      tree_.outputs.push_back({of.builtin, location, component, first++});
    });
  }
  int locations(SpirvId id) const {
    const SpirvType& what = type(id);
    if (what.kind == SpirvKind::array || what.kind == SpirvKind::matrix) {
      return static_cast<int>(what.count) * locations(what.element);
    }
    int sum = 0;
    for (const SpirvId member : what.members) sum += locations(member);
    return what.kind == SpirvKind::structure ? sum : 1;
  }
  /// add(location, component, part) for each scalar.
  template <class Add>
  void add_numbers(SpirvId id, const SpirvDecorations& of, const Add& add) {
    const auto count = static_cast<int>(scalars(id));
    const SpirvType* row = &type(id);
    while (row->kind == SpirvKind::array || row->kind == SpirvKind::matrix) {
      row = &type(row->element);
    }
    const int each = std::max(1, static_cast<int>(row->scalars));
    for (int i = 0; i < count; ++i) {
      add(of.location < 0 ? 0 : of.location + i / each, of.component + i % each, i);
    }
  }

  // --- nodes ---

  /// Counts what takes time or memory and makes no nodes.
  void work(std::size_t amount) {
    work_ += amount;
    if (work_ > kMostWork) refuse("the shader is too long");
  }
  ShaderNode& add_node(ShaderRegion& to, ShaderNodeKind kind) {
    if (++nodes_ > kMostNodes) {
      refuse("the shader is too long: more than " + std::to_string(kMostNodes) + " instructions");
    }
    to.push_back({.kind = kind});
    to.back().instruction.line = line_;
    return to.back();
  }
  ShaderInstruction& add(ShaderRegion& to, ShaderOp op) {
    ShaderNode& node = add_node(to, ShaderNodeKind::instruction);
    node.instruction.op = op;
    return node.instruction;
  }

  ShaderValue constant(float value) { return tree_.constant(std::bit_cast<std::uint32_t>(value)); }
  ShaderValue whole(std::uint32_t value) { return tree_.constant(value); }

  ShaderValue make(ShaderRegion& to, ShaderOp op, ShaderValue a, ShaderValue b = kNoValue,
                   ShaderValue c = kNoValue) {
    const auto known = [&](ShaderValue v) { return v == kNoValue || tree_.is_constant(v); };
    const auto bits = [&](ShaderValue v) { return v == kNoValue ? 0u : tree_.bits(v); };
    if (known(a) && known(b) && known(c) && op < ShaderOp::derivative_x) {
      return tree_.constant(fold_shader_op(op, bits(a), bits(b), bits(c)));
    }
    ShaderInstruction& in = add(to, op);
    in.a = a;
    in.b = b;
    in.c = c;
    in.to = tree_.new_value();
    return in.to;
  }
  void set(ShaderRegion& to, ShaderVariable variable, ShaderValue value) {
    ShaderInstruction& in = add(to, ShaderOp::store);
    in.place = variable;
    in.a = value;
  }
  ShaderValue get(ShaderRegion& to, ShaderVariable variable) {
    ShaderInstruction& in = add(to, ShaderOp::load);
    in.place = variable;
    in.to = tree_.new_value();
    return in.to;
  }
  void set_initial(ShaderRegion& to, std::uint32_t first, std::uint32_t count, SpirvId initial) {
    const std::vector<std::uint32_t>* words =
        initial == 0 ? nullptr : &module_.constants.at(initial).words;
    for (std::uint32_t i = 0; i < count; ++i) {
      set(to, first + i, whole(words == nullptr ? 0 : (*words)[i]));
    }
  }

  // --- memory ---

  ShaderValue load_one(ShaderRegion& to, const Place& at, std::uint32_t number) {
    const std::uint32_t place = at.first + number;
    const bool is_known = at.index == kNoValue;
    using enum Place::In;
    if (at.in == uniforms && is_known) return whole(uniforms_[place]);
    if (at.in == variables && is_known) return get(to, place);
    if (at.in == inputs) return load_input(to, at, place);
    ShaderInstruction& in =
        add(to, at.in == uniforms ? ShaderOp::load_constant : ShaderOp::load_indexed);
    in.place = at.in == uniforms ? place + uniform_table() : place;
    in.a = at.index;
    in.count = at.count;
    in.stride = at.stride;
    work(at.count);
    in.to = tree_.new_value();
    return in.to;
  }
  /// By an index that is not known, all that it may mean are taken.
  ShaderValue load_input(ShaderRegion& to, const Place& at, std::uint32_t place) {
    const auto input = [&](std::uint32_t number) {
      ShaderInstruction& in = add(to, ShaderOp::input);
      in.place = number;
      return in.to = tree_.new_value();
    };
    ShaderValue chosen = input(place);
    if (at.index == kNoValue) return chosen;
    const ShaderValue index = clamped(to, at.index, at.count);
    for (std::uint32_t i = 1; i < at.count; ++i) {
      const ShaderValue is = make(to, ShaderOp::equal_integers, index, whole(i));
      chosen = make(to, ShaderOp::select, is, input(place + i * at.stride), chosen);
    }
    return chosen;
  }
  /// Where the uniforms lie among the tables.
  std::uint32_t uniform_table() {
    const auto [at, is_new] =
        table_of_.try_emplace(0, static_cast<std::uint32_t>(tree_.tables.size()));
    if (is_new) tree_.tables.insert(tree_.tables.end(), uniforms_.begin(), uniforms_.end());
    return at->second;
  }

  Scalars load(ShaderRegion& to, const Place& at) {
    Scalars values(scalars(at.type));
    for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = load_one(to, at, i);
    return values;
  }
  void store(ShaderRegion& to, const Place& at, const Scalars& values) {
    if (at.in != Place::In::variables) damaged("what cannot be written is written");
    for (std::uint32_t i = 0; i < values.size(); ++i) {
      if (at.index == kNoValue) {
        set(to, at.first + i, values[i]);
        continue;
      }
      ShaderInstruction& in = add(to, ShaderOp::store_indexed);
      in.place = at.first + i;
      in.a = at.index;
      in.b = values[i];
      in.count = at.count;
      in.stride = at.stride;
      work(at.count);
    }
  }

  /// An index as a whole number from 0 to count - 1.
  ShaderValue clamped(ShaderRegion& to, ShaderValue index, std::uint32_t count) {
    const ShaderValue from_0 = make(to, ShaderOp::maximum_signed, index, whole(0));
    return make(to, ShaderOp::minimum_signed, from_0, whole(count - 1));
  }

  Place chain(ShaderRegion& to, Place at, const std::vector<ShaderValue>& indices) {
    for (const ShaderValue index : indices) {
      const SpirvType& of = type(at.type);
      const bool is_known = tree_.is_constant(index);
      if (of.kind == SpirvKind::structure) {
        if (!is_known || tree_.bits(index) >= of.members.size()) {
          damaged("a structure has no such member");
        }
        for (std::uint32_t i = 0; i < tree_.bits(index); ++i) at.first += scalars(of.members[i]);
        at.type = of.members[tree_.bits(index)];
        continue;
      }
      if (of.kind != SpirvKind::array && of.kind != SpirvKind::vector &&
          of.kind != SpirvKind::matrix) {
        damaged("an index chooses from what has no parts");
      }
      const std::uint32_t each = scalars(of.element);
      at.type = of.element;
      if (is_known) {
        const auto number = static_cast<std::int32_t>(tree_.bits(index));
        at.first += each * static_cast<std::uint32_t>(
                               std::clamp(number, 0, static_cast<std::int32_t>(of.count) - 1));
      } else if (at.index == kNoValue) {
        at.index = index;
        at.count = of.count;
        at.stride = each;
      } else {
        // Both as one index that counts numbers.
        const ShaderValue outer = make(to, ShaderOp::multiply_integers,
                                       clamped(to, at.index, at.count), whole(at.stride));
        const ShaderValue inner =
            make(to, ShaderOp::multiply_integers, clamped(to, index, of.count), whole(each));
        at.index = make(to, ShaderOp::add_integers, outer, inner);
        at.count = (at.count - 1) * at.stride + (of.count - 1) * each + 1;
        at.stride = 1;
      }
    }
    return at;
  }

  // --- values and places of ids ---

  Scalars value(ShaderRegion&, Call& call, SpirvId id) {
    if (const auto found = call.values.find(id); found != call.values.end()) {
      work(found->second.size());
      return found->second;
    }
    if (const auto found = module_.constants.find(id); found != module_.constants.end()) {
      Scalars values;
      values.reserve(found->second.words.size());
      work(found->second.words.size());
      for (const std::uint32_t word : found->second.words) values.push_back(whole(word));
      return values;
    }
    damaged("a value is used where it is not there");
  }
  SpirvId type_of(const Call& call, SpirvId id) const {
    if (const auto found = call.types.find(id); found != call.types.end()) return found->second;
    if (const auto found = module_.constants.find(id); found != module_.constants.end()) {
      return found->second.type;
    }
    damaged("a value is used where it is not there");
  }
  ShaderValue scalar(ShaderRegion& to, Call& call, SpirvId id) {
    const Scalars values = value(to, call, id);
    if (values.size() != 1) damaged("a scalar is none");
    return values[0];
  }
  Place place(Call& call, SpirvId id) {
    if (const auto found = call.places.find(id); found != call.places.end()) return found->second;
    if (const auto found = globals_.find(id); found != globals_.end()) return found->second;
    damaged("a pointer is used that is not there");
  }

  // --- functions ---

  void run_call(Call& call, ShaderRegion& to) {
    if (call.depth > kDeepestCalls) refuse("functions call each other too deeply, or themselves");
    for (const SpirvVariable& variable : call.function->variables) {
      const SpirvId of = type(variable.type).element;
      const Place at{Place::In::variables, of, new_variables(scalars(of))};
      set_initial(to, at.first, scalars(of), variable.initial);
      call.places[variable.id] = at;
    }
    for (const SpirvBlock& block : call.function->blocks) {
      work(block.instructions.size());
      for (const SpirvInstruction& in : block.instructions) {
        if (in.op != SpirvOp::phi) continue;
        call.phis[in.result] = new_variables(scalars(in.type));
      }
    }
    call.result = new_variables(scalars(call.function->returns));
    call.scope = tree_.scope_count++;
    if (call.depth == 0) main_scope_ = call.scope;
    const std::vector<Target> outside = std::exchange(targets_, {});
    ShaderRegion body;
    walk(call, call.function->blocks.front().label, body, 0);
    targets_ = outside;
    ShaderNode& node = add_node(to, ShaderNodeKind::scope);
    node.scope = call.scope;
    node.first = std::make_unique<ShaderRegion>(std::move(body));
  }

  // --- control flow ---

  const SpirvBlock& block_of(const Call& call, SpirvId label) const {
    return call.function->blocks[call.function->block_of.at(label)];
  }

  /// Hands the phis of a block what comes from another.
  void hand_phis(Call& call, SpirvId from, SpirvId label, ShaderRegion& to) {
    for (const SpirvInstruction& in : block_of(call, label).instructions) {
      if (in.op != SpirvOp::phi) break;
      work(in.operands.size());
      for (std::size_t i = 0; i + 1 < in.operands.size(); i += 2) {
        if (in.operands[i + 1] != from) continue;
        const Scalars values = value(to, call, in.operands[i]);
        if (values.size() != scalars(in.type)) damaged("a phi joins two types");
        for (std::uint32_t k = 0; k < values.size(); ++k) {
          set(to, call.phis.at(in.result) + k, values[k]);
        }
      }
    }
  }

  const Target* target_of(SpirvId label) const {
    for (std::size_t i = targets_.size(); i-- > 0;) {
      if (targets_[i].label == label) return &targets_[i];
    }
    return nullptr;
  }

  /// Goes from one block to another: to the region's natural end, out of a scope, or on.
  void go(Call& call, SpirvId from, SpirvId label, ShaderRegion& to, SpirvId natural) {
    hand_phis(call, from, label, to);
    if (label == natural) return;
    if (leave(label, to)) return;
    walk(call, label, to, natural);
  }
  bool leave(SpirvId label, ShaderRegion& to) {
    const Target* target = target_of(label);
    if (target == nullptr) return false;
    if (target->falls != kNoValue) set(to, target->falls, whole(~0u));
    add_node(to, ShaderNodeKind::exit).scope = target->scope;
    return true;
  }

  ShaderNode branch_node(ShaderValue condition, ShaderRegion first, ShaderRegion second) {
    ShaderNode node{.kind = ShaderNodeKind::branch};
    node.instruction.a = condition;
    node.instruction.line = line_;
    node.first = std::make_unique<ShaderRegion>(std::move(first));
    node.second = std::make_unique<ShaderRegion>(std::move(second));
    ++nodes_;
    return node;
  }
  ShaderNode scope_node(std::uint32_t scope, bool loops, ShaderRegion body) {
    ShaderNode node{.kind = ShaderNodeKind::scope, .scope = scope, .loops = loops};
    node.instruction.line = line_;
    node.first = std::make_unique<ShaderRegion>(std::move(body));
    ++nodes_;
    return node;
  }

  void walk(Call& call, SpirvId label, ShaderRegion& to, SpirvId natural) {
    if (++depth_ > kDeepestNodes) refuse("the shader is nested too deeply");
    while (label != 0) {
      const SpirvBlock& block = block_of(call, label);
      work(block.instructions.size());
      if (block.continues != 0) {
        loop(call, block, to);
        label = block.merge;
        if (label == natural || leave(label, to)) break;
      } else {
        run_block(call, block, to);
        label = run_end(call, block, to, natural);
      }
    }
    --depth_;
  }

  void loop(Call& call, const SpirvBlock& header, ShaderRegion& to) {
    const std::uint32_t outer = tree_.scope_count++, inner = tree_.scope_count++;
    targets_.push_back({header.merge, outer});
    targets_.push_back({header.continues, inner});
    ShaderRegion body;
    run_block(call, header, body);
    const SpirvId next = run_end(call, header, body, header.continues, true);
    if (next != 0) walk(call, next, body, header.continues);
    targets_.pop_back();
    ShaderRegion turn;
    turn.push_back(scope_node(inner, false, std::move(body)));
    if (header.continues != header.label) walk(call, header.continues, turn, header.label);
    targets_.pop_back();
    to.push_back(scope_node(outer, true, std::move(turn)));
  }

  /// Ends a block. The block to go on with in the same region, or 0.
  SpirvId run_end(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural,
                  bool is_header = false) {
    const SpirvInstruction& in = block.instructions.back();
    line_ = in.line;
    const Words& w = in.operands;
    using enum SpirvOp;
    switch (in.op) {
      case SpirvOp::branch:
        hand_phis(call, block.label, w[0], to);
        if (w[0] == natural || leave(w[0], to)) return 0;
        return w[0];
      case branch_conditional: return run_condition(call, block, to, natural, is_header);
      case switch_case: return run_switch(call, block, to, natural);
      case return_value: {
        const Scalars values = value(to, call, w[0]);
        if (values.size() != scalars(call.function->returns))
          damaged("a function returns another type");
        for (std::uint32_t i = 0; i < values.size(); ++i) set(to, call.result + i, values[i]);
        add_node(to, ShaderNodeKind::exit).scope = call.scope;
        return 0;
      }
      case kill:
      case terminate_invocation:
        add(to, ShaderOp::kill);
        add_node(to, ShaderNodeKind::exit).scope = main_scope_;
        return 0;
      default: add_node(to, ShaderNodeKind::exit).scope = call.scope; return 0;
    }
  }

  SpirvId run_condition(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural,
                        bool is_header) {
    const Words& w = block.instructions.back().operands;
    const ShaderValue condition = scalar(to, call, w[0]);
    const SpirvId yes = w[1], no = w[2];
    if (block.merge != 0 && !is_header) {
      // Its merge is where both sides end; from further inside it may be left, too.
      const std::uint32_t scope = tree_.scope_count++;
      targets_.push_back({block.merge, scope});
      ShaderRegion first, second;
      go(call, block.label, yes, first, block.merge);
      go(call, block.label, no, second, block.merge);
      targets_.pop_back();
      ShaderRegion body;
      body.push_back(branch_node(condition, std::move(first), std::move(second)));
      to.push_back(scope_node(scope, false, std::move(body)));
      return block.merge == natural || leave(block.merge, to) ? 0 : block.merge;
    }
    const bool leaves_yes = yes != natural && target_of(yes) != nullptr;
    const bool leaves_no = no != natural && target_of(no) != nullptr;
    ShaderRegion first, second;
    if (leaves_yes != leaves_no) {
      hand_phis(call, block.label, yes, first);
      hand_phis(call, block.label, no, second);
      leave(leaves_yes ? yes : no, leaves_yes ? first : second);
      to.push_back(branch_node(condition, std::move(first), std::move(second)));
      const SpirvId next = leaves_yes ? no : yes;
      return next == natural ? 0 : next;
    }
    if (yes == no) {
      hand_phis(call, block.label, yes, to);
      if (yes == natural || leave(yes, to)) return 0;
      return yes;
    }
    const auto ends = [&](SpirvId label) {
      return label == natural || target_of(label) != nullptr;
    };
    if (!ends(yes) && !ends(no)) refuse("control flow is not structured: a branch has no merge");
    go(call, block.label, yes, first, natural);
    go(call, block.label, no, second, natural);
    to.push_back(branch_node(condition, std::move(first), std::move(second)));
    return 0;
  }

  // --- switch ---

  /// The cases that a case's blocks may go to.
  std::set<SpirvId> reach(const Call& call, SpirvId begin, SpirvId merge,
                          const std::vector<SpirvId>& cases) {
    std::set<SpirvId> seen{begin}, found;
    std::vector<SpirvId> next{begin};
    while (!next.empty()) {
      const SpirvId label = next.back();
      next.pop_back();
      if (label == merge || target_of(label) != nullptr) continue;
      const SpirvInstruction& in = block_of(call, label).instructions.back();
      const auto go_on = [&](SpirvId to) {
        work(cases.size());
        if (std::find(cases.begin(), cases.end(), to) != cases.end()) {
          found.insert(to);
        } else if (seen.insert(to).second) {
          next.push_back(to);
        }
      };
      const Words& w = in.operands;
      if (in.op == SpirvOp::branch) go_on(w[0]);
      if (in.op == SpirvOp::branch_conditional) {
        go_on(w[1]);
        go_on(w[2]);
      }
      if (in.op == SpirvOp::switch_case) {
        for (std::size_t i = 1; i < w.size(); i += 2) go_on(w[i]);
      }
    }
    return found;
  }

  SpirvId run_switch(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural) {
    const Words& w = block.instructions.back().operands;
    if (block.merge == 0) refuse("control flow is not structured: a switch has no merge");
    const ShaderValue selector = scalar(to, call, w[0]);
    // Cases by label, the default's with those values that no case has.
    std::vector<SpirvId> labels;
    std::map<SpirvId, ShaderValue> chosen;
    ShaderValue any = whole(0);
    for (std::size_t i = 2; i + 1 < w.size(); i += 2) {
      const ShaderValue is = make(to, ShaderOp::equal_integers, selector, whole(w[i]));
      any = make(to, ShaderOp::bit_or, any, is);
      const auto [at, is_new] = chosen.try_emplace(w[i + 1], is);
      if (is_new) {
        labels.push_back(w[i + 1]);
      } else {
        at->second = make(to, ShaderOp::bit_or, at->second, is);
      }
    }
    const ShaderValue none = make(to, ShaderOp::bit_not, any);
    const auto [of_default, is_new] = chosen.try_emplace(w[1], none);
    if (is_new) {
      labels.push_back(w[1]);
    } else {
      of_default->second = make(to, ShaderOp::bit_or, of_default->second, none);
    }
    const std::uint32_t scope = tree_.scope_count++;
    targets_.push_back({block.merge, scope});
    const std::map<SpirvId, ShaderVariable> outer = std::exchange(falls_, {});
    ShaderRegion body;
    // Phis have what the switch hands them before a case falls into another, which has its own.
    for (const SpirvId label : labels) hand_phis(call, block.label, label, body);
    for (const SpirvId label : in_order(call, labels, block.merge)) {
      run_case(call, label, labels, chosen.at(label), scope, body);
    }
    targets_.pop_back();
    falls_ = outer;
    to.push_back(scope_node(scope, false, std::move(body)));
    return block.merge == natural || leave(block.merge, to) ? 0 : block.merge;
  }

  /// A case before the one that it falls into.
  std::vector<SpirvId> in_order(const Call& call, const std::vector<SpirvId>& labels,
                                SpirvId merge) {
    std::vector<SpirvId> order;
    std::map<SpirvId, std::set<SpirvId>> falls;
    for (const SpirvId label : labels) {
      if (label != merge) falls[label] = reach(call, label, merge, labels);
    }
    std::vector<SpirvId> left = labels;
    left.erase(std::remove(left.begin(), left.end(), merge), left.end());
    while (!left.empty()) {
      const auto next = std::find_if(left.begin(), left.end(), [&](SpirvId label) {
        return std::none_of(left.begin(), left.end(), [&](SpirvId other) {
          work(1);
          return other != label && falls[other].contains(label);
        });
      });
      if (next == left.end()) refuse("control flow is not structured: cases fall in a circle");
      order.push_back(*next);
      left.erase(next);
    }
    return order;
  }

  std::map<SpirvId, ShaderVariable> falls_{};

  /// A case's body is a scope of its own, which is left to fall into the next.
  void run_case(Call& call, SpirvId label, const std::vector<SpirvId>& labels, ShaderValue chosen,
                std::uint32_t scope, ShaderRegion& to) {
    const SpirvId merge = targets_.back().label;
    if (ShaderRegion first; leave(label, first)) {  // a case that breaks or continues a loop
      to.push_back(branch_node(chosen, std::move(first), {}));
      return;
    }
    const auto falls_in = falls_.find(label);
    if (falls_in != falls_.end()) {
      chosen = make(to, ShaderOp::bit_or, chosen, get(to, falls_in->second));
    }
    const std::uint32_t own = tree_.scope_count++;
    const std::size_t before = targets_.size();
    work(labels.size());
    for (const SpirvId other : labels) {
      if (other == label || other == merge) continue;
      const auto [at, is_new] = falls_.try_emplace(other, kNoValue);
      if (is_new) {
        at->second = new_variables(1);
        set(tree_.main, at->second, whole(0));
      }
      targets_.push_back({other, own, at->second});
    }
    ShaderRegion body;
    if (falls_in != falls_.end()) set(body, falls_in->second, whole(0));
    walk(call, label, body, merge);
    targets_.resize(before);
    // What ends naturally goes to the switch's end.
    if (!always_leaves(body)) add_node(body, ShaderNodeKind::exit).scope = scope;
    ShaderRegion first;
    first.push_back(scope_node(own, false, std::move(body)));
    to.push_back(branch_node(chosen, std::move(first), {}));
  }

  // --- instructions ---

  void run_block(Call& call, const SpirvBlock& block, ShaderRegion& to) {
    for (std::size_t i = 0; i + 1 < block.instructions.size(); ++i) {
      const SpirvInstruction& in = block.instructions[i];
      line_ = in.line;
      run(call, in, to);
    }
  }

  std::vector<ShaderValue> indices(ShaderRegion& to, Call& call, Words ids) {
    std::vector<ShaderValue> made;
    made.reserve(ids.size());
    for (const SpirvId id : ids) made.push_back(scalar(to, call, id));
    return made;
  }

  static std::uint32_t word(Words w, std::size_t at) {
    if (at >= w.size()) throw ShaderError("the SPIR-V is damaged: an instruction is cut short");
    return w[at];
  }

  void run(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
    const Words& w = in.operands;
    using enum SpirvOp;
    switch (in.op) {
      case SpirvOp::store:
      case copy_memory: {
        const Place at = place(call, word(w, 0));
        const Scalars values = in.op == copy_memory ? this->load(to, place(call, word(w, 1)))
                                                    : value(to, call, word(w, 1));
        if (values.size() != scalars(at.type)) damaged("another type is stored");
        this->store(to, at, values);
        return;
      }
      case access_chain:
      case in_bounds_access_chain: {
        if (w.empty()) damaged("an instruction is cut short");
        const Place at = chain(to, place(call, w[0]), indices(to, call, w.subspan(1)));
        if (at.type != type(in.type).element) damaged("a pointer points to another type");
        call.places[in.result] = at;
        return;
      }
      case demote_to_helper_invocation: add(to, ShaderOp::kill); return;
      case copy_object:
        if (type(in.type).kind == SpirvKind::pointer) {
          call.places[in.result] = place(call, word(w, 0));
          return;
        }
        break;
      default: break;
    }
    Scalars made = result(call, in, to);
    if (made.size() != scalars(in.type)) damaged("a result is not of its type");
    call.values[in.result] = std::move(made);
    call.types[in.result] = in.type;
  }

  Scalars result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars vector_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars matrix_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars numbers_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars call_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars sample_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars glsl_result(Call& call, const SpirvInstruction& in, ShaderRegion& to);
  Scalars glsl_vectors(GlslOp op, const std::vector<Scalars>& of, ShaderRegion& to);
  Scalars glsl_packs(GlslOp op, const Scalars& a, ShaderRegion& to);
  Scalars glsl_pointers(Call& call, const SpirvInstruction& in, GlslOp op, ShaderRegion& to);
  ShaderValue glsl_scalar(GlslOp op, ShaderValue a, ShaderValue b, ShaderValue c, ShaderRegion& to);
  Scalars inverse(const Scalars& m, std::uint32_t n, ShaderRegion& to);
  ShaderValue determinant(const Scalars& m, std::uint32_t n, ShaderRegion& to);

  /// ((a0 b0 + a1 b1) + a2 b2) + a3 b3
  ShaderValue dot(ShaderRegion& to, const Scalars& a, const Scalars& b) {
    if (a.size() != b.size() || a.empty()) damaged("vectors of two lengths are multiplied");
    ShaderValue sum = make(to, ShaderOp::multiply, a[0], b[0]);
    for (std::size_t i = 1; i < a.size(); ++i) {
      sum = make(to, ShaderOp::add, sum, make(to, ShaderOp::multiply, a[i], b[i]));
    }
    return sum;
  }
  Scalars part(const Scalars& all, std::uint32_t first, std::uint32_t count) const {
    if (std::size_t{first} + count > all.size()) damaged("a part lies beyond its whole");
    return {all.begin() + first, all.begin() + first + count};
  }
};

}  // namespace softfocus
