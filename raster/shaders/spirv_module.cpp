#include "raster/shaders/spirv_module.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <utility>

#include "raster/shaders/lowering.h"

namespace softfocus {
namespace {

using Operands = std::span<const std::uint32_t>;

constexpr std::uint32_t kSpirvMagic = 0x07230203, kSwappedMagic = 0x03022307;
constexpr std::uint32_t kMostIds = 1u << 22;

std::uint32_t with_bytes_swapped(std::uint32_t word) {
  return word >> 24 | (word >> 8 & 0xFF00) | (word << 8 & 0xFF0000) | word << 24;
}

[[noreturn]] void damaged_words(const std::string& why) {
  throw ShaderError("the SPIR-V is damaged: " + why);
}

/// Whether an instruction begins with its result's type, and whether it has a result.
struct Shape {
  bool has_type, has_result;
};

Shape shape_of(SpirvOp op) {
  using enum SpirvOp;
  switch (op) {
    case nop:
    case source_continued:
    case source:
    case source_extension:
    case name:
    case member_name:
    case line:
    case extension:
    case memory_model:
    case entry_point:
    case execution_mode:
    case capability:
    case function_end:
    case store:
    case copy_memory:
    case decorate:
    case member_decorate:
    case group_decorate:
    case group_member_decorate:
    case loop_merge:
    case selection_merge:
    case branch:
    case branch_conditional:
    case switch_case:
    case kill:
    case return_nothing:
    case return_value:
    case unreachable:
    case no_line:
    case module_processed:
    case terminate_invocation:
    case demote_to_helper_invocation: return {false, false};
    case string:
    case ext_inst_import:
    case type_void:
    case type_bool:
    case type_int:
    case type_float:
    case type_vector:
    case type_matrix:
    case type_image:
    case type_sampler:
    case type_sampled_image:
    case type_array:
    case type_runtime_array:
    case type_struct:
    case type_pointer:
    case type_function:
    case decoration_group:
    case label: return {false, true};
    default: return {true, true};
  }
}

bool ends_block(SpirvOp op) {
  using enum SpirvOp;
  return op == branch || op == branch_conditional || op == switch_case || op == kill ||
         op == return_nothing || op == return_value || op == unreachable ||
         op == terminate_invocation;
}

class Reader {
 public:
  explicit Reader(SpirvModule& to) : module_(to) {}

  void read() {
    const Operands words = module_.words;
    if (words.size() < 5 || words[0] != kSpirvMagic)
      damaged_words("it does not begin as SPIR-V does");
    if (words.size() > kMostSpirvWords) {
      throw ShaderError("the shader has " + std::to_string(words.size()) + " words; " +
                        std::to_string(kMostSpirvWords) + " are the most");
    }
    bound_ = words[3];
    if (bound_ == 0 || bound_ > kMostIds)
      damaged_words("its bound of ids is " + std::to_string(bound_));
    for (std::size_t at = 5; at < words.size();) {
      const std::size_t length = words[at] >> 16;
      if (length == 0 || length > words.size() - at)
        damaged_words("an instruction goes beyond its end");
      take(static_cast<SpirvOp>(words[at] & 0xFFFF), words.subspan(at + 1, length - 1));
      at += length;
    }
    if (function_ != nullptr) damaged_words("its last function has no end");
    if (module_.main == 0) {
      throw ShaderError("the SPIR-V has no entry point of a vertex or fragment shader");
    }
    for (const auto& [id, of] : module_.functions) check(of);
    if (!module_.functions.contains(module_.main)) damaged_words("its entry point is no function");
  }

 private:
  using enum SpirvOp;
  SpirvModule& module_;
  std::uint32_t bound_ = 0;
  std::set<SpirvId> defined_{};
  SpirvFunction* function_ = nullptr;
  SpirvBlock* block_ = nullptr;
  ShaderLine line_{};
  std::size_t constant_scalars_ = 0, members_ = 0;

