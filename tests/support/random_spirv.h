#pragma once
// Fragment shaders of chance, in words of SPIR-V: structured control flow in every shape that has
// a meaning, phis at every place where ways meet, values that are used far from where they are
// made. Front ends make few of these.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "raster/shaders/spirv_words.h"
#include "tests/support/random.h"

namespace softfocus::test {

class RandomSpirv {
 public:
  explicit RandomSpirv(std::uint64_t seed) : random_{seed * 0x9E3779B97F4A7C15u + 1} {}

  std::vector<std::uint32_t> words() {
    has_doubles_ = chance(50);
    declare();
    const int functions = random_.whole(0, 2);
    for (int i = 0; i < functions; ++i) make_function();
    make_main();
    std::vector<std::uint32_t> all{0x07230203, 0x00010000, 0, next_id_, 0};
    for (const auto* part : {&head_, &types_, &code_}) {
      all.insert(all.end(), part->begin(), part->end());
    }
    return all;
  }

 private:
  using Words = std::vector<std::uint32_t>;
  using Id = std::uint32_t;
  enum Kind : std::uint8_t { truth, whole, real, wide };  ///< wide: a double
  static constexpr std::size_t kKinds = 4;
  using Known = std::array<std::vector<Id>, kKinds>;  ///< values that are there

  /// A way into a block.
  struct Way {
    Id from = 0;
    Known known{};
  };
  /// A block that those inside may go to.
  struct Aim {
    Id label = 0;
    std::vector<Way> ways{};
  };
  struct Function {
    Id id = 0;
    Kind gives = whole;
    std::vector<Kind> takes{};  ///< and behind them a pointer to an int
  };

  Random random_;
  Words head_{}, types_{}, code_{};
  Id next_id_ = 1;
  Id void_ = 0, vector_ = 0, array_ = 0, output_ = 0, coordinates_ = 0;
  std::array<Id, kKinds> type_{}, pointer_{};
  Id low_bits_ = 0, array_pointer_ = 0, private_int_ = 0, function_type_ = 0;
  std::array<Id, 2> globals_{}, arrays_{};
  std::vector<Id> ints_{};  ///< pointers of the function under way
  std::vector<Function> functions_{};
  Known constants_{}, known_{};
  Id block_ = 0;  ///< under way; 0: what comes cannot be reached
  std::vector<Aim*> aims_{};
  int left_ = 0;
  std::optional<Kind> returns_{};
  bool has_doubles_ = false;

  Id id() { return next_id_++; }
  bool chance(int percent) { return random_.whole(1, 100) <= percent; }
  static void put(Words& to, SpirvOp op, std::initializer_list<std::uint32_t> operands) {
    to.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 |
                 static_cast<std::uint32_t>(op));
    to.insert(to.end(), operands);
  }
  void put(SpirvOp op, std::initializer_list<std::uint32_t> operands) { put(code_, op, operands); }
  Id made(SpirvOp op, Id type, std::initializer_list<std::uint32_t> operands) {
    const Id result = id();
    code_.push_back(static_cast<std::uint32_t>(operands.size() + 3) << 16 |
                    static_cast<std::uint32_t>(op));
    code_.push_back(type);
    code_.push_back(result);
    code_.insert(code_.end(), operands);
    return result;
  }
  Id declared(SpirvOp op, std::initializer_list<std::uint32_t> operands) {
    const Id result = id();
    types_.push_back(static_cast<std::uint32_t>(operands.size() + 2) << 16 |
                     static_cast<std::uint32_t>(op));
    types_.push_back(result);
    types_.insert(types_.end(), operands);
    return result;
  }
  Id number(Kind kind, std::uint32_t bits) {
    const Id result = id();
    if (kind == truth) {
      put(types_, bits != 0 ? SpirvOp::constant_true : SpirvOp::constant_false,
          {type_[kind], result});
    } else {
      put(types_, SpirvOp::constant, {type_[kind], result, bits});
    }
    constants_[kind].push_back(result);
    return result;
  }
  Id global(Id pointer, SpirvStorage storage) {
    const Id result = id();
    put(types_, SpirvOp::variable, {pointer, result, static_cast<std::uint32_t>(storage)});
    return result;
  }

