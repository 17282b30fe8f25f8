// Seeds of the fuzz targets: small files of every kind, in FOLDER/TARGET.
//
//   fuzz_seeds FOLDER TESTS/DATA SCENES

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <string_view>

#include "raster/images/texel.h"
#include "tests/support/random_spirv.h"
#include "tools/files/profile_file.h"
#include "tools/pictures/exr_file.h"
#include "tools/pictures/png_text.h"
#include "tools/pictures/sums_file.h"
#include "tools/relief/relief_file.h"
#include "tools/sequence/journal.h"

#ifdef SOFTFOCUS_EXR_SEEDS
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>
#endif

namespace {

using namespace softfocus;
namespace fs = std::filesystem;

/// A folder of seeds.
class Seeds {
 public:
  Seeds(const fs::path& all, const std::string& target) : folder_(all / target) {
    fs::create_directories(folder_);
  }
  fs::path file(const std::string& name) const { return folder_ / name; }
  void put(const std::string& name, std::string_view text) const {
    std::ofstream{file(name), std::ios::binary} << text;
  }
  void put(const std::string& name, const Bytes& bytes) const {
    put(name, std::string_view{reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  void copy(const fs::path& from) const {
    fs::copy_file(from, file(from.filename().string()), fs::copy_options::overwrite_existing);
  }

 private:
  fs::path folder_;
};

constexpr int kWidth = 12, kHeight = 9;

/// Colours of a slope, depth in alpha.
Image small_picture() {
  Image image = make_image(Format::rgba16f, kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const auto i = static_cast<float>(y * kWidth + x);
      store_texel<Format::rgba16f>(image, x, y, {i / 108.0f, 0.5f, 1.0f - i / 216.0f, 1.0f + i},
                                   Profile{});
    }
  }
  return image;
}

PictureNotes small_notes() {
  return {.scene = "a scene",
          .frame = 3.0,
          .width = kWidth,
          .height = kHeight,
          .show = "image",
          .lens = NotedLens{},
          .method = {{"name", "two-pass"}, {"max_coc_px", 12.0}}};
}

/// A PNG whose pixels are not compressed, so that any change of them is one of the picture: of 8 or
/// 16 bits, grey (0), colour (2), by a palette (3), with alpha (4, 6).
Bytes stored_png(unsigned bits, unsigned kind) {
  constexpr unsigned kSide = 9;
  const unsigned channels = kind == 2 ? 3 : kind == 4 ? 2 : kind == 6 ? 4 : 1;
  const auto word = [](unsigned value) {
    return std::string{char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
  };
  std::string lines;
  for (unsigned y = 0; y < kSide; ++y) {
    lines += static_cast<char>(y % 5);  // each of the filters
    for (unsigned x = 0; x < kSide * channels * bits / 8; ++x)
      lines += static_cast<char>(x * y % 4);
  }
  const auto length = static_cast<unsigned>(lines.size());
  std::string stored{"\x78\x01\x01", 3};
  for (const unsigned value : {length, ~length}) {
    stored += {static_cast<char>(value), static_cast<char>(value >> 8)};
  }
  unsigned low = 1, high = 0;
  for (const char byte : lines) {
    low = (low + static_cast<unsigned char>(byte)) % 65521;
    high = (high + low) % 65521;
  }
  Bytes png;
  for (const char letter : kPngSignature) png.push_back(static_cast<std::byte>(letter));
  append_png_chunk(png, "IHDR",
                   word(kSide) + word(kSide) + char(bits) + char(kind) + word(0).substr(1));
  if (kind == 3) {
    append_png_chunk(png, "PLTE", std::string(12, 'p'));
    append_png_chunk(png, "tRNS", "abcd");
  }
  append_png_chunk(png, "IDAT", stored + lines + word(high << 16 | low));
  append_png_chunk(png, "IEND", "");
  return png;
}

void put_pictures(const fs::path& all, const fs::path& data) {
  const Image image = small_picture();
  const std::vector<float> plane(kWidth * kHeight, 0.75f);
  const Seeds png{all, "png"}, jpeg{all, "jpeg"}, hdr{all, "hdr"}, pfm{all, "pfm"}, npy{all, "npy"};
  png.put("8", encode_with_notes(image, FileFormat::png, small_notes()));
  png.put("16-alpha", encode_png_16(image, plane));
  png.put("grey-16", encode_depth(plane, kWidth, kHeight, FileFormat::png_16));
  for (const unsigned kind : {0u, 2u, 3u, 4u, 6u}) {
    png.put("stored-8-" + std::to_string(kind), stored_png(8, kind));
    if (kind != 3) png.put("stored-16-" + std::to_string(kind), stored_png(16, kind));
  }
#ifdef SOFTFOCUS_TIFF_SEEDS
  const Seeds tiff{all, "tiff"};
  tiff.put("colour", encode_tiff(image));
  tiff.put("alpha", encode_tiff(image, plane));
#endif
  jpeg.copy(data / "red-blue-16x8.jpg");
  hdr.put("colour", encode_hdr(image));
  pfm.put("colour", encode_pfm(image));
  pfm.put("grey", encode_grey_pfm(plane, kWidth, kHeight));
  npy.put("halves", encode_npy(image));
  npy.put("grey", encode_grey_npy(plane, kWidth, kHeight));
  npy.put("bytes", encode_npy(make_image(Format::rgba8, 3, 2)));
  const Seeds texture{all, "texture"};
  texture.put("8", encode_png(image));
  texture.put("16-alpha", encode_png_16(image, plane));
  texture.copy(data / "red-blue-16x8.jpg");
}

#ifdef SOFTFOCUS_EXR_SEEDS
Imf::Header exr_header(Imf::Compression compression) {
  Imf::Header header{kWidth, kHeight};
  header.compression() = compression;
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.channels().insert("layer.Z", Imf::Channel(Imf::FLOAT));
  header.channels().insert("id", Imf::Channel(Imf::UINT));
  return header;
}

/// All compressions, tiles and two parts.
void put_exr_files(const fs::path& all) {
  const Seeds exr{all, "exr"};
  const Image image = small_picture();
  const Bytes ours = encode_exr(image, ExrNumbers::half, "{\"a\": 1}", {.lens = ThinLens{}});
  exr.put("ours", ours);
  std::vector<std::uint32_t> numbers(kWidth * kHeight);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = static_cast<std::uint32_t>(0x3C003C00u + (i % 5) * 0x01000100u);
  }
  Imf::FrameBuffer buffer;
  const Imath::Box2i window{{0, 0}, {kWidth - 1, kHeight - 1}};
  buffer.insert("R", Imf::Slice::Make(Imf::HALF, numbers.data(), window, 4, 4 * kWidth));
  buffer.insert("layer.Z", Imf::Slice::Make(Imf::FLOAT, numbers.data(), window));
  buffer.insert("id", Imf::Slice::Make(Imf::UINT, numbers.data(), window));
  for (int i = 0; i < Imf::NUM_COMPRESSION_METHODS; ++i) {
    const auto compression = static_cast<Imf::Compression>(i);
    Imf::OutputFile rows{exr.file("rows-" + std::to_string(i)).c_str(), exr_header(compression)};
    rows.setFrameBuffer(buffer);
    rows.writePixels(kHeight);
    Imf::Header header = exr_header(compression);
    header.setTileDescription(Imf::TileDescription(8, 8));
    Imf::TiledOutputFile tiles{exr.file("tiles-" + std::to_string(i)).c_str(), header};
    tiles.setFrameBuffer(buffer);
    tiles.writeTiles(0, tiles.numXTiles() - 1, 0, tiles.numYTiles() - 1);
  }
  std::vector<Imf::Header> parts(2, exr_header(Imf::ZIP_COMPRESSION));
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].setName("part" + std::to_string(i));
    parts[i].setType(Imf::SCANLINEIMAGE);
  }
  Imf::MultiPartOutputFile file{exr.file("parts").c_str(), parts.data(), 2};
  for (int i = 0; i < 2; ++i) {
    Imf::OutputPart part{file, i};
    part.setFrameBuffer(buffer);
    part.writePixels(kHeight);
  }
}
#endif

void put_texts(const fs::path& all) {
  Seeds{all, "mtl"}.put("one",
                        "newmtl red\nKd 0.7 0 0\nKa 0 0 0\nKs 1 1 1\nNs 30\nd 0.5\nTr 0.5\n"
                        "map_Kd -s 1 1 a.png\nmap_d b.png\n# end\nnewmtl other\nd -halo 0.5\n");
  // A triangle that moves, with a skin, a morph target, a texture, a camera and a light.
  const Seeds gltf{all, "gltf"};
  gltf.put(
      "triangle",
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
      R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA"}],"bufferViews":[{"buffer":0,"byteLength":36},)"
      R"({"buffer":0,"byteLength":36,"byteStride":12}],"accessors":[{"bufferView":0,"componentType":5126,)"
      R"("count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"normalized":true,"count":3,)"
      R"("type":"VEC2"},{"bufferView":1,"componentType":5121,"count":3,"type":"VEC4"},{"componentType":5126,)"
      R"("count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},)"
      R"("values":{"bufferView":0}}},{"bufferView":0,"byteOffset":8,"componentType":5126,"count":2,)"
      R"("type":"SCALAR"},{"bufferView":0,"componentType":5126,"count":2,"type":"VEC3"}],"animations":[)"
      R"({"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},{"sampler":0,"target":)"
      R"({"node":1,"path":"scale"}}],"samplers":[{"input":4,"output":5}]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0,)"
      R"("TEXCOORD_0":1,"JOINTS_0":2,"WEIGHTS_0":2},"targets":[{"POSITION":3}],"material":0,"mode":4}],)"
      R"("weights":[0.5]}],"skins":[{"joints":[1]}],"nodes":[{"mesh":0,"skin":0,"children":[1,2]},)"
      R"({"rotation":[0,0,1,1],"scale":[1,-1,2],"camera":0},{"translation":[0,0,3],)"
      R"("extensions":{"KHR_lights_punctual":{"light":0}}}],"cameras":[{"type":"perspective",)"
      R"("perspective":{"yfov":0.7,"znear":0.1}}],"extensions":{"KHR_lights_punctual":{"lights":[)"
      R"({"type":"point","intensity":3}]}},"materials":[{"alphaMode":"MASK","emissiveFactor":[1,0,0],)"
      R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
      R"({"scale":[2,3]}}}}}],"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],)"
      R"("images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAD0lEQVR4)"
      R"(nGP4z8DwHwhTABBdA2K1LfSlAAAAAElFTkSuQmCC"}]})");
  gltf.put("binary", std::string{"glTF\2\0\0\0\x30\0\0\0\x1c\0\0\0JSON", 20} +
                         R"({"asset":{"version":"2.0"}} )");
  const Seeds obj{all, "obj"};
  obj.put("quad",
          "mtllib a.mtl\no thing\ng one\nusemtl red\ns 1\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0.5\n"
          "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\nf -1//-1 -2//-1 -3//-1\n");
  obj.put("plain", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1e3 2 -5\nf 1 2 3\nusemtl b\nf 2 3 4 \\\n 1\n");
  const std::string ply =
      "element vertex 3\nproperty uchar x\nproperty char y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty double s\n"
      "property ushort t\nelement face 1\nproperty list uchar uchar vertex_indices\n"
      "property list uchar uchar texcoord\nend_header\n";
  Seeds{all, "ply"}.put("text", "ply\nformat ascii 1.0\n" + ply +
                                    "0 0 0.5 1 2 3 0 0\n1 0 0 1 2 3 0 0\n0 1 -1e0 1 2 3 1 9\n"
                                    "3 0 1 2 6 0 0 0 1 1 0\n");
  std::string vertices(3 * 19, '\0');
  vertices[0] = vertices[20] = vertices[39] = 1;
  Seeds{all, "ply"}.put("binary", "ply\nformat binary_big_endian 1.0\n" + ply + vertices +
                                      std::string{"\3\0\1\2\0", 5});
  Seeds{all, "stl"}.put("text",
                        "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                        "vertex 0 1.5e0 0\nendloop\nendfacet\nendsolid\n");
  std::string facet(84 + 50, '\0');
  facet[80] = 1;
  facet[84 + 14] = facet[84 + 30] = facet[84 + 40] = '?';
  Seeds{all, "stl"}.put("binary", facet);
  Seeds{all, "profile"}.put("ieee", profile_text({"mine", "a profile", Profile{}}, "heading"));
  const Seeds notes{all, "notes"};
  notes.put("notes", json_text(notes_json(small_notes())));
  notes.put("json", "[1, -2.5e3, \"\\u00e9\\n\", {\"a\": [true, null]}]");
  const Seeds sequence{all, "sequence"};
  const std::string line = journal_line({12, 34, 56});
  sequence.put("journal", line.substr(0, line.size() - 1));
  sequence.put("range", "1..48:2");
  sequence.put("name", "out/frame_%04d.exr");
  sequence.put("glob", "fr*_[0-9]?.e[!a]r\nframe_12.exr");
  const Seeds options{all, "options"};
  options.put("lens",
              "a.exr\n-o\nb.png\n--focus\n1:2m 48:600cm\n--f-number\nf/1.8\n--keyframes\nsmooth\n"
              "--frames\n1..48\n--sensor\n23.5x15.6mm\n--highlights\n4,0.9");
  options.put("depth",
              "a.png\nb.png\n-ob.exr\n--depth-encoding\ndevice\n--near=0.1\n--far=100m\n"
              "--focus-range\n1m..3m\n--missing\n0\n--aperture-blades\n5\n--method\n"
              "aperture-scatter\n--anamorphic\n2\n--layer\na");
  options.put("method",
              "--\na.png\n--method=auto\n--max-error=0.1\n--blur-at-infinity\n9\n--shard\n1/4\n"
              "--max-coc\n12\n--threads\n2\n--border\nblack\n--arithmetic\nfixed-16\n-q\n-v");
  Seeds{all, "refocus"}.put("bytes", std::string(600, '\x3C'));
  Seeds{all, "fixed"}.put("bytes", std::string(300, '\x11'));
}

/// Both bits of depth, both cameras, with normals and without.
void put_reliefs(const fs::path& all) {
  const Seeds reliefs{all, "relief"};
  for (const int bits : {8, 16}) {
    ReliefTexture relief;
    relief.width = 20;
    relief.height = 12;
    relief.depth_bits = bits;
    for (std::uint16_t i = 0; i < 240; ++i) {
      relief.depths.push_back(i % 5 == 0 ? empty_depth(bits) : static_cast<std::uint16_t>(i));
      relief.colours.push_back(i % 5 == 0 ? 0 : 0xFF102030u * i | 0xFF000000u);
    }
    reliefs.put("plain-" + std::to_string(bits), encode_relief(relief));
    relief.normals.assign(240, 0x00FF8080u);
    relief.camera.eye = glm::dvec3{0.5, -0.5, 3.0};
    reliefs.put("eye-" + std::to_string(bits), encode_relief(relief));
  }
}

void put_sums(const fs::path& all) {
  write_sums_file(Seeds{all, "sums"}.file("small"), {1, 2},
                  {.picture = small_notes(), .samples = 64}, make_sample_sums(kWidth, kHeight),
                  make_image(Format::rgba16f, kWidth, kHeight));
}

void put_shaders(const fs::path& all) {
  const Seeds shaders{all, "shader"};
  constexpr std::uint64_t kCount = 40;
  for (std::uint64_t seed = 0; seed < kCount; ++seed) {
    Bytes bytes;
    for (const std::uint32_t word : test::RandomSpirv{seed}.words()) {
      for (int shift = 0; shift < 32; shift += 8) {
        bytes.push_back(static_cast<Bytes::value_type>(word >> shift & 0xFF));
      }
    }
    shaders.put(std::to_string(seed), bytes);
  }
}

/// The first byte is '0' + a number whose remainder by 6 is the convention's: 0 is recognised.
void put_glsl(const fs::path& all) {
  const Seeds glsl{all, "glsl"};
  const auto recognised = [&](const std::string& name, const std::string& text) {
    glsl.put(name, "0" + text);
  };
  recognised("old",
             "#define TWICE(a) ((a) + (a))\nuniform sampler2D t;\nvarying vec2 v;\n"
             "void main() { gl_FragColor = texture2D(t, TWICE(v)) * 0.5; }\n");
  recognised("new",
             "#version 330\nstruct Light { vec3 at; float power[2]; };\nuniform Light light;\n"
             "uniform sampler2D t;\nin vec2 v;\nout vec4 o;\n"
             "float f(inout vec2 p, int i) { p += light.at.xy; return light.power[i & 1]; }\n"
             "void main() {\n  vec2 p = v;\n  for (int i = 0; i < 4; ++i) {\n"
             "    if (f(p, i) > 1.0) continue;\n    o += textureLod(t, p, float(i));\n  }\n"
             "  switch (int(v.x * 4.0)) { case 0: o = -o; break; case 1: discard; default: o.x++; }"
             "\n}\n");
  recognised("es",
             "#version 300 es\nprecision mediump float;\nlayout(std140) uniform B { mat3 m; "
             "float a[3]; };\nout vec4 o;\nvoid main() {\n"
             "  mat3 n = inverse(m) * transpose(m);\n"
             "  o = vec4(n[1], a[int(n[0].x)]) + vec4(uintBitsToFloat(packHalf2x16(n[2].xy)));\n"
             "}\n");
  recognised("conditions",
             "#version 450\n#include \"a\"\n#if defined(A) && A##1 > 2 || !defined B\n"
             "#elif __VERSION__ == 450\n#else\n#error no\n#endif\n#line 7\nout vec4 o;\n"
             "const vec2 k[2][2] = vec2[][](vec2[](vec2(1), vec2(2)), vec2[](vec2(3), vec2(4)));\n"
             "void main() { o = k[0] == k[1] ? vec4(1) : dFdx(gl_FragCoord.yxwz); }\n");
  recognised("toy",
             "void mainImage(out vec4 c, in vec2 at) {\n  vec2 uv = at / iResolution.xy;\n"
             "  c = texture(iChannel0, uv) + sin(iTime) * vec4(mod(uv, 0.3), fract(uv));\n}\n");
  recognised("three",
             "#include <common>\n#include <packing>\nvarying vec2 vUv;\nuniform sampler2D tDepth;\n"
             "void main() { gl_FragColor = vec4(unpackRGBAToDepth(texture2D(tDepth, vUv))); }\n");
  recognised("transition",
             "uniform float size; // = 0.5\nvec4 transition(vec2 uv) {\n"
             "  return mix(getFromColor(uv), getToColor(uv), progress * size);\n}\n");
  recognised("libretro",
             "#pragma parameter GAIN \"Gain\" 1.0 0.5 2.0 0.05\n#if defined(VERTEX)\n"
             "#elif defined(FRAGMENT)\nuniform float GAIN;\n"
             "void main() { gl_FragColor = vec4(GAIN); }\n#endif\n");
  recognised("slang",
             "#version 450\nlayout(push_constant) uniform Push { vec4 SourceSize; } params;\n"
             "layout(set = 0, binding = 2) uniform sampler2D Source;\n#pragma stage fragment\n"
             "layout(location = 0) out vec4 o;\n"
             "void main() { o = texelFetch(Source, ivec2(params.SourceSize.xy), 0); }\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: fuzz_seeds FOLDER DATA SCENES\n";
    return 2;
  }
  const fs::path all = argv[1];
  put_pictures(all, argv[2]);
#ifdef SOFTFOCUS_EXR_SEEDS
  put_exr_files(all);
#endif
  put_texts(all);
  put_sums(all);
  put_reliefs(all);
  put_shaders(all);
  put_glsl(all);
  const Seeds scenes{all, "scene"};
  for (const fs::directory_entry& entry : fs::directory_iterator{argv[3]}) {
    if (entry.path().extension() == ".toml") scenes.copy(entry.path());
  }
  return 0;
}
