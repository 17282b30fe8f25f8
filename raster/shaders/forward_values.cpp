// What variables hold, what is known and what was made before take the place of loads and of
// instructions that make the same.

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>
#include <vector>

#include "raster/shaders/shader_kernels.h"
#include "raster/shaders/simplify_tree.h"

namespace softfocus {
namespace {

struct ValueKey {
  ShaderOp op;
  ShaderValue a, b, c, d;
  bool operator==(const ValueKey&) const = default;
};
struct ValueKeyHash {
  std::size_t operator()(const ValueKey& key) const {
    std::uint64_t h = static_cast<std::uint64_t>(key.op);
    for (const ShaderValue of : {key.a, key.b, key.c, key.d}) h = (h ^ of) * 0x9E3779B97F4A7C15u;
    return static_cast<std::size_t>(h ^ h >> 29);
  }
};

bool swaps(ShaderOp op) {
  using enum ShaderOp;
  return op == add || op == multiply || op == add_integers || op == multiply_integers ||
         op == bit_and || op == bit_or || op == bit_xor || op == equal || op == not_equal ||
         op == equal_integers;
}

class Forwarding {
 public:
  explicit Forwarding(ShaderTree& tree)
      : tree_(tree), known_(tree.variable_count, kNoValue), loop_of_(tree.values.size(), 0) {
    for (ShaderValue i = 0; i < tree.values.size(); ++i) same_.push_back(i);
  }

  void run() {
    run(tree_.main);
    append(inputs_, std::move(tree_.main));
    tree_.main = std::move(inputs_);
  }

 private:
  ShaderRegion inputs_{};  ///< each once, before all else
  std::unordered_map<std::uint32_t, ShaderValue> input_values_{};

  struct Change {
    ShaderVariable variable;
    ShaderValue before;
  };
  struct Loop {
    ShaderRegion before{};                 ///< what need not run again
    std::vector<ShaderVariable> stored{};  ///< sorted
  };
  ShaderTree& tree_;
  std::vector<ShaderValue> same_{};  ///< what a value is replaced by
  std::vector<ShaderValue> known_;   ///< of variables
  std::vector<Change> changes_{};    ///< of known_, to be undone
  std::unordered_map<ValueKey, ShaderValue, ValueKeyHash> made_{};
  std::vector<ValueKey> order_{};                          ///< of made_
  std::unordered_map<ShaderValue, ShaderValue> turned_{};  ///< what is the opposite of what
  std::vector<Loop*> loops_{};                             ///< around
  std::vector<std::uint32_t> loop_of_;                     ///< how many loops are around a value

  void learn(ShaderVariable variable, ShaderValue value) {
    if (known_[variable] == value) return;
    changes_.push_back({variable, known_[variable]});
    known_[variable] = value;
  }
  void undo(std::size_t to) {
    while (changes_.size() > to) {
      known_[changes_.back().variable] = changes_.back().before;
      changes_.pop_back();
    }
  }
  void forget_made(std::size_t to) {
    while (order_.size() > to) {
      made_.erase(order_.back());
      order_.pop_back();
    }
  }

  ShaderValue resolved(ShaderValue value) {
    while (same_[value] != value) {
      same_[value] = same_[same_[value]];
      value = same_[value];
    }
    return value;
  }
  ShaderValue new_value() {
    const ShaderValue value = tree_.new_value();
    same_.push_back(value);
    loop_of_.push_back(static_cast<std::uint32_t>(loops_.size()));
    return value;
  }
  void fit() {
    while (same_.size() < tree_.values.size()) {
      same_.push_back(static_cast<ShaderValue>(same_.size()));
      loop_of_.push_back(0);
    }
  }
  ShaderValue constant(std::uint32_t bits) {
    const ShaderValue value = tree_.constant(bits);
    fit();
    return value;
  }