  void declare() {
    using enum SpirvOp;
    const auto storage = [](SpirvStorage of) { return static_cast<std::uint32_t>(of); };
    void_ = declared(type_void, {});
    type_[truth] = declared(type_bool, {});
    type_[whole] = declared(type_int, {32, 1});
    type_[real] = declared(type_float, {32});
    vector_ = declared(type_vector, {type_[real], 4});
    type_[wide] = declared(type_float, {64});
    for (const Kind kind : {truth, whole, real}) {
      pointer_[kind] = declared(type_pointer, {storage(SpirvStorage::function), type_[kind]});
    }
    for (const std::uint32_t bits : {0u, 1u, 2u, 3u, 7u, ~0u, 100u}) number(whole, bits);
    low_bits_ = number(whole, 0xFFFFFF);
    for (const float x : {0.0f, 1.0f, 0.5f, -2.5f, 8.0f}) {
      number(real, std::bit_cast<std::uint32_t>(x));
    }
    for (const double x : {0.0, 1.0, 0.1, -2.5, 0x1p40}) {
      const auto bits = std::bit_cast<std::uint64_t>(x);
      constants_[wide].push_back(id());
      put(types_, constant,
          {type_[wide], constants_[wide].back(), static_cast<std::uint32_t>(bits),
           static_cast<std::uint32_t>(bits >> 32)});
    }
    number(truth, 0);
    number(truth, 1);
    array_ = declared(type_array, {type_[whole], constants_[whole][3]});
    const Id array_of_globals = declared(type_pointer, {storage(SpirvStorage::global), array_});
    array_pointer_ = declared(type_pointer, {storage(SpirvStorage::function), array_});
    private_int_ = declared(type_pointer, {storage(SpirvStorage::global), type_[whole]});
    for (Id& each : globals_) each = global(private_int_, SpirvStorage::global);
    arrays_[0] = global(array_of_globals, SpirvStorage::global);
    function_type_ = declared(SpirvOp::type_function, {void_});
    output_ = global(declared(type_pointer, {storage(SpirvStorage::output), vector_}),
                     SpirvStorage::output);
    coordinates_ = global(declared(type_pointer, {storage(SpirvStorage::input), vector_}),
                          SpirvStorage::input);
    put(head_, decorate, {output_, static_cast<std::uint32_t>(SpirvDecoration::location), 0});
    put(head_, decorate,
        {coordinates_, static_cast<std::uint32_t>(SpirvDecoration::builtin),
         static_cast<std::uint32_t>(SpirvBuiltin::frag_coord)});
  }

  // --- values ---

  Kind some_kind() {
    const int number = random_.whole(0, has_doubles_ ? 12 : 9);
    return number < 5 ? whole : number < 8 ? real : number < 10 ? truth : wide;
  }
  Id some(Kind kind) { return some(kind, known_); }
  Id some(Kind kind, const Known& known) {
    const std::vector<Id>& from =
        known[kind].empty() || chance(15) ? constants_[kind] : known[kind];
    // Often one of the last.
    const int last = static_cast<int>(from.size()) - 1;
    const int first = chance(50) ? std::max(0, last - 3) : 0;
    return from[static_cast<std::size_t>(random_.whole(first, last))];
  }
  void know(Kind kind, Id value) { known_[kind].push_back(value); }