  [[noreturn]] void refuse(const std::string& why) const {
    throw ShaderError(place_of(module_, line_) + why);
  }

  static std::uint32_t word(Operands operands, std::size_t at) {
    if (at >= operands.size()) damaged_words("an instruction is cut short");
    return operands[at];
  }
  /// The text from a word on, and the words that it takes.
  static std::pair<std::string, std::size_t> text(Operands operands, std::size_t at) {
    std::string text;
    for (std::size_t i = at; i < operands.size(); ++i) {
      for (int byte = 0; byte < 4; ++byte) {
        const auto c = static_cast<char>(operands[i] >> (8 * byte) & 0xFF);
        if (c == '\0') return {text, i + 1 - at};
        text += c;
      }
    }
    damaged_words("a text has no end");
  }

  /// One that is defined before: asked for before add_type(), or a type could consist of itself.
  SpirvId known_type(Operands operands, std::size_t at) const {
    const SpirvId id = word(operands, at);
    if (!module_.types.contains(id)) damaged_words("a type is used that is not there");
    return id;
  }
  std::uint32_t scalars_of(SpirvId type) const { return module_.types.at(type).scalars; }
  const SpirvConstant& constant_of(SpirvId id) const {
    const auto found = module_.constants.find(id);
    if (found == module_.constants.end()) damaged_words("a constant is used that is not there");
    return found->second;
  }

  void take(SpirvOp op, Operands operands) {
    SpirvInstruction in{.op = op, .line = line_};
    const Shape shape = shape_of(op);
    if (shape.has_type) {
      in.type = known_type(operands, 0);
      operands = operands.subspan(1);
    }
    if (shape.has_result) {
      in.result = word(operands, 0);
      if (in.result == 0 || in.result >= bound_) damaged_words("an id is beyond its bound");
      if (!defined_.insert(in.result).second) damaged_words("an id is defined twice");
      operands = operands.subspan(1);
    }
    in.operands = operands;
    if (op == line) {
      line_ = {word(operands, 0), word(operands, 1)};
    } else if (op == no_line) {
      line_ = {};
    } else if (function_ != nullptr) {
      take_in_function(in);
    } else if (!take_type(in) && (in.type == 0 || !take_constant(in))) {
      take_other(in);
    }
  }

  SpirvType& add_type(const SpirvInstruction& in, SpirvKind kind, std::uint32_t scalars) {
    SpirvType& type = module_.types[in.result];
    type.kind = kind;
    type.scalars = scalars;
    return type;
  }

  /// Checks what an array or structure consists of.
  void nest(SpirvType& outer, SpirvId inner) const {
    const SpirvType& of = module_.type(inner);
    if (of.scalars == 0) damaged_words("an array or structure consists of what holds no numbers");
    outer.depth = std::max(outer.depth, of.depth + 1);
    if (outer.depth > kDeepestTypes) refuse("structures are nested too deeply");
  }

  std::uint32_t checked_scalars(std::uint64_t count) const {
    if (count > kMostScalars) {
      refuse("an array or structure has " + std::to_string(count) + " numbers; " +
             std::to_string(kMostScalars) + " are the most");
    }
    return static_cast<std::uint32_t>(count);
  }