  static void collect_stored(const ShaderRegion& region, std::vector<ShaderVariable>& to) {
    for (const ShaderNode& node : region) {
      if (node.kind == ShaderNodeKind::instruction) {
        for_each_stored(node.instruction, [&](ShaderVariable of) { to.push_back(of); });
      }
      if (node.first) collect_stored(*node.first, to);
      if (node.second) collect_stored(*node.second, to);
    }
  }
  static std::vector<ShaderVariable> stored_in(const ShaderRegion& region) {
    std::vector<ShaderVariable> stored;
    collect_stored(region, stored);
    std::sort(stored.begin(), stored.end());
    stored.erase(std::unique(stored.begin(), stored.end()), stored.end());
    return stored;
  }

  void run(ShaderRegion& region) {
    ShaderRegion to;
    to.reserve(region.size());
    for (ShaderNode& node : region) {
      switch (node.kind) {
        case ShaderNodeKind::instruction: run_instruction(node, to); break;
        case ShaderNodeKind::branch: run_branch(node, to); break;
        case ShaderNodeKind::scope: node.loops ? run_loop(node, to) : run_scope(node, to); break;
        case ShaderNodeKind::exit: to.push_back(std::move(node)); break;
      }
      if (always_leaves(to)) break;
    }
    region = std::move(to);
  }

  void run_instruction(ShaderNode& node, ShaderRegion& to) {
    ShaderInstruction& in = node.instruction;
    for_each_operand(tree_, in, [&](ShaderValue& of) { of = resolved(of); });
    using enum ShaderOp;
    if ((in.op == load_indexed || in.op == store_indexed || in.op == load_constant) &&
        tree_.is_constant(in.a)) {
      const auto index = static_cast<std::int32_t>(tree_.bits(in.a));
      const auto last = static_cast<std::int32_t>(in.count) - 1;
      const std::uint32_t at =
          in.place + static_cast<std::uint32_t>(std::clamp(index, 0, last)) * in.stride;
      if (in.op == load_constant) {
        same_[in.to] = constant(tree_.tables[at]);
        return;
      }
      if (in.op == store_indexed) in.a = in.b;
      if (in.op == load_indexed) in.a = kNoValue;
      in.b = kNoValue;
      in.op = in.op == load_indexed ? load : store;
      in.place = at;
    }
    if (in.op == load) {
      if (known_[in.place] != kNoValue) {
        same_[in.to] = known_[in.place];
        return;
      }
      learn(in.place, in.to);
      // Out of the loops that leave the variable as it is.
      std::size_t depth = loops_.size();
      while (depth > 0 && !std::binary_search(loops_[depth - 1]->stored.begin(),
                                              loops_[depth - 1]->stored.end(), in.place)) {
        --depth;
      }
      put(node, depth, to);
      return;
    }
    if (in.op == store) {
      learn(in.place, in.a);
    } else if (in.op == store_indexed) {
      for_each_stored(in, [&](ShaderVariable of) { learn(of, kNoValue); });
    } else if (is_pure(in.op)) {
      run_pure(node, to);
      return;
    } else if (in.op == input) {
      const auto [found, is_new] = input_values_.try_emplace(in.place, in.to);
      if (!is_new) {
        same_[in.to] = found->second;
      } else {
        loop_of_[in.to] = 0;
        inputs_.push_back(std::move(node));
      }
      return;
    } else if (in.op == load_constant) {
      put(node, depth_of(in), to);
      return;
    } else if (in.op == sample && (tree_.samples[in.place].kind == SampleKind::size ||
                                   tree_.samples[in.place].kind == SampleKind::levels)) {
      run_size(node, to);
      return;
    }
    for_each_result(tree_, in, [&](ShaderValue of) {
      loop_of_[of] = static_cast<std::uint32_t>(loops_.size());
    });
    to.push_back(std::move(node));
  }

