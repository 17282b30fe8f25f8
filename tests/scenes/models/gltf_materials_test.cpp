// Materials and textures of glTF models.

#include "scenes/models/gltf_materials.h"

#include <doctest/doctest.h>

#include <utility>

#include "raster/images/texel.h"
#include "tests/scenes/models/gltf_text.h"

using namespace softfocus;
using namespace softfocus::test;

TEST_CASE("a metallic-roughness material becomes Blinn-Phong's by the rule") {
  if (lacks_gltf()) return;
  const auto of = [](const std::string& text) {
    Gltf gltf = triangle("", ",\"material\":0");
    gltf.more = material(text);
    return load(gltf).materials[0];
  };
  const Material painted =
      of("\"name\":\"red\",\"doubleSided\":true,\"pbrMetallicRoughness\":{\"baseColorFactor\":"
         "[0.5,0.25,0,1],\"metallicFactor\":0.5,\"roughnessFactor\":0.5}");
  CHECK(painted.name == "red");
  CHECK(painted.two_sided);
  CHECK(painted.diffuse == glm::vec3{0.375f, 0.1875f, 0.0f});
  CHECK(painted.ambient == painted.diffuse);
  CHECK(painted.shininess == 30);  // 2 / 0.0625 - 2
  CHECK(painted.specular.x == 0.5f);
  CHECK(painted.specular.y == doctest::Approx(0.145 * 38 / 8 / 2));
  CHECK(painted.specular.z == doctest::Approx(0.02 * 38 / 8 / 2));
  CHECK(painted.opacity == 1.0f);
  const Material plain = of("\"pbrMetallicRoughness\":{}");
  CHECK(!plain.two_sided);
  CHECK(plain.diffuse == glm::vec3{0.5f});
  CHECK(plain.specular == glm::vec3{0.0f});  // as rough as can be
  CHECK(of("\"pbrMetallicRoughness\":{\"roughnessFactor\":0}").shininess == 1024);
  const Material unlit =
      of("\"extensions\":{\"KHR_materials_unlit\":{}},"
         "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.25,0,1]}");
  CHECK(!unlit.lit);
  CHECK(unlit.diffuse == glm::vec3{0.5f, 0.25f, 0.0f});
  const Material lamp =
      of("\"emissiveFactor\":[1,0.5,0],"
         "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1]}");
  CHECK(!lamp.lit);
  CHECK(lamp.diffuse == glm::vec3{1.0f, 0.5f, 0.0f});
}

