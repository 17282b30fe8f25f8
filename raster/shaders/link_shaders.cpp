#include "raster/shaders/link_shaders.h"

#include <algorithm>
#include <span>
#include <utility>

namespace softfocus {
namespace {

const SpirvDecorations& decorations_of(const SpirvModule& module, SpirvId id) {
  static const SpirvDecorations none;
  const auto found = module.decorations.find(id);
  return found == module.decorations.end() ? none : found->second;
}

const SpirvDecorations& decorations_of(const SpirvModule& module, SpirvId type,
                                       std::size_t member) {
  static const SpirvDecorations none;
  const SpirvDecorations& of = decorations_of(module, type);
  return member < of.members.size() ? of.members[member] : none;
}

bool is_used(const SpirvModule& module, SpirvId id) {
  for (const auto& [number, function] : module.functions) {
    for (const SpirvBlock& block : function.blocks) {
      for (const SpirvInstruction& in : block.instructions) {
        if (std::find(in.operands.begin(), in.operands.end(), id) != in.operands.end()) {
          return true;
        }
      }
    }
  }
  return false;
}

/// Ports of one storage of a module.
class Ports {
 public:
  Ports(const SpirvModule& module, SpirvStorage storage) : module_(module) {
    for (const auto& [id, variable] : module.variables) {
      if (variable.storage == storage) add(variable);
    }
  }
  std::vector<ShaderPort> all{};

 private:
  const SpirvModule& module_;

  void add(const SpirvVariable& variable) {
    const SpirvDecorations& of = decorations_of(module_, variable.id);
    const SpirvId type = module_.type(variable.type).element;
    const SpirvDecorations& of_type = decorations_of(module_, type);
    if (of.builtin >= 0) return;
    if (module_.type(type).kind != SpirvKind::structure || !of_type.is_block) {
      ShaderPort port{.name = of.name,
                      .location = of.location,
                      .component = of.component,
                      .is_used = is_used(module_, variable.id),
                      .of = variable.id};
      push(std::move(port), type);
      return;
    }
    int location = of.location;
    const SpirvType& block = module_.type(type);
    for (std::size_t i = 0; i < block.members.size(); ++i) {
      const SpirvDecorations& member = decorations_of(module_, type, i);
      if (member.builtin >= 0) continue;
      const bool is_ours = of_type.name.starts_with("gl_");
      ShaderPort port{.name = is_ours ? member.name : of_type.name + "." + member.name,
                      .location = member.location >= 0 ? member.location : location,
                      .component = member.component,
                      .is_used = is_used(module_, variable.id),
                      .of = type,
                      .member = static_cast<int>(i)};
      push(std::move(port), block.members[i]);
      if (all.back().location >= 0) location = all.back().location + all.back().locations;
    }
  }

  void push(ShaderPort port, SpirvId type) {
    port.locations = locations(type);
    add_numbers(type, port.numbers);
    all.push_back(std::move(port));
  }

  int locations(SpirvId id) const {
    const SpirvType& type = module_.type(id);
    if (type.kind == SpirvKind::array || type.kind == SpirvKind::matrix) {
      return static_cast<int>(type.count) * locations(type.element);
    }
    int sum = 0;
    for (const SpirvId member : type.members) sum += locations(member);
    return type.kind == SpirvKind::structure ? sum : static_cast<int>(type.scalars + 3) / 4;
  }

  void add_numbers(SpirvId id, std::vector<SpirvKind>& to) const {
    const SpirvType& type = module_.type(id);
    if (type.kind == SpirvKind::structure) {
      for (const SpirvId member : type.members) add_numbers(member, to);
    } else if (type.element == 0) {
      to.insert(to.end(), type.scalars, type.kind);
    } else {
      for (std::uint32_t i = 0; i < type.count; ++i) add_numbers(type.element, to);
    }
  }
};

/// The first location that no port has from there on.
int free_location(const std::vector<ShaderPort>& ports) {
  int free = 0;
  for (const ShaderPort& port : ports) {
    if (port.location >= 0) free = std::max(free, port.location + port.locations);
  }
  return free;
}

void set_location(SpirvModule& module, ShaderPort& port, int location) {
  SpirvDecorations* of = &module.decorations[port.of];
  if (port.member >= 0) {
    const auto member = static_cast<std::size_t>(port.member);
    if (of->members.size() <= member) of->members.resize(member + 1);
    of = &of->members[member];
  }
  of->location = port.location = location;
}

/// The name that a fragment shader's input has in the vertex shader.
std::string_view name_before(std::string_view name) {
  if (name == "gl_Color") return "gl_FrontColor";
  if (name == "gl_SecondaryColor") return "gl_FrontSecondaryColor";
  return name;
}

const std::string* name_of_kind(SpirvKind kind) {
  static const std::string floating = "floats", integer = "integers", boolean = "booleans";
  return kind == SpirvKind::floating ? &floating : kind == SpirvKind::integer ? &integer : &boolean;
}

std::string in_words(const ShaderPort& port) {
  return std::to_string(port.numbers.size()) + " " + *name_of_kind(port.numbers.front());
}

std::string named(const ShaderPort& port) {
  if (!port.name.empty()) return "'" + port.name + "'";
  return "location " + std::to_string(port.location);
}

[[noreturn]] void refuse_input(const ShaderPort& input, const std::vector<ShaderPort>& outputs) {
  std::string why = "the vertex shader has no output " + named(input) +
                    ", which the fragment shader reads; it has ";
  if (outputs.empty()) why += "none";
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (i != 0) why += ", ";
    why += named(outputs[i]);
  }
  throw ShaderError(why);
}

/// Types of two modules. Outside of blocks arrays may have other lengths: one that the shader does
/// not say is what it uses.
struct TypePair {
  const SpirvModule &ours, &theirs;
  bool of_block = false;
  bool with_precision = false;