  /// Puts an instruction before the loop at a depth, or here.
  void put(ShaderNode& node, std::size_t depth, ShaderRegion& to) {
    loop_of_[node.instruction.to] = static_cast<std::uint32_t>(depth);
    (depth < loops_.size() ? loops_[depth]->before : to).push_back(std::move(node));
  }
  std::size_t depth_of(const ShaderInstruction& in) const {
    std::size_t depth = 0;
    for (const ShaderValue of : {in.a, in.b, in.c, in.d}) {
      if (of != kNoValue && !tree_.is_constant(of))
        depth = std::max<std::size_t>(depth, loop_of_[of]);
    }
    return depth;
  }

  void run_pure(ShaderNode& node, ShaderRegion& to) {
    ShaderInstruction& in = node.instruction;
    using enum ShaderOp;
    if (in.op == select) {
      if (const ShaderValue turned = turned_of(in.a); turned != kNoValue) {
        in.a = turned;
        std::swap(in.b, in.c);
      }
    }
    if (const ShaderValue simple = simpler(in); simple != kNoValue) {
      same_[in.to] = simple;
      return;
    }
    ValueKey key{in.op, in.a, in.b, in.c, in.d};
    if (swaps(in.op) && key.b < key.a) std::swap(key.a, key.b);
    const auto [found, is_new] = made_.try_emplace(key, in.to);
    if (!is_new) {
      same_[in.to] = found->second;
      return;
    }
    order_.push_back(key);
    if (in.op == bit_not) turned_[in.to] = in.a;
    put(node, depth_of(in), to);
  }
  /// What a value is the opposite of, bit by bit.
  ShaderValue turned_of(ShaderValue value) const {
    const auto found = turned_.find(value);
    return found == turned_.end() ? kNoValue : found->second;
  }

  /// The size of a texture, once.
  void run_size(ShaderNode& node, ShaderRegion& to) {
    const ShaderSample& sample = tree_.samples[node.instruction.place];
    const ValueKey key{ShaderOp::sample, sample.texture, sample.more[0],
                       static_cast<ShaderValue>(sample.kind), kNoValue};
    const auto [found, is_new] = made_.try_emplace(key, node.instruction.place);
    if (!is_new) {
      ShaderSample& first = tree_.samples[found->second];
      for (std::size_t i = 0; i < sample.to.size(); ++i) {
        if (sample.to[i] == kNoValue) continue;
        if (first.to[i] == kNoValue) {
          first.to[i] = sample.to[i];
        } else {
          same_[sample.to[i]] = first.to[i];
        }
      }
      return;
    }
    order_.push_back(key);
    std::size_t depth = 0;
    for (const ShaderValue of : {sample.texture, sample.more[0]}) {
      if (of != kNoValue && !tree_.is_constant(of)) {
        depth = std::max<std::size_t>(depth, loop_of_[of]);
      }
    }
    for (const ShaderValue of : sample.to) {
      if (of != kNoValue) loop_of_[of] = static_cast<std::uint32_t>(depth);
    }
    (depth < loops_.size() ? loops_[depth]->before : to).push_back(std::move(node));
  }

