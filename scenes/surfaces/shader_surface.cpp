#include "scenes/surfaces/shader_surface.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "scenes/surfaces/lighting.h"

namespace softfocus {
namespace {

constexpr std::string_view kUsualVertex = R"(#version 330
in vec3 position;
in vec3 normal;
in vec2 uv;
in vec3 colour;
uniform mat4 modelMatrix, modelViewMatrix, modelViewProjectionMatrix;
uniform mat3 normalMatrix, worldNormalMatrix;
out vec2 vUv;
out vec3 vPosition, vNormal, vWorldPosition, vWorldNormal, vColour, vColor;
void main() {
  gl_Position = modelViewProjectionMatrix * vec4(position, 1.0);
  vUv = uv;
  vPosition = (modelViewMatrix * vec4(position, 1.0)).xyz;
  vNormal = normalize(normalMatrix * normal);
  vWorldPosition = (modelMatrix * vec4(position, 1.0)).xyz;
  vWorldNormal = normalize(worldNormalMatrix * normal);
  vColour = vColor = colour;
}
)";

/// All that a uniform may be given of.
struct KnownScene {
  const SurfaceVertexInput& input;
  glm::dmat4 to_world, world_to_eye, eye_to_clip;
  double frame;
  int width, height;
};

using Numbers = std::vector<float>;

// The product as scenes have it: binary64, summed over k = 0..3.
glm::dmat4 product(const glm::dmat4& a, const glm::dmat4& b) {
  glm::dmat4 made{0.0};
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      double sum = a[0][r] * b[c][0];
      for (int k = 1; k < 4; ++k) sum += a[k][r] * b[c][k];
      made[c][r] = sum;
    }
  }
  return made;
}

void add(Numbers& to, const glm::dmat4& m) {
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) to.push_back(static_cast<float>(m[c][r]));
  }
}
void add(Numbers& to, glm::vec3 v) { to.insert(to.end(), {v.x, v.y, v.z}); }

// Into the eye's space: its axes have length 1.
void add_eye_normals(Numbers& to, const KnownScene& of) {
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      double sum = 0.0;
      for (int k = 0; k < 3; ++k) {
        sum += of.world_to_eye[k][r] * static_cast<double>(of.input.normal_to_world[c][k]);
      }
      to.push_back(static_cast<float>(sum));
    }
  }
}

/// A uniform by its names: numbers one after the other, `rows` x `columns` of each element.
struct Known {
  std::array<std::string_view, 3> names;
  std::uint32_t rows, columns;
  bool is_array;
  void (*add)(Numbers& to, const KnownScene& of);
};