TEST_CASE("textures have their places, their mode of alpha and their means") {
  if (lacks_gltf()) return;
  const auto of = [](const std::string& text, const std::string& uri) {
    Gltf gltf = triangle(",\"TEXCOORD_0\":1", ",\"material\":0");
    gltf.floats({0.25f, 0.5f, 1, 0, 0, 1}, "VEC2", 2);
    gltf.more = material(text) +
                ",\"textures\":[{\"source\":0,\"sampler\":0}],\"samplers\":[{"
                "\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728}],\"images\":[{\"uri\":\"" +
                uri + "\"}]";
    return load(gltf);
  };
  const std::string colour =
      "\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,1,1,0.5],"
      "\"baseColorTexture\":{\"index\":0}}";
  const Model opaque = of(colour, kTwoTexels);
  REQUIRE(opaque.materials[0].texture == 0u);
  CHECK(load_texel(opaque.textures[0].levels[0], 0, 0) == glm::vec4{1, 0, 0, 1});
  CHECK(opaque.materials[0].sampler.wrap_u == Wrap::clamp_to_edge);
  CHECK(opaque.materials[0].sampler.wrap_v == Wrap::mirrored_repeat);
  CHECK(opaque.materials[0].sampler.filter == Filter::nearest);
  CHECK(opaque.materials[0].opacity == 1.0f);
  CHECK(!opaque.materials[0].opacity_texture);

  const Model blended = of("\"alphaMode\":\"BLEND\"," + colour, kTwoTexels);
  CHECK(blended.materials[0].opacity == 0.5f);
  CHECK(!blended.materials[0].cut_out);
  const Image& opacity = blended.textures.at(*blended.materials[0].opacity_texture).levels[0];
  CHECK(load_texel(opacity, 1, 0).x == doctest::Approx(100.0 / 255.0));

  // 100 / 255 * 0.5 is below 0.3, and above 0.1.
  for (const auto& [cutoff, there] : {std::pair{"0.3", 0.0f}, std::pair{"0.1", 1.0f}}) {
    const Model masked = of(
        "\"alphaMode\":\"MASK\",\"alphaCutoff\":" + std::string{cutoff} + "," + colour, kTwoTexels);
    CHECK(masked.materials[0].cut_out);
    CHECK(masked.materials[0].opacity == 1.0f);
    const Image& mask = masked.textures.at(*masked.materials[0].opacity_texture).levels[0];
    CHECK(load_texel(mask, 0, 0).x == 1.0f);
    CHECK(load_texel(mask, 1, 0).x == there);
  }

  const Model placed =
      of("\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":{"
         "\"KHR_texture_transform\":{\"offset\":[0.5,0.25],\"scale\":[2,4],"
         "\"rotation\":1.5707963267948966}}}}",
         kTwoTexels);
  // (0.5, 2) turned: u' = v, v' = -u.
  CHECK(placed.parts[0].mesh.uvs[placed.parts[0].mesh.indices[0]] == glm::vec2{2.5f, -0.25f});

  // Roughness is the mean of green, 0.5; metallic that of blue, 0.
  const Model means =
      of("\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":{\"index\":0}}", kTwoTexels);
  CHECK(means.materials[0].diffuse == glm::vec3{1.0f});
  CHECK(means.materials[0].shininess == 30);

  Gltf sourceless = triangle("", ",\"material\":0");
  sourceless.more = material(colour) +
                    ",\"textures\":[{\"extensions\":{\"EXT_texture_webp\":{}}}]" +
                    ",\"extensionsUsed\":[\"EXT_texture_webp\"]";
  const Model without = load(sourceless);
  CHECK(warns(without, "texture 0 has no PNG or JPEG"));
  CHECK(warns(without, "EXT_texture_webp is not understood"));

  const Model missing = of(colour, "not%20there.png");
  CHECK(!missing.materials[0].texture);
  CHECK(warns(missing, "texture not%20there.png is missing"));
  const Model other = of(colour, "data:image/webp;base64,UklGRg==");
  CHECK(!other.materials[0].texture);
  CHECK(warns(other, "image 0 is neither PNG nor JPEG, and left out"));
}

TEST_CASE("a picture beside the model is found by its name with percents, and listed") {
  if (lacks_gltf()) return;
  const TemporaryDirectory directory;
  write_file(directory.file("a b.png"), png_bytes(4, 4));
  Gltf gltf = triangle("", ",\"material\":0");
  gltf.more = material("\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}") +
              ",\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"a%20b.png\"}]";
  write_file(directory.file("buffer.bin"), gltf.bytes + "padded");
  write_file(directory.file("model.gltf"), gltf.text("\"uri\":\"buffer.bin\","));
  const Model model = load_gltf_model(directory.file("model.gltf"));
  CHECK(model.textures.size() == 1);
  const std::vector<std::filesystem::path> files{
      directory.file("model.gltf"), directory.file("buffer.bin"), directory.file("a b.png")};
  CHECK(model.files == files);
}

TEST_CASE("a picture in a buffer is read, as .glb files have it, but not past its end") {
  if (lacks_gltf()) return;
  Gltf gltf = triangle("", ",\"material\":0");
  const std::string png = png_bytes(4, 2);
  const int view = gltf.view(png);
  gltf.more =
      material("\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}}") +
      ",\"textures\":[{\"source\":0}],\"images\":[{\"mimeType\":\"image/png\",\"bufferView\":" +
      std::to_string(view) + "}]";
  const Model model = load(gltf.binary(), "model.glb");
  REQUIRE(model.textures.size() == 1);
  CHECK(model.textures[0].levels[0].width == 4);
  CHECK(load_texel(model.textures[0].levels[0], 0, 0) == glm::vec4{1, 0, 0, 1});
  std::string text = gltf.text();
  const std::string length = "\"byteLength\":" + std::to_string(png.size());
  text.replace(text.find(length), length.size(), "\"byteLength\":99999");
  CHECK(complaint(text) ==
        "bufferView 1 is shorter than what is read from it, or its buffer ends before");
}

TEST_CASE("the opacity of vertex colours is told where it would count") {
  if (lacks_gltf()) return;
  for (const char* const mode : {"OPAQUE", "BLEND"}) {
    Gltf gltf = triangle(",\"COLOR_0\":1", ",\"material\":0");
    gltf.floats({1, 0, 0, 1, 1, 0, 0, 0.5f, 1, 0, 0, 1}, "VEC4", 4);
    gltf.more = material(std::string{"\"alphaMode\":\""} + mode + "\"");
    CHECK(warns(load(gltf), "the opacity of vertex colours") == (mode[0] == 'B'));
  }
}
