#include "raster/shaders/lower_spirv.h"

#include <algorithm>
#include <utility>

#include "raster/shaders/lowering.h"

namespace softfocus {
namespace {

// --- uniforms ---

class UniformCollector {
 public:
  UniformCollector(const SpirvModule& module, ShaderUniforms& to) : module_(module), to_(to) {}

  void add(const SpirvVariable& variable) {
    const SpirvId type = module_.type(variable.type).element;
    const auto found = module_.decorations.find(variable.id);
    std::string name = found == module_.decorations.end() ? "" : found->second.name;
    const auto of_type = module_.decorations.find(type);
    const bool is_block = of_type != module_.decorations.end() && of_type->second.is_block;
    if (is_block && !name.empty() && wraps_one(type)) {
      add(module_.type(type).members[0], name, false);
    } else {
      // A block without an instance's name: its members stand alone, as in GLSL.
      add(type, name, is_block && name.empty());
    }
    if (variable.initial == 0) return;
    const std::vector<std::uint32_t>& initial = module_.constants.at(variable.initial).words;
    std::copy(initial.begin(), initial.end(),
              to_.words.end() - static_cast<std::ptrdiff_t>(initial.size()));
  }

 private:
  const SpirvModule& module_;
  ShaderUniforms& to_;

  /// A block round a variable, as compilers of WGSL make it: a member that has no name of its own.
  bool wraps_one(SpirvId block) const {
    if (module_.type(block).members.size() != 1) return false;
    const auto found = module_.decorations.find(block);
    if (found == module_.decorations.end() || found->second.members.empty()) return true;
    const std::string& name = found->second.members[0].name;
    return name.empty() || name == "inner";
  }
  static bool is_texture(SpirvKind kind) {
    return kind == SpirvKind::sampled_image || kind == SpirvKind::image;
  }
  static bool is_number(SpirvKind kind) {
    return kind == SpirvKind::floating || kind == SpirvKind::integer || kind == SpirvKind::boolean;
  }

  void add(SpirvId id, const std::string& name, bool members_alone) {
    const SpirvType& type = module_.type(id);
    if (type.kind == SpirvKind::structure) {
      const auto found = module_.decorations.find(id);
      for (std::size_t i = 0; i < type.members.size(); ++i) {
        const bool has_name =
            found != module_.decorations.end() && i < found->second.members.size();
        const std::string member = has_name ? found->second.members[i].name : std::to_string(i);
        std::string full = members_alone ? "" : name;
        if (!members_alone) full += '.';
        add(type.members[i], full += member, false);
      }
      return;
    }
    if (type.kind == SpirvKind::array) {
      const SpirvKind kind = module_.type(type.element).kind;
      if (is_number(kind) || kind == SpirvKind::vector || kind == SpirvKind::matrix) {
        add_numbers(type.element, name, type.count, type.scalars);
        return;
      }
      for (std::uint32_t i = 0; i < type.count; ++i) {
        add(type.element, name + "[" + std::to_string(i) + "]", false);
      }
      return;
    }
    if (type.kind == SpirvKind::sampler) {
      grow(1, 0);  // the texture that it reads has its settings
    } else if (is_texture(type.kind)) {
      add_texture(type, name);
    } else {
      add_numbers(id, name, 0, type.scalars);
    }
  }

  void add_numbers(SpirvId id, const std::string& name, std::uint32_t count,
                   std::uint32_t scalars) {
    const SpirvType* type = &module_.type(id);
    ShaderUniform made{.name = name, .count = count, .words = scalars};
    if (type->kind == SpirvKind::matrix) {
      made.columns = type->count;
      type = &module_.type(type->element);
    }
    if (type->kind == SpirvKind::vector) {
      made.rows = type->count;
      type = &module_.type(type->element);
    }
    if (type->kind == SpirvKind::floating && type->scalars > 1) {
      throw ShaderError("uniform '" + name +
                        "' is of doubles, which is not supported; use float, or a uvec2 that "
                        "packDouble2x32() reads");
    }
    made.kind = type->kind;
    made.is_signed = type->is_signed;
    push(std::move(made), 0);
  }