  bool take_type(const SpirvInstruction& in) {
    using enum SpirvKind;
    const Operands& w = in.operands;
    switch (in.op) {
      case type_void: add_type(in, none, 0); return true;
      case type_bool: add_type(in, boolean, 1); return true;
      case type_int:
        if (word(w, 0) != 32) {
          refuse("integers of " + std::to_string(word(w, 0)) + " bits are not supported; use int");
        }
        add_type(in, integer, 1).is_signed = word(w, 1) != 0;
        return true;
      case type_float:
        if (word(w, 0) != 32 && word(w, 0) != 64) {
          refuse("floats of " + std::to_string(word(w, 0)) + " bits are not supported; use float");
        }
        add_type(in, floating, word(w, 0) / 32);
        if (word(w, 0) == 64) module_.has_doubles = true;
        return true;
      case type_vector:
      case type_matrix: {
        const SpirvId element = known_type(w, 0);
        const std::uint32_t count = word(w, 1);
        const SpirvKind of = module_.type(element).kind;
        const bool fits =
            in.op == type_matrix ? of == vector : of == floating || of == integer || of == boolean;
        if (!fits || count < 2 || count > 4)
          damaged_words("a vector has parts that it cannot have");
        SpirvType& type =
            add_type(in, in.op == type_matrix ? matrix : vector, count * scalars_of(element));
        type.element = element;
        type.count = count;
        return true;
      }
      case type_image: {
        const SpirvId element = known_type(w, 0);
        SpirvType& type = add_type(in, image, 1);
        type.element = element;
        type.dim = static_cast<SpirvDim>(word(w, 1));
        type.is_shadow = word(w, 2) == 1;
        type.is_arrayed = word(w, 3) != 0;
        type.is_multisampled = word(w, 4) != 0;
        if (scalars_of(type.element) > 1) damaged_words("a texel has parts that it cannot have");
        if (word(w, 1) > 4) refuse("textures of buffers and input attachments are not supported");
        if (word(w, 5) == 2) refuse("images that a shader writes are not supported");
        return true;
      }
      case type_sampler: add_type(in, sampler, 1); return true;
      case type_sampled_image: {
        const SpirvId element = known_type(w, 0);
        if (module_.type(element).kind != image) damaged_words("a sampler has no image");
        add_type(in, sampled_image, 2).element = element;
        return true;
      }
      case type_array: {
        const SpirvId element = known_type(w, 0);
        const SpirvConstant& count = constant_of(word(w, 1));
        if (count.words.size() != 1 || count.words[0] == 0) damaged_words("an array has no length");
        SpirvType& type = add_type(
            in, array, checked_scalars(std::uint64_t{count.words[0]} * scalars_of(element)));
        type.element = element;
        type.count = count.words[0];
        nest(type, element);
        return true;
      }
      case type_runtime_array: refuse("arrays without a length, of buffers, are not supported");
      case type_struct: {
        std::uint64_t sum = 0;
        std::vector<SpirvId> members;
        for (std::size_t i = 0; i < w.size(); ++i) {
          members.push_back(known_type(w, i));
          sum += scalars_of(members.back());
        }
        SpirvType& type = add_type(in, structure, checked_scalars(sum));
        type.members = std::move(members);
        for (const SpirvId member : type.members) nest(type, member);
        return true;
      }
      case type_pointer: {
        const std::uint32_t storage = word(w, 0);
        const SpirvId element = known_type(w, 1);
        SpirvType& type = add_type(in, pointer, 0);
        type.element = element;
        type.storage = static_cast<SpirvStorage>(storage);
        if (storage == 12 || storage == 4 || storage == 5 || storage == 8 || storage == 10 ||
            storage > 12) {
          refuse("buffers and memory that a shader shares are not supported");
        }
        return true;
      }
      case type_function: {
        const SpirvId element = known_type(w, 0);
        std::vector<SpirvId> parameters;
        for (std::size_t i = 1; i < w.size(); ++i) parameters.push_back(known_type(w, i));
        SpirvType& type = add_type(in, SpirvKind::function, 0);
        type.element = element;
        type.members = std::move(parameters);
        return true;
      }
      default: return false;
    }
  }