  bool is_same(SpirvId our, SpirvId their) const {
    const SpirvType &a = ours.type(our), &b = theirs.type(their);
    const bool is_number = a.element == 0 && a.members.empty();
    if (a.kind != b.kind || (is_number && a.scalars != b.scalars) || a.is_signed != b.is_signed ||
        a.dim != b.dim || a.is_arrayed != b.is_arrayed || a.is_shadow != b.is_shadow ||
        ((of_block || a.kind != SpirvKind::array) && a.count != b.count) ||
        a.members.size() != b.members.size() || (a.element == 0) != (b.element == 0)) {
      return false;
    }
    for (std::size_t i = 0; i < a.members.size(); ++i) {
      const SpirvDecorations &c = decorations_of(ours, our, i),
                             &d = decorations_of(theirs, their, i);
      if (c.name != d.name || (of_block && c.is_row_major != d.is_row_major) ||
          (with_precision && c.is_relaxed != d.is_relaxed) ||
          !is_same(a.members[i], b.members[i])) {
        return false;
      }
    }
    return a.element == 0 || is_same(a.element, b.element);
  }
};

struct NamedVariable {
  std::string name{};  ///< of a block its own, not its instance's
  SpirvId type = 0;
  bool is_block = false;
  SpirvId id = 0;
};

template <class IsWanted>
std::vector<NamedVariable> variables_of(const SpirvModule& module, const IsWanted& is_wanted) {
  std::vector<NamedVariable> made;
  for (const auto& [id, variable] : module.variables) {
    if (!is_wanted(variable.storage)) continue;
    const SpirvId type = module.type(variable.type).element;
    SpirvId inner = type;
    while (module.type(inner).kind == SpirvKind::array) inner = module.type(inner).element;
    const SpirvDecorations& of_type = decorations_of(module, inner);
    const std::string& name = of_type.is_block ? of_type.name : decorations_of(module, id).name;
    if (!name.empty()) made.push_back({name, type, of_type.is_block, id});
  }
  return made;
}

/// Calls check(our, their) for variables of one name.
template <class Check>
void for_pairs(const std::vector<NamedVariable>& ours, const std::vector<NamedVariable>& theirs,
               const Check& check) {
  for (const NamedVariable& our : ours) {
    if (our.name.starts_with("gl_")) continue;
    for (const NamedVariable& their : theirs) {
      if (their.name == our.name) check(our, their);
    }
  }
}

[[noreturn]] void refuse_pair(const std::string& name, const char* what) {
  throw ShaderError("'" + name + "' has another " + what +
                    " in the vertex shader than in the fragment shader; they must be equal");
}

/// Variables of one name must be of one type; with ES, uniforms of one precision: those of 1.00 if
/// both shaders use them.
void check_uniforms(const SpirvModule& vertex, const SpirvModule& fragment) {
  constexpr int kLastWithUnused = 100;
  const auto is_uniform = [](SpirvStorage storage) {
    return storage == SpirvStorage::uniform || storage == SpirvStorage::uniform_constant;
  };
  const bool is_es = vertex.es_version != 0 && fragment.es_version != 0;
  for_pairs(variables_of(vertex, is_uniform), variables_of(fragment, is_uniform),
            [&](const NamedVariable& our, const NamedVariable& their) {
              TypePair types{vertex, fragment, our.is_block && their.is_block};
              if (!types.is_same(our.type, their.type)) refuse_pair(our.name, "type");
              if (!is_es || (fragment.es_version <= kLastWithUnused &&
                             !(is_used(vertex, our.id) && is_used(fragment, their.id)))) {
                return;
              }
              types.with_precision = true;
              if (decorations_of(vertex, our.id).is_relaxed !=
                      decorations_of(fragment, their.id).is_relaxed ||
                  !types.is_same(our.type, their.type)) {
                refuse_pair(our.name, "precision");
              }
            });
}

bool is_invariant(const SpirvModule& module, SpirvBuiltin builtin) {
  const auto is_it = [&](const SpirvDecorations& of) {
    return of.builtin == static_cast<int>(builtin) && of.is_invariant;
  };
  return std::any_of(module.decorations.begin(), module.decorations.end(), [&](const auto& pair) {
    const SpirvDecorations& of = pair.second;
    return is_it(of) || std::any_of(of.members.begin(), of.members.end(), is_it);
  });
}

/// Types as of uniforms; how they are interpolated up to GLSL 4.30 and with ES. What is invariant
/// may differ: of `#pragma STDGL invariant(all)` the SPIR-V says nothing.
void check_varyings(const SpirvModule& vertex, const SpirvModule& fragment) {
  constexpr int kLastWithInterpolation = 430;
  const bool has_interpolation =
      fragment.es_version != 0 ||
      (fragment.glsl_version != 0 && fragment.glsl_version <= kLastWithInterpolation);
  const auto outputs =
      variables_of(vertex, [](SpirvStorage storage) { return storage == SpirvStorage::output; });
  const auto inputs =
      variables_of(fragment, [](SpirvStorage storage) { return storage == SpirvStorage::input; });
  for_pairs(outputs, inputs, [&](const NamedVariable& our, const NamedVariable& their) {
    if (!TypePair{vertex, fragment, our.is_block && their.is_block}.is_same(our.type, their.type)) {
      refuse_pair(our.name, "type");
    }
    const SpirvDecorations& a = decorations_of(vertex, our.id);
    const SpirvDecorations& b = decorations_of(fragment, their.id);
    if (has_interpolation && (a.is_flat != b.is_flat || a.is_linear != b.is_linear)) {
      refuse_pair(our.name, "interpolation");
    }
  });
}

/// With ES 1.00 gl_FragCoord and gl_PointCoord are invariant only if gl_Position and gl_PointSize
/// are.
void check_invariant_places(const SpirvModule& vertex, const SpirvModule& fragment) {
  constexpr int kLastEsWithInvariant = 100;
  if (fragment.es_version == 0 || fragment.es_version > kLastEsWithInvariant) return;
  if (is_invariant(fragment, SpirvBuiltin::frag_coord) &&
      !is_invariant(vertex, SpirvBuiltin::position)) {
    throw ShaderError("gl_FragCoord is invariant, and gl_Position is not; both are, or none");
  }
  if (is_invariant(fragment, SpirvBuiltin::point_coord) &&
      !is_invariant(vertex, SpirvBuiltin::point_size)) {
    throw ShaderError("gl_PointCoord is invariant, and gl_PointSize is not; both are, or none");
  }
}

/// Whether some instruction names gl_Position: by itself, or as a block's member.
bool uses_position(const SpirvModule& module) {
  const auto is_position = [](const SpirvDecorations& of) {
    return of.builtin == static_cast<int>(SpirvBuiltin::position);
  };
  const auto names = [&](const SpirvInstruction& in, const SpirvVariable& variable) {
    const auto at = std::find(in.operands.begin(), in.operands.end(), variable.id);
    if (at == in.operands.end()) return false;
    const auto found = module.decorations.find(module.type(variable.type).element);
    const bool is_whole = in.op != SpirvOp::access_chain || std::next(at) == in.operands.end();
    if (is_whole || found == module.decorations.end()) return true;
    const auto member = module.constants.find(*std::next(at));
    const std::vector<SpirvDecorations>& members = found->second.members;
    return member == module.constants.end() || member->second.words.front() >= members.size() ||
           is_position(members[member->second.words.front()]);
  };
  for (const auto& [id, variable] : module.variables) {
    if (variable.storage != SpirvStorage::output) continue;
    const SpirvDecorations& block = decorations_of(module, module.type(variable.type).element);
    if (!is_position(decorations_of(module, id)) &&
        std::none_of(block.members.begin(), block.members.end(), is_position)) {
      continue;
    }
    for (const auto& [number, function] : module.functions) {
      for (const SpirvBlock& in_block : function.blocks) {
        for (const SpirvInstruction& in : in_block.instructions) {
          if (names(in, variable)) return true;
        }
      }
    }
  }
  return false;
}

/// What a uniform is unless it is set may stand in either shader.
void share_initial_values(ShaderUniforms& vertex, ShaderUniforms& fragment) {
  for (const ShaderUniform& ours : vertex.all) {
    const auto theirs =
        std::find_if(fragment.all.begin(), fragment.all.end(),
                     [&](const ShaderUniform& other) { return other.name == ours.name; });
    if (theirs == fragment.all.end() || theirs->words != ours.words || is_texture(ours)) continue;
    const std::span a{vertex.words.data() + ours.first, ours.words};
    const std::span b{fragment.words.data() + theirs->first, ours.words};
    const auto is_zero = [](std::uint32_t word) { return word == 0; };
    if (std::all_of(a.begin(), a.end(), is_zero)) {
      std::copy(b.begin(), b.end(), a.begin());
    } else if (std::all_of(b.begin(), b.end(), is_zero)) {
      std::copy(a.begin(), a.end(), b.begin());
    }
  }
}

/// Arrays of the compatibility profile are as long as the shader uses them.
bool fits(const ShaderPort& output, const ShaderPort& input) {
  return output.numbers == input.numbers ||
         (input.name.starts_with("gl_") && output.numbers.front() == input.numbers.front());
}

}  // namespace

