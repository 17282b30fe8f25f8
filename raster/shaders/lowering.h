#pragma once
// Lowering of one module: what lower_spirv.cpp (control flow), lower_instructions.cpp and
// lower_glsl.cpp share.

#include <algorithm>
#include <bit>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "raster/shaders/lower_spirv.h"
#include "raster/shaders/shader_kernels.h"

namespace softfocus {

using Words = std::span<const std::uint32_t>;
using Scalars = std::vector<ShaderValue>;

inline constexpr std::size_t kMostNodes = std::size_t{1} << 20;
inline constexpr std::size_t kMostWork = std::size_t{1} << 22;
inline constexpr int kDeepestNodes = 200, kDeepestCalls = 64;

/// What an instruction makes of one or two whole numbers or booleans; nothing of others, or if it
/// takes another number of them.
std::optional<std::uint32_t> fold_spirv_op(SpirvOp op, std::span<const std::uint32_t> operands);

inline bool is_uniform(SpirvStorage storage) {
  return storage == SpirvStorage::uniform_constant || storage == SpirvStorage::uniform ||
         storage == SpirvStorage::push_constant;
}

/// What a pointer points to: numbers one after the other.
struct Pointee {
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
  std::map<SpirvId, Pointee> places{};
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
  Lowering(const SpirvModule& module, Words uniforms, const std::vector<bool>& is_late,
           ShaderTree& to)
      : module_(module), uniforms_(uniforms), is_late_(is_late), tree_(to) {}

  void lower();

 private:
  const SpirvModule& module_;
  Words uniforms_;
  const std::vector<bool>& is_late_;
  ShaderTree& tree_;
  std::vector<ShaderVariable> clamped_colours_{};
  std::uint32_t late_inputs_ = 0;  ///< the first input that is a uniform; the others follow
  std::map<SpirvId, Pointee> globals_{};
  std::vector<Target> targets_{};
  std::optional<std::uint32_t> uniform_table_{};
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

