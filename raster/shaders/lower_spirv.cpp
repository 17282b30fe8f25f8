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
    // A block without an instance's name: its members stand alone, as in GLSL.
    add(type, name, is_block && name.empty());
    if (variable.initial == 0) return;
    const std::vector<std::uint32_t>& initial = module_.constants.at(variable.initial).words;
    std::copy(initial.begin(), initial.end(),
              to_.words.end() - static_cast<std::ptrdiff_t>(initial.size()));
  }

 private:
  const SpirvModule& module_;
  ShaderUniforms& to_;

  static bool is_texture(SpirvKind kind) {
    return kind == SpirvKind::sampled_image || kind == SpirvKind::image ||
           kind == SpirvKind::sampler;
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
    if (is_texture(type.kind)) {
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
    made.kind = type->kind;
    made.is_signed = type->is_signed;
    push(std::move(made), 0);
  }

  void add_texture(const SpirvType& type, const std::string& name) {
    ShaderUniform made{.name = name, .kind = type.kind, .words = type.scalars};
    if (type.kind != SpirvKind::sampler) {
      const SpirvType& image = type.kind == SpirvKind::image ? type : module_.type(type.element);
      const SpirvType& texel = module_.type(image.element);
      made.dim = image.dim;
      made.is_shadow = image.is_shadow;
      made.is_signed = texel.is_signed || texel.kind == SpirvKind::floating;
    }
    push(std::move(made), to_.texture_count++);
  }

  void push(ShaderUniform made, std::uint32_t fill) {
    made.first = static_cast<std::uint32_t>(to_.words.size());
    if (to_.words.size() + made.words > kMostScalars) {
      throw ShaderError("the uniforms have more than " + std::to_string(kMostScalars) + " numbers");
    }
    to_.words.resize(to_.words.size() + made.words, fill);
    to_.all.push_back(std::move(made));
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

ShaderTree lower_spirv(const SpirvModule& module, std::span<const std::uint32_t> words) {
  ShaderTree tree;
  Lowering{module, words, tree}.lower();
  return tree;
}

}  // namespace softfocus
