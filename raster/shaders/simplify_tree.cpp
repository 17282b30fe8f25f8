#include "raster/shaders/simplify_tree.h"

#include <algorithm>
#include <utility>

namespace softfocus {
namespace {

using enum ShaderNodeKind;

bool has_exit_to(const ShaderRegion& region, std::uint32_t scope) {
  return std::any_of(region.begin(), region.end(), [&](const ShaderNode& node) {
    return (is_exit(node) && node.scope == scope) ||
           (node.first && has_exit_to(*node.first, scope)) ||
           (node.second && has_exit_to(*node.second, scope));
  });
}

// --- exits that are where a region ends anyway ---

using Scopes = std::vector<std::uint32_t>;

bool is_among(const Scopes& scopes, std::uint32_t scope) {
  return std::find(scopes.begin(), scopes.end(), scope) != scopes.end();
}

bool ends_with_exit(const ShaderRegion& region, const Scopes& to) {
  return !region.empty() && is_exit(region.back()) && is_among(to, region.back().scope);
}

/// `tails`: scopes that end where the region ends. `if (a) return; rest` becomes `if (a) {} else
/// rest`, and no lane needs to wait.
void settle_exits(ShaderRegion& region, const Scopes& tails, int depth) {
  constexpr int kDeepest = 100;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (is_exit(region[i])) region.resize(i + 1);
    if (i + 1 >= region.size() || region[i].kind != branch || depth > kDeepest) continue;
    const bool first = ends_with_exit(*region[i].first, tails);
    const bool second = ends_with_exit(*region[i].second, tails);
    if (!first && !second) continue;
    ShaderRegion rest(std::make_move_iterator(region.begin() + static_cast<std::ptrdiff_t>(i) + 1),
                      std::make_move_iterator(region.end()));
    region.resize(i + 1);
    if (!first || !second) append(first ? *region[i].second : *region[i].first, std::move(rest));
  }
  if (ends_with_exit(region, tails)) region.pop_back();
  for (std::size_t i = 0; i < region.size(); ++i) {
    ShaderNode& node = region[i];
    const bool is_last = i + 1 == region.size();
    if (node.kind == branch) {
      settle_exits(*node.first, is_last ? tails : Scopes{}, depth + 1);
      settle_exits(*node.second, is_last ? tails : Scopes{}, depth + 1);
    } else if (node.kind == scope) {
      Scopes inner = is_last && !node.loops ? tails : Scopes{};
      if (!node.loops) inner.push_back(node.scope);
      settle_exits(*node.first, inner, depth + 1);
    }
  }
  // A scope that nothing leaves early is part of its region.
  ShaderRegion flat;
  flat.reserve(region.size());
  for (ShaderNode& node : region) {
    if (node.kind == scope && !node.loops && !has_exit_to(*node.first, node.scope)) {
      append(flat, std::move(*node.first));
    } else {
      flat.push_back(std::move(node));
    }
  }
  region = std::move(flat);
}

// --- values that are used beyond the region that makes them ---

class Exports {
 public:
  explicit Exports(ShaderTree& tree) : tree_(tree), made_in_(tree.values.size(), kNowhere) {}

  void run() {
    find(tree_.main, 0);
    if (variable_of_.empty()) return;
    put(tree_.main, 0);
    ShaderRegion all;
    for (const auto& [value, variable] : variable_of_) {
      ShaderNode node;
      node.instruction.op = ShaderOp::store;
      node.instruction.place = variable;
      node.instruction.a = tree_.constant(0);
      all.push_back(std::move(node));
    }
    append(all, std::move(tree_.main));
    tree_.main = std::move(all);
  }

 private:
  static constexpr std::uint32_t kNowhere = 0xFFFFFFFF;
  ShaderTree& tree_;
  std::vector<std::uint32_t> made_in_;
  std::vector<std::uint32_t> parent_{0};
  std::unordered_map<ShaderValue, ShaderVariable> variable_of_{};
  std::uint32_t next_ = 1;

  bool reaches(ShaderValue value, std::uint32_t region) const {
    if (tree_.is_constant(value)) return true;
    const std::uint32_t from = made_in_[value];
    while (region != from && region != 0) region = parent_[region];
    return region == from;
  }
  void need(ShaderValue value, std::uint32_t region) {
    if (reaches(value, region)) return;
    variable_of_.try_emplace(value, tree_.variable_count);
    if (variable_of_.at(value) == tree_.variable_count) ++tree_.variable_count;
  }
  void find(ShaderRegion& region, std::uint32_t number) {
    for (ShaderNode& node : region) {
      if (node.kind == instruction) {
        for_each_operand(tree_, node.instruction, [&](ShaderValue of) { need(of, number); });
        for_each_result(tree_, node.instruction, [&](ShaderValue of) { made_in_[of] = number; });
        continue;
      }
      if (node.kind == branch) need(node.instruction.a, number);
      for (auto* side : {&node.first, &node.second}) {
        if (!*side) continue;
        parent_.push_back(number);
        find(**side, static_cast<std::uint32_t>(parent_.size()) - 1);
      }
    }
  }