  bool take_constant(const SpirvInstruction& in) {
    const auto is_kind = [&](SpirvKind kind) { return module_.type(in.type).kind == kind; };
    std::vector<std::uint32_t> words;
    constant_scalars_ += scalars_of(in.type);
    if (constant_scalars_ > kMostConstantScalars) refuse("constants have too many numbers");
    switch (in.op) {
      case constant_true:
      case spec_constant_true:
      case constant_false:
      case spec_constant_false:
        if (!is_kind(SpirvKind::boolean)) damaged_words("a constant is not of its type");
        words = {in.op == constant_true || in.op == spec_constant_true ? ~0u : 0u};
        break;
      case constant:
      case spec_constant:
        if (!is_kind(SpirvKind::integer) && !is_kind(SpirvKind::floating)) {
          damaged_words("a constant is not of its type");
        }
        for (std::size_t i = 0; i < scalars_of(in.type); ++i) words.push_back(word(in.operands, i));
        break;
      case constant_null:
      case undefined: words.assign(scalars_of(in.type), 0); break;
      case constant_composite:
      case spec_constant_composite:
        for (const SpirvId part : in.operands) {
          const SpirvConstant& of = constant_of(part);
          words.insert(words.end(), of.words.begin(), of.words.end());
          if (words.size() > kMostScalars) damaged_words("a constant has too many parts");
        }
        if (words.size() != scalars_of(in.type))
          damaged_words("a constant has not its type's parts");
        break;
      case spec_constant_op: words = computed_constant(in); break;
      default: return false;
    }
    module_.constants[in.result] = {in.type, std::move(words)};
    return true;
  }

  /// Of whole numbers and booleans, and which of two numbers of 32 bits: shaders have no others.
  std::vector<std::uint32_t> computed_constant(const SpirvInstruction& in) const {
    const Operands& w = in.operands;
    const auto op = static_cast<SpirvOp>(word(w, 0));
    const std::uint32_t scalars = scalars_of(in.type);
    if (op == composite_extract) {
      const SpirvConstant& whole = constant_of(word(w, 1));
      const std::uint64_t first = std::uint64_t{scalars} * word(w, 2);
      if (w.size() != 3 || module_.type(whole.type).element != in.type ||
          first + scalars > whole.words.size()) {
        refuse("constants that are parts of specialised ones are not supported");
      }
      const auto at = whole.words.begin() + static_cast<std::ptrdiff_t>(first);
      return {at, at + scalars};
    }
    const SpirvType& type = module_.type(in.type);
    const SpirvType& number = type.element == 0 ? type : module_.type(type.element);
    std::vector<std::uint32_t> words;
    for (std::uint32_t i = 0; i < scalars && number.scalars == 1; ++i) {
      std::vector<std::uint32_t> of;
      for (const SpirvId operand : w.subspan(1)) {
        const std::vector<std::uint32_t>& given = constant_of(operand).words;
        if (given.size() != 1 && given.size() != scalars) {
          damaged_words("a constant is computed of another size");
        }
        of.push_back(given[given.size() == 1 ? 0 : i]);
      }
      const bool chooses = op == select && of.size() == 3;
      const auto made = chooses ? std::optional{of[0] != 0 ? of[1] : of[2]} : fold_spirv_op(op, of);
      if (made) words.push_back(*made);
    }
    if (words.size() != scalars) {
      refuse("constants that instruction " + std::to_string(word(w, 0)) +
             " computes of specialised ones are not supported");
    }
    return words;
  }

  void take_other(const SpirvInstruction& in) {
    const Operands& w = in.operands;
    switch (in.op) {
      case name: decorations(w).name = text(w, 1).first; break;
      case member_name: member(w).name = text(w, 2).first; break;
      case decorate: add_decoration(decorations(w), w.subspan(1)); break;
      case member_decorate: add_decoration(member(w), w.subspan(2)); break;
      case string: module_.strings[in.result] = text(w, 0).first; break;
      case ext_inst_import:
        if (text(w, 0).first == "GLSL.std.450") module_.glsl = in.result;
        break;
      case entry_point: take_entry_point(w); break;
      case execution_mode: {
        constexpr std::uint32_t kUpperLeft = 7, kDepthReplacing = 12;
        if (word(w, 1) == kUpperLeft) module_.origin_is_upper_left = true;
        if (word(w, 1) == kDepthReplacing) module_.depth_replacing = true;
        break;
      }
      case capability: check_capability(word(w, 0)); break;
      case variable: module_.variables[in.result] = variable_of(in); break;
      case SpirvOp::function: begin_function(in); break;
      case source: {
        constexpr std::uint32_t kEs = 1, kGlsl = 2;
        const int version = static_cast<int>(word(w, 1) & 0xFFF);
        if (word(w, 0) == kEs) module_.es_version = version;
        if (word(w, 0) == kGlsl) module_.glsl_version = version;
        break;
      }
      case nop:
      case source_continued:
      case source_extension:
      case extension:
      case memory_model:
      case module_processed: break;
      default:
        damaged_words("instruction " + std::to_string(static_cast<int>(in.op)) +
                      " stands outside of functions, or is none that shaders have");
    }
  }