  void compute() {
    using enum SpirvOp;
    const Kind kind = some_kind();
    const auto one_of = [&](std::initializer_list<SpirvOp> list) {
      return *(list.begin() + random_.whole(0, static_cast<int>(list.size()) - 1));
    };
    if (chance(12)) {
      know(kind, made(SpirvOp::select, type_[kind], {some(truth), some(kind), some(kind)}));
    } else if (kind == whole && chance(15)) {
      const Kind from = has_doubles_ && chance(40) ? wide : real;
      know(whole, made(convert_float_to_signed, type_[whole], {some(from)}));
    } else if (kind == whole) {
      const SpirvOp op = one_of({integer_add, integer_sub, integer_mul, signed_div, signed_mod,
                                 bitwise_and, bitwise_or, bitwise_xor, shift_left_logical,
                                 shift_right_arithmetic, bitwise_and});
      know(whole, made(op, type_[whole], {some(whole), some(whole)}));
    } else if (kind == wide && chance(30)) {
      const bool is_whole = chance(50);
      know(wide, made(is_whole ? convert_signed_to_float : float_convert, type_[wide],
                      {some(is_whole ? whole : real)}));
    } else if (kind == wide) {
      const SpirvOp op = one_of({float_add, float_sub, float_mul, float_div});
      know(wide, made(op, type_[wide], {some(wide), some(wide)}));
    } else if (kind == real && has_doubles_ && chance(15)) {
      know(real, made(float_convert, type_[real], {some(wide)}));
    } else if (kind == real && chance(25)) {
      know(real, made(convert_signed_to_float, type_[real], {some(whole)}));
    } else if (kind == real) {
      const SpirvOp op = one_of({float_add, float_sub, float_mul, float_div});
      know(real, made(op, type_[real], {some(real), some(real)}));
    } else if (chance(50)) {
      const SpirvOp op = one_of({signed_less_than, integer_equal, signed_greater_than_equal});
      know(truth, made(op, type_[truth], {some(whole), some(whole)}));
    } else if (chance(50)) {
      const SpirvOp op = one_of({float_ord_less_than, float_unord_not_equal, float_ord_equal});
      const Kind of = has_doubles_ && chance(50) ? wide : real;
      know(truth, made(op, type_[truth], {some(of), some(of)}));
    } else {
      know(truth, made(one_of({logical_and, logical_or, logical_not_equal}), type_[truth],
                       {some(truth), some(truth)}));
    }
  }

  Id some_place() {
    const int number = random_.whole(0, 3);
    if (number == 0) return globals_[static_cast<std::size_t>(random_.whole(0, 1))];
    if (number == 1) return made(SpirvOp::access_chain, private_int_, {arrays_[0], some(whole)});
    if (number == 2 && arrays_[1] != 0) {
      return made(SpirvOp::access_chain, pointer_[whole], {arrays_[1], some(whole)});
    }
    return ints_[static_cast<std::size_t>(random_.whole(0, static_cast<int>(ints_.size()) - 1))];
  }
  void remember() {
    const Id place = some_place();
    if (chance(50)) {
      know(whole, made(SpirvOp::load, type_[whole], {place}));
    } else {
      put(SpirvOp::store, {place, some(whole)});
    }
  }

  void call() {
    if (functions_.empty()) return compute();
    const Function& function = functions_[static_cast<std::size_t>(
        random_.whole(0, static_cast<int>(functions_.size()) - 1))];
    Words operands{function.id};
    for (const Kind kind : function.takes) operands.push_back(some(kind));
    operands.push_back(ints_[0]);
    const Id result = id();
    code_.push_back(static_cast<std::uint32_t>(operands.size() + 3) << 16 |
                    static_cast<std::uint32_t>(SpirvOp::function_call));
    code_.push_back(type_[function.gives]);
    code_.push_back(result);
    code_.insert(code_.end(), operands.begin(), operands.end());
    know(function.gives, result);
  }

  // --- blocks ---