  ShaderValue loaded(ShaderValue value, std::uint32_t region, ShaderRegion& to) {
    if (reaches(value, region)) return value;
    ShaderNode node;
    node.instruction.op = ShaderOp::load;
    node.instruction.place = variable_of_.at(value);
    node.instruction.to = tree_.new_value();
    made_in_.push_back(region);
    to.push_back(std::move(node));
    return static_cast<ShaderValue>(tree_.values.size() - 1);
  }
  void put(ShaderRegion& region, std::uint32_t number) {
    ShaderRegion to;
    to.reserve(region.size());
    for (ShaderNode& node : region) {
      if (node.kind == instruction) {
        for_each_operand(tree_, node.instruction,
                         [&](ShaderValue& of) { of = loaded(of, number, to); });
        const ShaderInstruction in = node.instruction;
        to.push_back(std::move(node));
        for_each_result(tree_, in, [&](ShaderValue of) {
          const auto found = variable_of_.find(of);
          if (found == variable_of_.end()) return;
          ShaderNode store;
          store.instruction.op = ShaderOp::store;
          store.instruction.place = found->second;
          store.instruction.a = of;
          to.push_back(std::move(store));
        });
        continue;
      }
      if (node.kind == branch) node.instruction.a = loaded(node.instruction.a, number, to);
      for (auto* side : {&node.first, &node.second}) {
        if (*side) put(**side, next_++);
      }
      to.push_back(std::move(node));
    }
    region = std::move(to);
  }
};

// --- what nothing needs ---

class Needs {
 public:
  explicit Needs(ShaderTree& tree)
      : tree_(tree), values_(tree.values.size()), variables_(tree.variable_count) {}

  void run() {
    for (const ShaderOutput& output : tree_.outputs) variables_[output.variable] = true;
    // Each time finds what a turn of a loop needs of the one before; none has so long a chain.
    constexpr int kMostTimes = 256;
    int times = 0;
    do {
      grew_ = false;
      find(tree_.main);
    } while (grew_ && ++times < kMostTimes);
    if (!grew_) remove(tree_.main);
    drop_overwritten(tree_.main);
  }

 private:
  ShaderTree& tree_;
  std::vector<bool> values_, variables_;
  bool grew_ = false;

  void need(ShaderValue value) {
    if (values_[value]) return;
    values_[value] = grew_ = true;
  }
  bool is_needed(const ShaderInstruction& in) const {
    if (in.op == ShaderOp::kill) return true;
    bool needed = false;
    for_each_stored(in, [&](ShaderVariable of) { needed = needed || variables_[of]; });
    for_each_result(tree_, in, [&](ShaderValue of) { needed = needed || values_[of]; });
    return needed;
  }
  void find(ShaderRegion& region) {
    for (std::size_t i = region.size(); i-- > 0;) {
      ShaderNode& node = region[i];
      if (node.kind == instruction && is_needed(node.instruction)) {
        ShaderInstruction& in = node.instruction;
        for_each_operand(tree_, in, [&](ShaderValue of) { need(of); });
        if (in.op == ShaderOp::load || in.op == ShaderOp::load_indexed) {
          for (std::uint32_t k = 0; k < std::max(1u, in.count); ++k) {
            const ShaderVariable of = in.place + k * in.stride;
            if (!variables_[of]) variables_[of] = grew_ = true;
          }
        }
      }
      if (node.kind == branch) need(node.instruction.a);
      if (node.second) find(*node.second);
      if (node.first) find(*node.first);
    }
  }
  void remove(ShaderRegion& region) {
    for (ShaderNode& node : region) {
      if (node.first) remove(*node.first);
      if (node.second) remove(*node.second);
    }
    std::erase_if(region, [&](const ShaderNode& node) {
      if (node.kind == instruction) return !is_needed(node.instruction);
      if (node.kind == branch) return node.first->empty() && node.second->empty();
      return node.kind == scope && !node.loops && node.first->empty();
    });
  }

  static bool may_read(const ShaderNode& node, ShaderVariable variable) {
    if (node.kind == ShaderNodeKind::exit) return true;  // who left may read it outside
    if (node.kind == instruction) {
      const ShaderInstruction& in = node.instruction;
      if (in.op == ShaderOp::load) return in.place == variable;
      return in.op == ShaderOp::load_indexed && variable >= in.place &&
             variable <= in.place + (in.count - 1) * in.stride;
    }
    const auto any = [&](const std::unique_ptr<ShaderRegion>& region) {
      return region && std::any_of(region->begin(), region->end(), [&](const ShaderNode& inner) {
               return may_read(inner, variable);
             });
    };
    return any(node.first) || any(node.second);
  }
  /// A store before another, with nothing between that reads.
  void drop_overwritten(ShaderRegion& region) {
    constexpr std::size_t kFarthest = 64;
    std::vector<bool> drops(region.size());
    for (std::size_t i = 0; i < region.size(); ++i) {
      if (region[i].kind != instruction || region[i].instruction.op != ShaderOp::store) continue;
      const ShaderVariable variable = region[i].instruction.place;
      for (std::size_t k = i + 1; k < std::min(region.size(), i + kFarthest); ++k) {
        if (may_read(region[k], variable)) break;
        if (region[k].kind == instruction && region[k].instruction.op == ShaderOp::store &&
            region[k].instruction.place == variable) {
          drops[i] = true;
          break;
        }
      }
    }
    std::size_t i = 0;
    std::erase_if(region, [&](const ShaderNode&) { return drops[i++]; });
    for (ShaderNode& node : region) {
      if (node.first) drop_overwritten(*node.first);
      if (node.second) drop_overwritten(*node.second);
    }
  }
};

}  // namespace

bool always_leaves(const ShaderRegion& region) {
  if (region.empty()) return false;
  const ShaderNode& last = region.back();
  if (is_exit(last)) return true;
  return last.kind == branch && always_leaves(*last.first) && always_leaves(*last.second);
}

void export_values(ShaderTree& tree) { Exports{tree}.run(); }

void simplify(ShaderTree& tree) {
  settle_exits(tree.main, {}, 0);
  export_values(tree);
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    forward_values(tree);
    Needs{tree}.run();
    settle_exits(tree.main, {}, 0);
  }
}

}  // namespace softfocus
