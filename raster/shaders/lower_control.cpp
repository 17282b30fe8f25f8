// Control flow as SPIR-V has it, structured by merges, becomes regions, branches and scopes
// (shader_ir.h).

#include <algorithm>
#include <set>
#include <utility>

#include "raster/shaders/lowering.h"
#include "raster/shaders/simplify_tree.h"

namespace softfocus {

void Lowering::run_call(Call& call, ShaderRegion& to) {
  if (call.depth > kDeepestCalls) refuse("functions call each other too deeply, or themselves");
  for (const SpirvVariable& variable : call.function->variables) {
    const SpirvId of = type(variable.type).element;
    const Pointee at{Pointee::In::variables, of, new_variables(scalars(of))};
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

void Lowering::hand_phis(Call& call, SpirvId from, SpirvId label, ShaderRegion& to) {
  for (const SpirvInstruction& in : block_of(call, label).instructions) {
    if (in.op != SpirvOp::phi) break;
    work(in.operands.size());
    for (std::size_t i = 0; i + 1 < in.operands.size(); i += 2) {
      if (in.operands[i + 1] != from) continue;
      const Scalars values = value(call, in.operands[i]);
      if (values.size() != scalars(in.type)) damaged("a phi joins two types");
      for (std::uint32_t k = 0; k < values.size(); ++k) {
        set(to, call.phis.at(in.result) + k, values[k]);
      }
    }
  }
}

const Target* Lowering::target_of(SpirvId label) const {
  for (std::size_t i = targets_.size(); i-- > 0;) {
    if (targets_[i].label == label) return &targets_[i];
  }
  return nullptr;
}

void Lowering::go(Call& call, SpirvId from, SpirvId label, ShaderRegion& to, SpirvId natural) {
  hand_phis(call, from, label, to);
  if (label == natural) return;
  if (leave(label, to)) return;
  walk(call, label, to, natural);
}

bool Lowering::leave(SpirvId label, ShaderRegion& to) {
  const Target* target = target_of(label);
  if (target == nullptr) return false;
  if (target->falls != kNoValue) set(to, target->falls, whole(~0u));
  add_node(to, ShaderNodeKind::exit).scope = target->scope;
  return true;
}

ShaderNode Lowering::branch_node(ShaderValue condition, ShaderRegion first, ShaderRegion second) {
  ShaderNode node{.kind = ShaderNodeKind::branch};
  node.instruction.a = condition;
  node.instruction.line = line_;
  node.first = std::make_unique<ShaderRegion>(std::move(first));
  node.second = std::make_unique<ShaderRegion>(std::move(second));
  ++nodes_;
  return node;
}

ShaderNode Lowering::scope_node(std::uint32_t scope, bool loops, ShaderRegion body) {
  ShaderNode node{.kind = ShaderNodeKind::scope, .scope = scope, .loops = loops};
  node.instruction.line = line_;
  node.first = std::make_unique<ShaderRegion>(std::move(body));
  ++nodes_;
  return node;
}

void Lowering::walk(Call& call, SpirvId label, ShaderRegion& to, SpirvId natural) {
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

void Lowering::loop(Call& call, const SpirvBlock& header, ShaderRegion& to) {
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

SpirvId Lowering::run_end(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural,
                          bool is_header) {
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
      const Scalars values = value(call, w[0]);
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

SpirvId Lowering::run_condition(Call& call, const SpirvBlock& block, ShaderRegion& to,
                                SpirvId natural, bool is_header) {
  const Words& w = block.instructions.back().operands;
  const ShaderValue condition = scalar(call, w[0]);
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
  const auto ends = [&](SpirvId label) { return label == natural || target_of(label) != nullptr; };
  if (!ends(yes) && !ends(no)) refuse("control flow is not structured: a branch has no merge");
  go(call, block.label, yes, first, natural);
  go(call, block.label, no, second, natural);
  to.push_back(branch_node(condition, std::move(first), std::move(second)));
  return 0;
}

std::set<SpirvId> Lowering::reach(const Call& call, SpirvId begin, SpirvId merge,
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

SpirvId Lowering::run_switch(Call& call, const SpirvBlock& block, ShaderRegion& to,
                             SpirvId natural) {
  const Words& w = block.instructions.back().operands;
  if (block.merge == 0) refuse("control flow is not structured: a switch has no merge");
  const ShaderValue selector = scalar(call, w[0]);
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

std::vector<SpirvId> Lowering::in_order(const Call& call, const std::vector<SpirvId>& labels,
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

void Lowering::run_case(Call& call, SpirvId label, const std::vector<SpirvId>& labels,
                        ShaderValue chosen, std::uint32_t scope, ShaderRegion& to) {
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

void Lowering::run_block(Call& call, const SpirvBlock& block, ShaderRegion& to) {
  for (std::size_t i = 0; i + 1 < block.instructions.size(); ++i) {
    const SpirvInstruction& in = block.instructions[i];
    line_ = in.line;
    run(call, in, to);
  }
}

void Lowering::run(Call& call, const SpirvInstruction& in, ShaderRegion& to) {
  const Words& w = in.operands;
  using enum SpirvOp;
  switch (in.op) {
    case SpirvOp::store:
    case copy_memory: {
      const Pointee at = place(call, word(w, 0));
      const Scalars values =
          in.op == copy_memory ? this->load(to, place(call, word(w, 1))) : value(call, word(w, 1));
      if (values.size() != scalars(at.type)) damaged("another type is stored");
      this->store(to, at, values);
      return;
    }
    case access_chain:
    case in_bounds_access_chain: {
      if (w.empty()) damaged("an instruction is cut short");
      const Pointee at = chain(to, place(call, w[0]), indices(call, w.subspan(1)));
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
  if (module_.has_doubles) made = words_of(made);
  if (made.size() != scalars(in.type)) damaged("a result is not of its type");
  call.values[in.result] = std::move(made);
  call.types[in.result] = in.type;
}

}  // namespace softfocus