// The first names are those of docs/shaders.md; the others three.js', the compatibility profile's
// and those of surface.vert.
const std::array kKnown{
    Known{{"modelMatrix", "to_world"},
          4,
          4,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.to_world); }},
    Known{{"viewMatrix"},
          4,
          4,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.world_to_eye); }},
    Known{{"projectionMatrix", "gl_ProjectionMatrix"},
          4,
          4,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.eye_to_clip); }},
    Known{
        {"modelViewMatrix", "gl_ModelViewMatrix"},
        4,
        4,
        false,
        [](Numbers& to, const KnownScene& of) { add(to, product(of.world_to_eye, of.to_world)); }},
    Known{{"modelViewProjectionMatrix", "gl_ModelViewProjectionMatrix", "to_clip"},
          4,
          4,
          false,
          [](Numbers& to, const KnownScene& of) {
            add(to, product(of.eye_to_clip, product(of.world_to_eye, of.to_world)));
          }},
    Known{{"normalMatrix", "gl_NormalMatrix"}, 3, 3, false, add_eye_normals},
    Known{{"worldNormalMatrix", "normal_to_world"},
          3,
          3,
          false,
          [](Numbers& to, const KnownScene& of) {
            for (int c = 0; c < 3; ++c) add(to, of.input.normal_to_world[c]);
          }},
    Known{{"cameraPosition", "eye"},
          3,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.input.eye); }},
    Known{{"ambientLight", "ambient_light"},
          3,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.input.ambient_light); }},
    Known{{"lightCount", "light_count"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            to.push_back(static_cast<float>(of.input.lights.size()));
          }},
    Known{{"lightPosition", "light_position"},
          4,
          1,
          true,
          [](Numbers& to, const KnownScene& of) {
            for (const Light& light : of.input.lights) {
              add(to, light.position_or_direction);
              to.push_back(light.kind == LightKind::point ? 1.0f : 0.0f);
            }
          }},
    Known{{"lightColour", "light_colour"},
          3,
          1,
          true,
          [](Numbers& to, const KnownScene& of) {
            for (const Light& light : of.input.lights) add(to, light.colour);
          }},
    Known{{"materialAmbient", "material_ambient"},
          3,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.input.material->ambient); }},
    Known{{"materialDiffuse", "material_diffuse"},
          3,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.input.material->diffuse); }},
    Known{{"materialSpecular", "material_specular"},
          3,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { add(to, of.input.material->specular); }},
    Known{{"materialShininess", "material_shininess"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            to.push_back(static_cast<float>(of.input.material->shininess));
          }},
    Known{{"materialOpacity"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { to.push_back(of.input.material->opacity); }},
    Known{{"materialLit", "material_lit"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            to.push_back(of.input.material->lit ? 1.0f : 0.0f);
          }},
    Known{{"leastHighlight", "least_highlight"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            to.push_back(least_highlight(of.input.material->shininess));
          }},
    Known{{"frame"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) { to.push_back(static_cast<float>(of.frame)); }},
    Known{{"time"},
          1,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            constexpr double kFramesPerSecond = 24.0;
            to.push_back(static_cast<float>(of.frame / kFramesPerSecond));
          }},
    Known{{"resolution"},
          2,
          1,
          false,
          [](Numbers& to, const KnownScene& of) {
            to.push_back(static_cast<float>(of.width));
            to.push_back(static_cast<float>(of.height));
          }},
};

const Known* find_known(std::string_view name) {
  for (const Known& known : kKnown) {
    if (std::find(known.names.begin(), known.names.end(), name) != known.names.end()) return &known;
  }
  return nullptr;
}

/// "mat4", "vec3", "float"; of lights "vec4[]".
std::string type_text(const Known& known) {
  std::string text = known.rows == 1 ? "number" : known.columns > 1 ? "mat" : "vec";
  if (known.rows > 1) text += std::to_string(known.rows);
  if (known.is_array) text += "[]";
  return text;
}

std::uint32_t word_of(const ShaderUniform& of, float value) {
  if (of.kind == SpirvKind::boolean) return value != 0.0f ? ~0u : 0u;
  if (of.kind == SpirvKind::integer) return static_cast<std::uint32_t>(static_cast<int>(value));
  return std::bit_cast<std::uint32_t>(value);
}

std::vector<std::uint32_t> given_words(const ShaderUniforms& uniforms, const KnownScene& scene) {
  std::vector<std::uint32_t> words = uniforms.words;
  for (const ShaderUniform& of : uniforms.all) {
    const Known* known = find_known(of.name);
    if (known == nullptr) continue;
    Numbers numbers;
    known->add(numbers, scene);
    // A vec3 takes the beginning of a vec4.
    const std::size_t given = known->rows * known->columns, taken = of.rows * of.columns;
    const std::size_t elements = std::min(numbers.size() / given, of.words / taken);
    for (std::size_t e = 0; e < elements; ++e) {
      for (std::size_t i = 0; i < taken; ++i) {
        words[of.first + e * taken + i] = word_of(of, numbers[e * given + i]);
      }
    }
  }
  return words;
}

// --- attributes ---

enum class MeshPart : std::uint8_t { none, position, normal, uv, colour };