  void add_inputs(SpirvId id, const SpirvDecorations& of);
  void add_outputs(std::uint32_t first, SpirvId id, const SpirvDecorations& of);
  bool has_integers(const SpirvType& of) const;
  int locations(SpirvId id) const;
  /// body(type, decorations) for each member of a structure, which has a location of its own.
  template <class Body>
  void for_each_member(SpirvId id, const SpirvDecorations& of, const Body& body) {
    const SpirvType& what = type(id);
    const SpirvDecorations& members = decorations_of(id);
    int location = of.location;
    for (std::size_t i = 0; i < what.members.size(); ++i) {
      SpirvDecorations member = i < members.members.size() ? members.members[i] : of;
      if (member.location < 0) member.location = location;
      body(what.members[i], member);
      location = member.location + locations(what.members[i]);
    }
  }
  /// body(its decorations) for each element of an array of structures, which may be arrays of them.
  template <class Body>
  void for_each_structure(SpirvId id, const SpirvDecorations& of, const Body& body) {
    const SpirvType& what = type(id);
    SpirvDecorations element = of;
    for (std::uint32_t i = 0; i < what.count; ++i) {
      body(element);
      if (element.location >= 0) element.location += locations(what.element);
    }
  }
  bool is_array_of_structures(SpirvId id) const {
    const SpirvType* what = &type(id);
    if (what->kind != SpirvKind::array) return false;
    while (what->kind == SpirvKind::array) what = &type(what->element);
    return what->kind == SpirvKind::structure;
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
    const int locations_of_row = (each + 3) / 4;
    for (int i = 0; i < count; ++i) {
      const int place = i % each;
      add(of.location < 0 ? 0 : of.location + i / each * locations_of_row + place / 4,
          of.component + place % 4, i);
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
                   ShaderValue c = kNoValue, ShaderValue d = kNoValue) {
    if (is_double(a) || is_double(b) || is_double(c)) return make_of_doubles(to, op, a, b, c);
    const auto known = [&](ShaderValue v) { return v == kNoValue || tree_.is_constant(v); };
    const auto bits = [&](ShaderValue v) { return v == kNoValue ? 0u : tree_.bits(v); };
    if (known(a) && known(b) && known(c) && known(d) && op < ShaderOp::derivative_x) {
      return tree_.constant(fold_shader_op(op, bits(a), bits(b), bits(c), bits(d)));
    }
    ShaderInstruction& in = add(to, op);
    in.a = a;
    in.b = b;
    in.c = c;
    in.d = d;
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

  // --- doubles ---

  // Values of ids and what lies in memory are words, a double's low one first. While an operation
  // is lowered a double is one number, so that its order of operations is that of floats.
  struct DoubleWords {
    ShaderValue low, high;
  };
  static constexpr ShaderValue kDouble = 0x80000000;  ///< and its place among these:
  std::vector<DoubleWords> doubles_{};

  static bool is_double(ShaderValue of) { return of != kNoValue && (of & kDouble) != 0; }
  bool holds_doubles(SpirvId id) const {
    const SpirvType* of = &type(id);
    while (of->element != 0) of = &type(of->element);
    return of->kind == SpirvKind::floating && of->scalars == 2;
  }
  ShaderValue double_of(ShaderValue low, ShaderValue high);
  /// A number that all of its kind have.
  ShaderValue constant_like(ShaderValue of, float value);
  /// What value() gives, with doubles as numbers; and back again.
  Scalars numbers(const Call& call, SpirvId id);
  Scalars words_of(const Scalars& numbers) const;
  /// The words of doubles as whole numbers: every NaN is the same one.
  Scalars bits_of_doubles(ShaderRegion& to, const Scalars& of);
  /// `from`: from_signed, from_unsigned, or double_of_float.
  ShaderValue convert_to_double(ShaderRegion& to, ShaderOp from, ShaderValue a);
  ShaderValue make_of_doubles(ShaderRegion& to, ShaderOp op, ShaderValue a, ShaderValue b,
                              ShaderValue c);

  // --- memory ---

  ShaderValue load_one(ShaderRegion& to, const Pointee& at, std::uint32_t number);
  /// By an index that is not known, all that it may mean are taken.
  ShaderValue load_input(ShaderRegion& to, const Pointee& at, std::uint32_t place);
  bool is_any_late(const Pointee& at, std::uint32_t place) const;
  /// Where the uniforms lie among the tables.
  std::uint32_t uniform_table();

  Scalars load(ShaderRegion& to, const Pointee& at);
  void store(ShaderRegion& to, const Pointee& at, const Scalars& values);

  /// An index as a whole number from 0 to count - 1.
  ShaderValue clamped(ShaderRegion& to, ShaderValue index, std::uint32_t count) {
    const ShaderValue from_0 = make(to, ShaderOp::maximum_signed, index, whole(0));
    return make(to, ShaderOp::minimum_signed, from_0, whole(count - 1));
  }

  Pointee chain(ShaderRegion& to, Pointee at, const std::vector<ShaderValue>& indices);

  // --- values and places of ids ---

  Scalars value(const Call& call, SpirvId id) {
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
  ShaderValue scalar(const Call& call, SpirvId id) {
    const Scalars values = value(call, id);
    if (values.size() != 1) damaged("a scalar is none");
    return values[0];
  }
  Pointee place(Call& call, SpirvId id) {
    if (const auto found = call.places.find(id); found != call.places.end()) return found->second;
    if (const auto found = globals_.find(id); found != globals_.end()) return found->second;
    damaged("a pointer is used that is not there");
  }

  // --- functions ---

  void run_call(Call& call, ShaderRegion& to);

  // --- control flow ---

  const SpirvBlock& block_of(const Call& call, SpirvId label) const {
    return call.function->blocks[call.function->block_of.at(label)];
  }

  /// Hands the phis of a block what comes from another.
  void hand_phis(Call& call, SpirvId from, SpirvId label, ShaderRegion& to);

  const Target* target_of(SpirvId label) const;

  /// Goes from one block to another: to the region's natural end, out of a scope, or on.
  void go(Call& call, SpirvId from, SpirvId label, ShaderRegion& to, SpirvId natural);
  bool leave(SpirvId label, ShaderRegion& to);

  ShaderNode branch_node(ShaderValue condition, ShaderRegion first, ShaderRegion second);
  ShaderNode scope_node(std::uint32_t scope, bool loops, ShaderRegion body);

  void walk(Call& call, SpirvId label, ShaderRegion& to, SpirvId natural);

  void loop(Call& call, const SpirvBlock& header, ShaderRegion& to);

  /// Ends a block. The block to go on with in the same region, or 0.
  SpirvId run_end(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural,
                  bool is_header = false);

  SpirvId run_condition(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural,
                        bool is_header);

  // --- switch ---

  /// The cases that a case's blocks may go to.
  std::set<SpirvId> reach(const Call& call, SpirvId begin, SpirvId merge,
                          const std::vector<SpirvId>& cases);

  SpirvId run_switch(Call& call, const SpirvBlock& block, ShaderRegion& to, SpirvId natural);

  /// A case before the one that it falls into.
  std::vector<SpirvId> in_order(const Call& call, const std::vector<SpirvId>& labels,
                                SpirvId merge);

  std::map<SpirvId, ShaderVariable> falls_{};

  /// A case's body is a scope of its own, which is left to fall into the next.
  void run_case(Call& call, SpirvId label, const std::vector<SpirvId>& labels, ShaderValue chosen,
                std::uint32_t scope, ShaderRegion& to);

  // --- instructions ---

  void run_block(Call& call, const SpirvBlock& block, ShaderRegion& to);

  std::vector<ShaderValue> indices(const Call& call, Words ids) {
    std::vector<ShaderValue> made;
    made.reserve(ids.size());
    for (const SpirvId id : ids) made.push_back(scalar(call, id));
    return made;
  }

  static std::uint32_t word(Words w, std::size_t at) {
    if (at >= w.size()) throw ShaderError("the SPIR-V is damaged: an instruction is cut short");
    return w[at];
  }

  void run(Call& call, const SpirvInstruction& in, ShaderRegion& to);

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