std::vector<ShaderPort> inputs_of(const SpirvModule& module) {
  return Ports{module, SpirvStorage::input}.all;
}
std::vector<ShaderPort> outputs_of(const SpirvModule& module) {
  return Ports{module, SpirvStorage::output}.all;
}

void give_locations(SpirvModule& module) {
  std::vector<ShaderPort> ports =
      module.stage == ShaderStage::vertex ? inputs_of(module) : outputs_of(module);
  for (ShaderPort& port : ports) {
    if (port.location < 0) set_location(module, port, free_location(ports));
  }
}

void link_shaders(UserShader& vertex, UserShader& fragment) {
  if (vertex.module->stage != ShaderStage::vertex ||
      fragment.module->stage != ShaderStage::fragment) {
    throw ShaderError("a vertex shader and a fragment shader are right, in this order");
  }
  // Later versions and ES leave both open: a place, and what a pixel reads.
  constexpr int kLastWithPlace = 130, kLastWithVaryings = 120;
  const auto is_at_most = [](const UserShader& shader, int last) {
    return shader.module->glsl_version != 0 && shader.module->glsl_version <= last;
  };
  if (is_at_most(vertex, kLastWithPlace) && !uses_position(*vertex.module)) {
    throw ShaderError("the vertex shader never writes gl_Position; without it nothing is drawn");
  }
  check_uniforms(*vertex.module, *fragment.module);
  share_initial_values(vertex.uniforms, fragment.uniforms);
  std::vector<ShaderPort> outputs = outputs_of(*vertex.module);
  std::vector<ShaderPort> inputs = inputs_of(*fragment.module);
  int free = std::max(free_location(outputs), free_location(inputs));
  for (ShaderPort& input : inputs) {
    const auto by_location = [&](const ShaderPort& output) {
      return input.location >= 0 && output.location == input.location &&
             output.component == input.component;
    };
    const auto by_name = [&](const ShaderPort& output) {
      return !input.name.empty() && output.name == name_before(input.name);
    };
    auto found = std::find_if(outputs.begin(), outputs.end(), by_location);
    if (found == outputs.end()) found = std::find_if(outputs.begin(), outputs.end(), by_name);
    if (found == outputs.end()) {
      if (input.is_used) refuse_input(input, outputs);
      if (input.location < 0) {
        set_location(*fragment.module, input, free);
        free += input.locations;
      }
      continue;
    }
    if (input.is_used && !found->is_used && is_at_most(fragment, kLastWithVaryings)) {
      throw ShaderError("the vertex shader never writes " + named(*found) +
                        ", which the fragment shader reads");
    }
    if (!fits(*found, input)) {
      throw ShaderError(named(input) + " has " + in_words(*found) + " in the vertex shader and " +
                        in_words(input) + " in the fragment shader; they must be equal");
    }
    if (found->location < 0) {
      const int location = input.location >= 0 ? input.location : free;
      set_location(*vertex.module, *found, location);
      if (location == free) free += std::max(found->locations, input.locations);
    }
    if (input.location != found->location) {
      set_location(*fragment.module, input, found->location);
    }
  }
  check_varyings(*vertex.module, *fragment.module);
  check_invariant_places(*vertex.module, *fragment.module);
  for (ShaderPort& output : outputs) {
    if (output.location >= 0) continue;
    set_location(*vertex.module, output, free);
    free += output.locations;
  }
}

ShaderPair make_shader_pair(std::vector<std::uint32_t> vertex_words,
                            std::vector<std::uint32_t> fragment_words) {
  ShaderPair made{make_shader(std::move(vertex_words)), make_shader(std::move(fragment_words))};
  link_shaders(made.vertex, made.fragment);
  return made;
}

}  // namespace softfocus