MeshPart part_of(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, MeshPart>, 13> kNames{
      {{"position", MeshPart::position},
       {"mesh_position", MeshPart::position},
       {"gl_Vertex", MeshPart::position},
       {"normal", MeshPart::normal},
       {"mesh_normal", MeshPart::normal},
       {"gl_Normal", MeshPart::normal},
       {"uv", MeshPart::uv},
       {"mesh_uv", MeshPart::uv},
       {"gl_MultiTexCoord0", MeshPart::uv},
       {"colour", MeshPart::colour},
       {"color", MeshPart::colour},
       {"mesh_colour", MeshPart::colour},
       {"gl_Color", MeshPart::colour}}};
  for (const auto& [known, part] : kNames) {
    if (known == name) return part;
  }
  return MeshPart::none;
}

template <class Value>
VertexAttribute attribute(int location, int components, std::span<const Value> of) {
  return {location, components, reinterpret_cast<const std::byte*>(of.data()), sizeof(Value)};
}

VertexAttribute attribute_of(const ShaderPort& port, const Mesh& mesh) {
  constexpr static glm::vec3 kWhite{1.0f};
  const int location = port.location;
  switch (part_of(port.name)) {
    case MeshPart::position: return attribute(location, 3, std::span{mesh.positions});
    case MeshPart::normal: return attribute(location, 3, std::span{mesh.normals});
    case MeshPart::uv:
      if (!mesh.uvs.empty()) return attribute(location, 2, std::span{mesh.uvs});
      break;
    case MeshPart::colour:
      if (!mesh.colours.empty()) return attribute(location, 3, std::span{mesh.colours});
      return {location, 3, reinterpret_cast<const std::byte*>(&kWhite), 0};
    case MeshPart::none: break;
  }
  return {location, 0, nullptr, 0};  // 0, 0, 0, 1
}

}  // namespace

std::string_view usual_surface_vertex() { return kUsualVertex; }

std::vector<bool> late_words(const ShaderUniforms& uniforms) {
  std::vector<bool> late(uniforms.words.size());
  for (const ShaderUniform& of : uniforms.all) {
    const Known* known = find_known(of.name);
    if (known == nullptr) continue;
    const bool fits = of.columns == known->columns &&
                      (known->columns > 1 ? of.rows == known->rows : of.rows <= known->rows) &&
                      (of.count == 0 || known->is_array);
    if (!fits) {
      throw ShaderError("the uniform '" + of.name + "' is given by the scene, as " +
                        type_text(*known) + "; another name would be right for another type");
    }
    for (std::uint32_t i = 0; i < of.words; ++i) late[of.first + i] = true;
  }
  return late;
}

void check_attributes(std::span<const ShaderPort> attributes) {
  for (const ShaderPort& port : attributes) {
    if (!port.is_used || part_of(port.name) != MeshPart::none) continue;
    throw ShaderError("the vertex shader reads '" + port.name +
                      "'; meshes have position, normal, uv and colour");
  }
}

ShaderDraw shader_draw(const SurfaceShaders& shaders, const SurfaceVertexInput& input,
                       const ShaderSurfaceMatrices& matrices, int width, int height) {
  KnownScene scene{
      input, matrices.to_world, matrices.world_to_eye, matrices.eye_to_clip, matrices.frame, width,
      height};
  // A user's clip space is OpenGL's: y upwards.
  for (int c = 0; c < 4; ++c) scene.eye_to_clip[c][1] = -scene.eye_to_clip[c][1];
  ShaderDraw draw{.vertex = shaders.vertex.program,
                  .fragment = shaders.fragment.program,
                  .vertex_uniforms = given_words(shaders.vertex.uniforms, scene),
                  .fragment_uniforms = given_words(shaders.fragment.uniforms, scene)};
  for (const ShaderPort& port : shaders.attributes) {
    draw.attributes.push_back(attribute_of(port, *input.mesh));
  }
  return draw;
}

}  // namespace softfocus