  void check_capability(std::uint32_t number) const {
    const auto is = [&](std::initializer_list<std::uint32_t> list) {
      return std::find(list.begin(), list.end(), number) != list.end();
    };
    if (is({3})) refuse("tessellation is not supported");
    if (is({11, 12, 21})) refuse("atomic counters and 64-bit integers are not supported");
  }

  void take_entry_point(Operands w) {
    constexpr std::uint32_t kVertex = 0, kGeometry = 3, kFragment = 4;
    const std::uint32_t model = word(w, 0);
    // Its capability says nothing: gl_PrimitiveID of a fragment shader has it, too.
    if (model == kGeometry) refuse("geometry shaders are not supported");
    if (model != kVertex && model != kFragment) {
      refuse("shaders of this stage are not supported; vertex and fragment shaders are");
    }
    if (module_.main != 0) refuse("the SPIR-V has several entry points; one is right");
    module_.stage = model == kVertex ? ShaderStage::vertex : ShaderStage::fragment;
    module_.main = word(w, 1);
  }

  SpirvDecorations& decorations(Operands w) {
    const SpirvId id = word(w, 0);
    if (id == 0 || id >= bound_) damaged_words("an id is beyond its bound");
    return module_.decorations[id];
  }
  SpirvDecorations& member(Operands w) {
    constexpr std::size_t kMostMembers = kMostScalars;
    SpirvDecorations& of = decorations(w);
    const std::uint32_t number = word(w, 1);
    if (number >= kMostMembers) damaged_words("a structure has too many members");
    if (of.members.size() <= number) {
      members_ += number + 1 - of.members.size();
      if (members_ > kMostMembers) damaged_words("structures have too many members");
      of.members.resize(number + 1);
    }
    return of.members[number];
  }

  static void add_decoration(SpirvDecorations& to, Operands w) {
    const auto number = [&] { return static_cast<int>(std::min(word(w, 1), kMostScalars)); };
    switch (static_cast<SpirvDecoration>(word(w, 0))) {
      using enum SpirvDecoration;
      case relaxed_precision: to.is_relaxed = true; break;
      case spec_id: to.constant = number(); break;
      case block: to.is_block = true; break;
      case row_major: to.is_row_major = true; break;
      case array_stride: to.array_stride = number(); break;
      case matrix_stride: to.matrix_stride = number(); break;
      case builtin: to.builtin = number(); break;
      case no_perspective: to.is_linear = true; break;
      case flat: to.is_flat = true; break;
      case invariant: to.is_invariant = true; break;
      case location: to.location = number(); break;
      case component: to.component = number(); break;
      case index: to.index = number(); break;
      case binding: to.binding = number(); break;
      case offset: to.offset = number(); break;
      default: break;
    }
  }

  SpirvVariable variable_of(const SpirvInstruction& in) const {
    SpirvVariable made{in.result, in.type, static_cast<SpirvStorage>(word(in.operands, 0)), 0};
    const SpirvType& pointer = module_.type(in.type);
    if (pointer.kind != SpirvKind::pointer || pointer.storage != made.storage) {
      damaged_words("a variable has no pointer's type");
    }
    if (in.operands.size() > 1) {
      made.initial = in.operands[1];
      if (constant_of(made.initial).type != pointer.element) {
        damaged_words("a variable begins with another type's value");
      }
    }
    return made;
  }