  ShaderValue simpler(const ShaderInstruction& in) {
    using enum ShaderOp;
    const auto is_known = [&](ShaderValue of) { return of == kNoValue || tree_.is_constant(of); };
    const auto bits = [&](ShaderValue of) { return of == kNoValue ? 0u : tree_.bits(of); };
    if (in.op == copy) return in.a;
    if (in.op < derivative_x && is_known(in.a) && is_known(in.b) && is_known(in.c) &&
        is_known(in.d)) {
      return constant(fold_shader_op(in.op, bits(in.a), bits(in.b), bits(in.c), bits(in.d)));
    }
    if (in.op == bit_not && turned_of(in.a) != kNoValue) return turned_of(in.a);
    if (in.op == select) {
      if (in.b == in.c) return in.b;
      if (is_known(in.a)) return bits(in.a) != 0 ? in.b : in.c;
    }
    const auto is = [&](ShaderValue of, std::uint32_t value) {
      return of != kNoValue && tree_.is_constant(of) && tree_.bits(of) == value;
    };
    constexpr std::uint32_t kOne = 0x3F800000;
    if (in.op == bit_and || in.op == bit_or) {
      if (in.a == in.b) return in.a;
      const std::uint32_t neutral = in.op == bit_and ? ~0u : 0u;
      if (is(in.a, neutral)) return in.b;
      if (is(in.b, neutral)) return in.a;
      if (is(in.a, ~neutral)) return in.a;
      if (is(in.b, ~neutral)) return in.b;
    }
    if (in.op == add_integers && is(in.b, 0)) return in.a;
    if (in.op == add_integers && is(in.a, 0)) return in.b;
    if (in.op == multiply_integers && is(in.b, 1)) return in.a;
    if (in.op == multiply_integers && is(in.a, 1)) return in.b;
    // By one, a float stays as it is: a NaN, too, for every NaN that is stored is the same one.
    if (in.op == multiply && is(in.b, kOne)) return in.a;
    if (in.op == multiply && is(in.a, kOne)) return in.b;
    if (in.op == divide && is(in.b, kOne)) return in.a;
    return kNoValue;
  }

  void run_branch(ShaderNode& node, ShaderRegion& to) {
    node.instruction.a = resolved(node.instruction.a);
    if (const ShaderValue turned = turned_of(node.instruction.a); turned != kNoValue) {
      node.instruction.a = turned;
      std::swap(node.first, node.second);
    }
    if (tree_.is_constant(node.instruction.a)) {
      ShaderRegion taken =
          std::move(tree_.bits(node.instruction.a) != 0 ? *node.first : *node.second);
      run(taken);
      append(to, std::move(taken));
      return;
    }
    const std::size_t changes = changes_.size(), made = order_.size();
    std::vector<Change> after[2];
    for (int side = 0; side < 2; ++side) {
      ShaderRegion& region = side == 0 ? *node.first : *node.second;
      run(region);
      for (std::size_t i = changes; i < changes_.size(); ++i) {
        after[side].push_back({changes_[i].variable, known_[changes_[i].variable]});
      }
      const auto order = [](const Change& a, const Change& b) { return a.variable < b.variable; };
      std::sort(after[side].begin(), after[side].end(), order);
      undo(changes);
      forget_made(made);
    }
    if (node.first->empty() && node.second->empty()) return;
    const bool leaves[2] = {always_leaves(*node.first), always_leaves(*node.second)};
    if (choose(node, to)) return;
    join(after, leaves);
    to.push_back(std::move(node));
  }

  /// What is known where two sides meet again.
  void join(std::vector<Change> (&after)[2], const bool (&leaves)[2]) {
    for (int side = 0; side < 2; ++side) {
      if (leaves[side]) continue;
      for (const Change& change : after[side]) {
        if (leaves[1 - side]) {
          learn(change.variable, change.before);
          continue;
        }
        // Known if the other side has the same.
        const ShaderValue other = known_before(change.variable, after[1 - side]);
        learn(change.variable, other == change.before ? other : kNoValue);
      }
    }
  }
  ShaderValue known_before(ShaderVariable variable, const std::vector<Change>& after) const {
    const auto found =
        std::lower_bound(after.begin(), after.end(), variable,
                         [](const Change& of, ShaderVariable than) { return of.variable < than; });
    return found != after.end() && found->variable == variable ? found->before : known_[variable];
  }