  void begin(Id label) {
    put(SpirvOp::label, {label});
    block_ = label;
  }
  void branch(Id label) {
    put(SpirvOp::branch, {label});
    block_ = 0;
  }
  /// Goes from the block under way to one of those around.
  void go(Aim& aim) {
    aim.ways.push_back({block_, known_});
    branch(aim.label);
  }
  /// Begins a block where ways meet, with phis of what they bring. `common` is known on all.
  void meet(const Aim& aim, const Known& common) {
    begin(aim.label);
    known_ = common;
    if (aim.ways.empty()) {
      put(SpirvOp::unreachable, {});
      block_ = 0;
      return;
    }
    const int phis = random_.whole(0, 3);
    Known here;
    for (int i = 0; i < phis; ++i) {
      const Kind kind = some_kind();
      const Id result = id();
      code_.push_back(static_cast<std::uint32_t>(3 + 2 * aim.ways.size()) << 16 |
                      static_cast<std::uint32_t>(SpirvOp::phi));
      code_.push_back(type_[kind]);
      code_.push_back(result);
      for (const Way& way : aim.ways) {
        code_.push_back(some(kind, way.known));
        code_.push_back(way.from);
      }
      here[kind].push_back(result);
    }
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      known_[kind].insert(known_[kind].end(), here[kind].begin(), here[kind].end());
    }
  }

  /// Ends the block under way by leaving, if there is somewhere to go.
  void leave() {
    const int number = random_.whole(0, 9);
    if (number < 7 && !aims_.empty()) {
      const int last = static_cast<int>(aims_.size()) - 1;
      return go(*aims_[static_cast<std::size_t>(random_.whole(std::max(0, last - 3), last))]);
    }
    if (number == 7) {
      put(SpirvOp::kill, {});
    } else if (returns_) {
      put(SpirvOp::return_value, {some(*returns_)});
    } else {
      store_output();
      put(SpirvOp::return_nothing, {});
    }
    block_ = 0;
  }

  void statements(int depth, int most) {
    for (int i = random_.whole(1, most); i > 0 && block_ != 0; --i) statement(depth);
  }
  void statement(int depth) {
    --left_;
    const int number = random_.whole(0, 99);
    if (depth <= 0 || left_ < 0 || number < 40) return chance(75) ? compute() : remember();
    if (number < 60) return selection(depth - 1);
    if (number < 78) return loop(depth - 1);
    if (number < 86) return choice(depth - 1);
    if (number < 93) return call();
    leave_if();
  }

  /// A branch without a merge: to a block around, or on.
  void leave_if() {
    if (aims_.empty()) return compute();
    const int last = static_cast<int>(aims_.size()) - 1;
    Aim& aim = *aims_[static_cast<std::size_t>(random_.whole(std::max(0, last - 2), last))];
    const Id on = id();
    aim.ways.push_back({block_, known_});
    const bool first = chance(50);
    put(SpirvOp::branch_conditional, {some(truth), first ? aim.label : on, first ? on : aim.label});
    begin(on);
  }

  void selection(int depth) {
    Aim merge{.label = id()};
    const Known before = known_;
    const Id sides[2] = {id(), id()};
    const int missing = chance(40) ? random_.whole(0, 1) : 2;  // which side is the end itself
    put(SpirvOp::selection_merge, {merge.label, 0});
    if (missing < 2) merge.ways.push_back({block_, known_});
    put(SpirvOp::branch_conditional, {some(truth), missing == 0 ? merge.label : sides[0],
                                      missing == 1 ? merge.label : sides[1]});
    for (int side = 0; side < 2; ++side) {
      if (side == missing) continue;
      known_ = before;
      begin(sides[side]);
      const bool is_aim = chance(30);
      if (is_aim) aims_.push_back(&merge);
      statements(depth, 4);
      if (block_ != 0 && chance(20)) leave();
      if (is_aim) aims_.pop_back();
      if (block_ != 0) go(merge);
    }
    meet(merge, before);
  }

  void choice(int depth) {
    Aim merge{.label = id()};
    const Known before = known_;
    const int count = random_.whole(1, 4);
    std::vector<Aim> cases(static_cast<std::size_t>(count));
    for (Aim& each : cases) {
      each.label = id();
      each.ways.push_back({block_, known_});
    }
    const int of_default = random_.whole(0, count);  // the last: the end itself
    if (of_default == count) merge.ways.push_back({block_, known_});
    const Id selector =
        made(SpirvOp::bitwise_and, type_[whole], {some(whole), constants_[whole][3]});
    put(SpirvOp::selection_merge, {merge.label, 0});
    Words operands{selector, of_default == count
                                 ? merge.label
                                 : cases[static_cast<std::size_t>(of_default)].label};
    for (int i = 0; i < count; ++i) {
      if (i == of_default && chance(50)) continue;
      operands.push_back(static_cast<std::uint32_t>(i));
      operands.push_back(cases[static_cast<std::size_t>(i)].label);
    }
    code_.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 |
                    static_cast<std::uint32_t>(SpirvOp::switch_case));
    code_.insert(code_.end(), operands.begin(), operands.end());
    aims_.push_back(&merge);
    for (std::size_t i = 0; i < cases.size(); ++i) {
      meet(cases[i], before);
      statements(depth, 3);
      if (block_ == 0) continue;
      go(i + 1 < cases.size() && chance(40) ? cases[i + 1] : merge);
    }
    aims_.pop_back();
    meet(merge, before);
  }

  void loop(int depth) {
    const Id header = id();
    const bool is_one_block = chance(15);
    Aim merge{.label = id()}, next{.label = is_one_block ? header : id()};
    const Id before = block_;
    const Known outside = known_;
    branch(header);
    begin(header);
    // A counter, and other phis, whose values of the next turn are filled in at its end.
    struct Phi {
      Kind kind;
      std::size_t at;  ///< of its value's word, and of the block it comes from
    };
    std::vector<Phi> phis;
    const auto phi = [&](Kind kind, Id first) {
      const Id result = made(SpirvOp::phi, type_[kind], {first, before, 0, 0});
      phis.push_back({kind, code_.size() - 2});
      return result;
    };
    const Id counter = phi(whole, constants_[whole][0]);
    for (int i = random_.whole(0, 3); i > 0; --i) {
      const Kind kind = some_kind();
      know(kind, phi(kind, some(kind, outside)));
    }
    know(whole, counter);
    for (int i = random_.whole(0, 3); i > 0; --i) chance(80) ? compute() : remember();
    for (int i = random_.whole(0, 2); i > 0; --i) {  // of all pixels at once
      know(truth, made(SpirvOp::integer_equal, type_[truth], {counter, some(whole, constants_)}));
    }
    Id most = constants_[whole][static_cast<std::size_t>(random_.whole(1, 3))];
    if (chance(50)) {
      most = made(SpirvOp::bitwise_and, type_[whole], {some(whole), constants_[whole][3]});
    }
    const Id counted = made(SpirvOp::integer_add, type_[whole], {counter, constants_[whole][1]});
    const Id goes_on = made(SpirvOp::signed_less_than, type_[truth], {counter, most});
    const Known of_header = known_;
    const bool ends_first = chance(50);
    const auto end_turn = [&](bool may_leave, bool turned) {
      for (std::size_t i = 0; i < phis.size(); ++i) {
        code_[phis[i].at] = i == 0 ? counted : some(phis[i].kind);
        code_[phis[i].at + 1] = block_;
      }
      if (!may_leave) return branch(header);
      merge.ways.push_back({block_, known_});
      const Id is = turned ? made(SpirvOp::logical_not, type_[truth], {goes_on}) : goes_on;
      if (is_one_block) put(SpirvOp::loop_merge, {merge.label, next.label, 0});
      put(SpirvOp::branch_conditional,
          {is, turned ? merge.label : header, turned ? header : merge.label});
      block_ = 0;
    };
    if (is_one_block) {
      end_turn(true, chance(50));
      return meet(merge, of_header);
    }
    const Id body = id();
    if (ends_first) merge.ways.push_back({block_, known_});
    put(SpirvOp::loop_merge, {merge.label, next.label, 0});
    if (ends_first) {
      put(SpirvOp::branch_conditional, {goes_on, body, merge.label});
    } else {
      put(SpirvOp::branch, {body});
    }
    begin(body);
    const std::vector<Aim*> around = aims_;
    aims_.push_back(&merge);
    aims_.push_back(&next);
    statements(depth, 5);
    if (block_ != 0) go(next);
    aims_ = around;
    if (next.ways.empty()) {  // no turn has an end; the block must be there
      known_ = of_header;
      begin(next.label);
    } else {
      meet(next, of_header);
      for (int i = random_.whole(0, 2); i > 0; --i) compute();
    }
    end_turn(!ends_first || chance(30), chance(50));
    meet(merge, of_header);
  }

  // --- functions ---

  void begin_locals() {
    ints_.clear();
    for (int i = 0; i < 2; ++i) {
      ints_.push_back(made(SpirvOp::variable, pointer_[whole],
                           {static_cast<std::uint32_t>(SpirvStorage::function)}));
    }
    arrays_[1] = made(SpirvOp::variable, array_pointer_,
                      {static_cast<std::uint32_t>(SpirvStorage::function)});
  }

  void make_function() {
    Function function{.id = id(), .gives = some_kind()};
    Words type{type_[function.gives]};
    for (int i = random_.whole(0, 2); i > 0; --i) {
      function.takes.push_back(some_kind());
      type.push_back(type_[function.takes.back()]);
    }
    type.push_back(pointer_[whole]);
    const Id of = id();
    types_.push_back(static_cast<std::uint32_t>(type.size() + 2) << 16 |
                     static_cast<std::uint32_t>(SpirvOp::type_function));
    types_.push_back(of);
    types_.insert(types_.end(), type.begin(), type.end());
    put(SpirvOp::function, {type_[function.gives], function.id, 0, of});
    known_ = {};
    for (const Kind kind : function.takes) {
      know(kind, made(SpirvOp::function_parameter, type_[kind], {}));
    }
    const Id pointer = made(SpirvOp::function_parameter, pointer_[whole], {});
    begin(id());
    begin_locals();
    ints_[1] = pointer;
    returns_ = function.gives;
    left_ = 25;
    statements(2, 6);
    if (block_ != 0) put(SpirvOp::return_value, {some(function.gives)});
    put(SpirvOp::function_end, {});
    functions_.push_back(function);
  }

  /// Of as many values as a shader can bring to bear, so that a wrong one shows.
  void store_output() {
    using enum SpirvOp;
    Id values = some(whole), memory = made(SpirvOp::load, type_[whole], {ints_[0]});
    Id floats = some(real), choices = constants_[whole][0];
    for (int i = 0; i < 10; ++i) {
      values = made(bitwise_xor, type_[whole], {values, some(whole)});
      values = made(integer_mul, type_[whole], {values, constants_[whole][3]});
    }
    for (const Id place : {ints_[1], globals_[0], globals_[1]}) {
      const Id more = made(SpirvOp::load, type_[whole], {place});
      memory = made(integer_add, type_[whole], {memory, more});
      memory = made(integer_mul, type_[whole], {memory, constants_[whole][4]});
    }
    for (int i = 0; i < 5; ++i) {
      const Id bit = made(SpirvOp::select, type_[whole],
                          {some(truth), constants_[whole][1], constants_[whole][0]});
      choices = made(integer_add, type_[whole], {choices, choices});
      choices = made(integer_add, type_[whole], {choices, bit});
      floats = made(float_add, type_[real], {floats, some(real)});
      if (!has_doubles_) continue;
      floats =
          made(float_add, type_[real], {floats, made(float_convert, type_[real], {some(wide)})});
    }
    std::array<Id, 3> parts{values, memory, choices};
    for (Id& part : parts) {
      part = made(SpirvOp::bitwise_and, type_[whole], {part, low_bits_});
      part = made(convert_signed_to_float, type_[real], {part});
    }
    put(SpirvOp::store,
        {output_, made(composite_construct, vector_, {parts[0], parts[1], parts[2], floats})});
  }

  void make_main() {
    const Id main = id();
    Words entry;
    put(entry, SpirvOp::capability, {1});
    constexpr std::uint32_t kFloat64 = 10;
    put(entry, SpirvOp::capability, {kFloat64});
    put(entry, SpirvOp::memory_model, {0, 1});
    put(entry, SpirvOp::entry_point, {4, main, 0x6E69616D, 0, output_, coordinates_});
    put(entry, SpirvOp::execution_mode, {main, 7});
    head_.insert(head_.begin(), entry.begin(), entry.end());
    put(SpirvOp::function, {void_, main, 0, function_type_});
    known_ = {};
    returns_ = std::nullopt;
    begin(id());
    begin_locals();
    // Where few values differ between pixels, many do not: counters of loops, and what they make.
    const bool has_few = chance(50);
    const Id at = made(SpirvOp::load, vector_, {coordinates_});
    std::array<Id, 2> columns{};
    for (const std::uint32_t axis : {0u, 1u}) {
      const Id x = made(SpirvOp::composite_extract, type_[real], {at, axis});
      columns[axis] = made(SpirvOp::convert_float_to_signed, type_[whole], {x});
      if (has_few) continue;
      know(real, x);
      know(whole, columns[axis]);
    }
    for (const std::size_t most : {3u, 4u, 6u}) {
      if (has_few) {
        know(truth,
             made(SpirvOp::signed_less_than, type_[truth], {columns[0], constants_[whole][most]}));
      }
    }
    left_ = random_.whole(10, 80);
    statements(4, 16);
    if (block_ != 0) {
      store_output();
      put(SpirvOp::return_nothing, {});
    }
    put(SpirvOp::function_end, {});
  }
};