  void add_texture(const SpirvType& type, const std::string& name) {
    ShaderUniform made{.name = name, .kind = type.kind, .words = type.scalars};
    const SpirvType& image = type.kind == SpirvKind::image ? type : module_.type(type.element);
    const SpirvType& texel = module_.type(image.element);
    made.dim = image.dim;
    made.shape = texture_shape(image);
    made.is_shadow = image.is_shadow;
    made.is_signed = texel.is_signed || texel.kind == SpirvKind::floating;
    push(std::move(made), to_.texture_count++);
  }

  void push(ShaderUniform made, std::uint32_t fill) {
    made.first = static_cast<std::uint32_t>(to_.words.size());
    grow(made.words, fill);
    to_.all.push_back(std::move(made));
  }

  void grow(std::uint32_t words, std::uint32_t fill) {
    if (to_.words.size() + words > kMostScalars) {
      throw ShaderError("the uniforms have more than " + std::to_string(kMostScalars) + " numbers");
    }
    to_.words.resize(to_.words.size() + words, fill);
  }
};

}  // namespace

ShaderUniforms uniforms_of(const SpirvModule& module) {
  ShaderUniforms made;
  UniformCollector collector{module, made};
  for (const auto& [id, variable] : module.variables) {
    if (is_uniform(variable.storage)) collector.add(variable);
  }
  return made;
}

// --- what main() is given and gives, and memory ---

void Lowering::lower() {
  std::uint32_t first_uniform = 0;
  for (const auto& [id, variable] : module_.variables) {
    const std::uint32_t scalars = module_.pointed(variable.type).scalars;
    const SpirvId type = module_.type(variable.type).element;
    using enum SpirvStorage;
    if (is_uniform(variable.storage)) {
      globals_[id] = {Pointee::In::uniforms, type, first_uniform};
      first_uniform += scalars;
    } else if (variable.storage == input) {
      globals_[id] = {Pointee::In::inputs, type, static_cast<std::uint32_t>(tree_.inputs.size())};
      add_inputs(type, decorations_of(id));
    } else {
      globals_[id] = {Pointee::In::variables, type, new_variables(scalars)};
      set_initial(tree_.main, globals_[id].first, scalars, variable.initial);
      if (variable.storage == output) add_outputs(globals_[id].first, type, decorations_of(id));
    }
  }
  late_inputs_ = static_cast<std::uint32_t>(tree_.inputs.size());
  for (std::size_t i = 0; i < is_late_.size(); ++i) {
    tree_.inputs.push_back({.uniform = static_cast<int>(i)});
  }
  Call main{.function = &module_.functions.at(module_.main)};
  run_call(main, tree_.main);
  for (const ShaderVariable variable : clamped_colours_) {
    const ShaderValue from_0 =
        make(tree_.main, ShaderOp::maximum, get(tree_.main, variable), constant(0.0f));
    set(tree_.main, variable, make(tree_.main, ShaderOp::minimum, from_0, constant(1.0f)));
  }
}

void Lowering::add_inputs(SpirvId id, const SpirvDecorations& of) {
  const bool is_vertex = module_.stage == ShaderStage::vertex;
  const SpirvType& what = type(id);
  if (what.kind == SpirvKind::structure) {
    for_each_member(id, of, [&](SpirvId member, SpirvDecorations with) {
      with.is_flat = with.is_flat || of.is_flat;
      with.is_linear = with.is_linear || of.is_linear;
      add_inputs(member, with);
    });
    return;
  }
  if (tree_.inputs.size() + what.scalars > kMostScalars) refuse("inputs have too many numbers");
  if (is_array_of_structures(id)) {
    for_each_structure(id, of,
                       [&](const SpirvDecorations& with) { add_inputs(what.element, with); });
    return;
  }
  const bool is_integer = has_integers(what);
  if (module_.has_doubles && holds_doubles(id) && (is_vertex || !of.is_flat)) {
    refuse(std::string{is_vertex ? "attributes" : "inputs that are not flat"} +
           " of doubles are not supported: '" + of.name + "'; use uvec2 and packDouble2x32()");
  }
  add_numbers(id, of, [&](int location, int component, int part) {
    tree_.inputs.push_back(
        {of.builtin, location, component, part, of.is_flat, of.is_linear, is_integer});
  });
}

void Lowering::add_outputs(std::uint32_t first, SpirvId id, const SpirvDecorations& of) {
  if (type(id).kind == SpirvKind::structure) {
    for_each_member(id, of, [&](SpirvId member, const SpirvDecorations& with) {
      add_outputs(first, member, with);
      first += scalars(member);
    });
    return;
  }
  if (is_array_of_structures(id)) {
    const SpirvId element = type(id).element;
    for_each_structure(id, of, [&](const SpirvDecorations& with) {
      add_outputs(first, element, with);
      first += scalars(element);
    });
    return;
  }
  if (module_.has_doubles && holds_doubles(id) && module_.stage == ShaderStage::fragment) {
    refuse("a pixel's output '" + of.name + "' is of doubles; float would be right");
  }
  const bool is_integer = has_integers(type(id));
  const bool is_clamped = of.name == "gl_FrontColor" || of.name == "gl_FrontSecondaryColor";
  add_numbers(id, of, [&](int location, int component, int) {
    if (is_clamped) clamped_colours_.push_back(first);
    tree_.outputs.push_back({of.builtin, location, component, first++, is_integer});
  });
}

bool Lowering::has_integers(const SpirvType& of) const {
  const SpirvType* number = &of;
  while (number->kind != SpirvKind::integer && number->element != 0) {
    number = &type(number->element);
  }
  return number->kind == SpirvKind::integer;
}

int Lowering::locations(SpirvId id) const {
  const SpirvType& what = type(id);
  if (what.kind == SpirvKind::array || what.kind == SpirvKind::matrix) {
    return static_cast<int>(what.count) * locations(what.element);
  }
  int sum = 0;
  for (const SpirvId member : what.members) sum += locations(member);
  // A location has four words.
  return what.kind == SpirvKind::structure ? sum : static_cast<int>(what.scalars + 3) / 4;
}

ShaderValue Lowering::load_one(ShaderRegion& to, const Pointee& at, std::uint32_t number) {
  const std::uint32_t place = at.first + number;
  const bool is_known = at.index == kNoValue;
  using enum Pointee::In;
  if (at.in == uniforms && is_any_late(at, place)) return load_input(to, at, late_inputs_ + place);
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

ShaderValue Lowering::load_input(ShaderRegion& to, const Pointee& at, std::uint32_t place) {
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

bool Lowering::is_any_late(const Pointee& at, std::uint32_t place) const {
  if (is_late_.empty()) return false;
  bool any = is_late_[place];
  for (std::uint32_t i = 1; i < at.count && at.index != kNoValue; ++i) {
    any = any || is_late_[place + i * at.stride];
  }
  return any;
}

std::uint32_t Lowering::uniform_table() {
  if (!uniform_table_) {
    uniform_table_ = static_cast<std::uint32_t>(tree_.tables.size());
    tree_.tables.insert(tree_.tables.end(), uniforms_.begin(), uniforms_.end());
  }
  return *uniform_table_;
}

Scalars Lowering::load(ShaderRegion& to, const Pointee& at) {
  Scalars values(scalars(at.type));
  for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = load_one(to, at, i);
  return values;
}

void Lowering::store(ShaderRegion& to, const Pointee& at, const Scalars& values) {
  if (at.in != Pointee::In::variables) damaged("what cannot be written is written");
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

Pointee Lowering::chain(ShaderRegion& to, Pointee at, const std::vector<ShaderValue>& indices) {
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
      const ShaderValue outer =
          make(to, ShaderOp::multiply_integers, clamped(to, at.index, at.count), whole(at.stride));
      const ShaderValue inner =
          make(to, ShaderOp::multiply_integers, clamped(to, index, of.count), whole(each));
      at.index = make(to, ShaderOp::add_integers, outer, inner);
      at.count = (at.count - 1) * at.stride + (of.count - 1) * each + 1;
      at.stride = 1;
    }
  }
  return at;
}

ShaderTree lower_spirv(const SpirvModule& module, std::span<const std::uint32_t> words,
                       const std::vector<bool>& is_late) {
  ShaderTree tree;
  Lowering{module, words, is_late, tree}.lower();
  return tree;
}

}  // namespace softfocus