  /// A short branch of pure instructions and stores becomes choices.
  bool choose(ShaderNode& node, ShaderRegion& to) {
    constexpr std::size_t kMost = 12;
    const auto is_short = [](const ShaderRegion& region) {
      return region.size() <= kMost &&
             std::all_of(region.begin(), region.end(), [](const auto& in) {
               return in.kind == ShaderNodeKind::instruction &&
                      (is_pure(in.instruction.op) || in.instruction.op == ShaderOp::load ||
                       in.instruction.op == ShaderOp::store) &&
                      !(in.instruction.op >= ShaderOp::derivative_x &&
                        in.instruction.op <= ShaderOp::derivative_y_coarse);
             });
    };
    if (!is_short(*node.first) || !is_short(*node.second)) return false;
    std::vector<std::pair<ShaderVariable, std::array<ShaderValue, 2>>> stored;
    for (int side = 0; side < 2; ++side) {
      for (ShaderNode& each : side == 0 ? *node.first : *node.second) {
        ShaderInstruction& in = each.instruction;
        if (in.op != ShaderOp::store) continue;
        const auto found = std::find_if(stored.begin(), stored.end(),
                                        [&](const auto& of) { return of.first == in.place; });
        if (found == stored.end()) {
          stored.push_back({in.place, {kNoValue, kNoValue}});
          stored.back().second[static_cast<std::size_t>(side)] = in.a;
        } else {
          found->second[static_cast<std::size_t>(side)] = in.a;
        }
      }
    }
    // A load behind a store of its own side has been replaced; others see what was there before.
    for (ShaderRegion* side : {node.first.get(), node.second.get()}) {
      for (ShaderNode& each : *side) {
        if (each.instruction.op == ShaderOp::store) continue;
        for_each_result(tree_, each.instruction, [&](ShaderValue of) {
          loop_of_[of] = static_cast<std::uint32_t>(loops_.size());
        });
        if (each.instruction.op == ShaderOp::load)
          learn(each.instruction.place, each.instruction.to);
        to.push_back(std::move(each));
      }
    }
    for (auto& [variable, sides] : stored) {
      for (ShaderValue& side : sides) {
        if (side != kNoValue) continue;
        if (known_[variable] == kNoValue) {
          ShaderNode load;
          load.instruction.op = ShaderOp::load;
          load.instruction.place = variable;
          load.instruction.to = new_value();
          learn(variable, load.instruction.to);
          to.push_back(std::move(load));
        }
        side = known_[variable];
      }
      ShaderValue chosen = resolved(sides[0]);
      if (chosen != resolved(sides[1])) {
        ShaderNode select;
        select.instruction = {.op = ShaderOp::select,
                              .a = node.instruction.a,
                              .b = resolved(sides[0]),
                              .c = resolved(sides[1]),
                              .line = node.instruction.line};
        select.instruction.to = chosen = new_value();
        to.push_back(std::move(select));
      }
      ShaderNode store;
      store.instruction.op = ShaderOp::store;
      store.instruction.place = variable;
      store.instruction.a = chosen;
      to.push_back(std::move(store));
      learn(variable, chosen);
    }
    return true;
  }

  void run_scope(ShaderNode& node, ShaderRegion& to) {
    const std::vector<ShaderVariable> stored = stored_in(*node.first);
    const std::size_t made = order_.size(), changes = changes_.size();
    run(*node.first);
    // Who left before a load has not made its value.
    undo(changes);
    forget_made(made);
    for (const ShaderVariable of : stored) learn(of, kNoValue);
    to.push_back(std::move(node));
  }

  void run_loop(ShaderNode& node, ShaderRegion& to) {
    Loop loop{.stored = stored_in(*node.first)};
    for (const ShaderVariable of : loop.stored) learn(of, kNoValue);
    const std::size_t made = order_.size(), changes = changes_.size();
    loops_.push_back(&loop);
    run(*node.first);
    loops_.pop_back();
    forget_made(made);
    undo(changes);
    for (const ShaderVariable of : loop.stored) learn(of, kNoValue);
    append(to, std::move(loop.before));
    to.push_back(std::move(node));
  }
};

}  // namespace

void forward_values(ShaderTree& tree) { Forwarding{tree}.run(); }

}  // namespace softfocus