/// A module with a few words or instructions changed.
inline std::vector<std::uint32_t> damaged_spirv(std::vector<std::uint32_t> words, Random& random) {
  constexpr std::size_t kHead = 5;
  const auto place = [&] {
    return kHead + random.next() % std::max<std::size_t>(1, words.size() - kHead);
  };
  for (int changes = random.whole(1, 3); changes > 0 && words.size() > kHead; --changes) {
    const std::size_t at = place();
    switch (random.whole(0, 7)) {
      case 0: words[at] = words[place()]; break;
      case 1: words[at] = static_cast<std::uint32_t>(random.whole(0, 300)); break;
      case 2: words[at] ^= 1u << random.whole(0, 31); break;
      case 3: std::swap(words[at], words[place()]); break;
      case 4: words[at] += static_cast<std::uint32_t>(random.whole(-2, 2)); break;
      case 5: words[at] = std::array{~0u, 0x7FFFFFFFu, 0x80000000u}[random.next() % 3]; break;
      default: {  // a whole instruction goes, or stands somewhere else, too
        std::vector<std::size_t> begins;
        for (std::size_t i = kHead; i < words.size() && words[i] >> 16 != 0; i += words[i] >> 16) {
          begins.push_back(i);
        }
        if (begins.empty()) break;
        const auto begin = static_cast<std::ptrdiff_t>(begins[random.next() % begins.size()]);
        const auto length =
            static_cast<std::ptrdiff_t>(words[static_cast<std::size_t>(begin)] >> 16);
        if (begin + length > std::ssize(words)) break;
        const std::vector<std::uint32_t> one(words.begin() + begin, words.begin() + begin + length);
        if (random.whole(0, 1) == 0) {
          words.erase(words.begin() + begin, words.begin() + begin + length);
        } else {
          const auto to = static_cast<std::ptrdiff_t>(begins[random.next() % begins.size()]);
          words.insert(words.begin() + to, one.begin(), one.end());
        }
      }
    }
  }
  return words;
}

}  // namespace softfocus::test