  void begin_function(const SpirvInstruction& in) {
    const SpirvId type = known_type(in.operands, 1);
    const SpirvType& of = module_.type(type);
    if (of.kind != SpirvKind::function || of.element != in.type) {
      damaged_words("a function is not of its type");
    }
    function_ = &module_.functions[in.result];
    function_->id = in.result;
    function_->type = type;
    function_->returns = in.type;
    block_ = nullptr;
  }

  void take_in_function(const SpirvInstruction& in) {
    switch (in.op) {
      case function_parameter:
        if (!function_->blocks.empty())
          damaged_words("a parameter stands behind a function's begin");
        function_->parameters.push_back(in);
        return;
      case label:
        if (block_ != nullptr) damaged_words("a block has no end");
        function_->block_of[in.result] = function_->blocks.size();
        function_->blocks.push_back({.label = in.result});
        block_ = &function_->blocks.back();
        return;
      case function_end:
        if (block_ != nullptr) damaged_words("a block has no end");
        function_ = nullptr;
        return;
      case nop: return;
      case undefined: take_constant(in); return;
      default: break;
    }
    if (block_ == nullptr) damaged_words("an instruction stands outside of a block");
    switch (in.op) {
      case variable: function_->variables.push_back(variable_of(in)); return;
      case selection_merge: block_->merge = word(in.operands, 0); return;
      case loop_merge:
        block_->merge = word(in.operands, 0);
        block_->continues = word(in.operands, 1);
        return;
      default: break;
    }
    block_->instructions.push_back(in);
    if (ends_block(in.op)) block_ = nullptr;
  }

  void check(const SpirvFunction& of) const {
    const SpirvType& type = module_.type(of.type);
    if (of.blocks.empty()) damaged_words("a function has no body");
    bool fits = of.parameters.size() == type.members.size();
    for (std::size_t i = 0; fits && i < type.members.size(); ++i) {
      fits = of.parameters[i].type == type.members[i];
    }
    if (!fits) damaged_words("a function has not its type's parameters");
    const auto check_label = [&](SpirvId id) {
      if (!of.block_of.contains(id)) damaged_words("a branch goes where no block is");
    };
    for (const SpirvBlock& block : of.blocks) {
      if (block.merge != 0) check_label(block.merge);
      if (block.continues != 0) check_label(block.continues);
      const SpirvInstruction& last = block.instructions.back();
      const Operands& w = last.operands;
      if (last.op == return_value) word(w, 0);
      if (last.op == branch) check_label(word(w, 0));
      if (last.op == branch_conditional) {
        check_label(word(w, 1));
        check_label(word(w, 2));
      }
      if (last.op == switch_case) {
        check_label(word(w, 1));
        if (w.size() % 2 != 0) damaged_words("a switch is cut short");
        for (std::size_t i = 3; i < w.size(); i += 2) check_label(w[i]);
      }
    }
  }
};

}  // namespace

std::vector<std::uint32_t> spirv_words(std::span<const std::byte> file) {
  if (file.size() % 4 != 0 || file.size() < 20)
    damaged_words("it has " + std::to_string(file.size()) + " bytes");
  std::vector<std::uint32_t> words(file.size() / 4);
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::uint32_t word = 0;
    for (std::size_t byte = 4; byte-- > 0;) {
      word = word << 8 | static_cast<std::uint32_t>(file[4 * i + byte]);
    }
    words[i] = word;
  }
  if (words[0] == kSwappedMagic) {
    for (std::uint32_t& word : words) word = with_bytes_swapped(word);
  }
  return words;
}

SpirvModule read_spirv(std::vector<std::uint32_t> words) {
  SpirvModule module;
  module.words = std::move(words);
  Reader{module}.read();
  return module;
}

std::string place_of(const std::map<SpirvId, std::string>& strings, ShaderLine line) {
  if (line.line == 0) return {};
  const auto file = strings.find(line.file);
  return (file == strings.end() ? "the shader" : file->second) + ":" + std::to_string(line.line) +
         ": ";
}

}  // namespace softfocus
