#include "tools/crosscheck/probe.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include "raster/images/texel.h"
#include "raster/numbers/lerp.h"
#include "tools/cli/option_values.h"
#include "tools/crosscheck/cases.h"
#include "tools/gl/objects.h"

namespace softfocus {
namespace {

// The driver, and the cases by which it is compared with one profile after another.
struct ProbedDriver {
  const GlContext& gl;
  Shaders shaders;
  ThreadPool& pool;
  std::vector<Case> cases = crosscheck_cases();
};

Tally run(ProbedDriver& driver, const std::vector<std::string>& names, const Profile& profile) {
  Tally tally;
  for (const std::string& name : names) {
    const auto found = std::find_if(driver.cases.begin(), driver.cases.end(), [&](const Case& one) {
      return one.stage + '/' + one.name == name;
    });
    found->run({driver.gl, driver.shaders, profile, driver.pool}, tally);
  }
  return tally;
}

struct ProfileCandidate {
  std::string name;
  Profile profile;
};

std::string out_of(const Tally& tally) {
  return std::to_string(tally.differing) + " of " + std::to_string(tally.values);
}

// Takes the candidate under which the least differs from the driver; the first of equals.
ProbeFinding choose(ProbedDriver& driver, const std::string& question,
                    const std::vector<std::string>& cases,
                    const std::vector<ProfileCandidate>& candidates, Profile& profile) {
  ProbeFinding finding{question, "", ""};
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  std::string rest;
  for (const ProfileCandidate& candidate : candidates) {
    const Tally tally = run(driver, cases, candidate.profile);
    if (tally.differing < least) {
      least = tally.differing;
      profile = candidate.profile;
      finding.answer = candidate.name;
    }
    rest += (rest.empty() ? "" : ", ") + candidate.name + ' ' + out_of(tally);
    if (tally.differing == 0) break;
  }
  finding.evidence = "differing values: " + rest;
  return finding;
}

// `profile` with a member set to each of some values.
template <class Value>
std::vector<ProfileCandidate> variants(const Profile& profile, Value Profile::*member,
                                       const std::vector<std::pair<Value, const char*>>& values) {
  std::vector<ProfileCandidate> candidates;
  for (const auto& [value, name] : values) {
    candidates.push_back({name, profile});
    candidates.back().profile.*member = value;
  }
  return candidates;
}

std::vector<ProfileCandidate> texture_candidates(const Profile& profile) {
  std::vector<ProfileCandidate> candidates;
  const auto add = [&](const char* name, TextureUnit unit, BilinearWeights weights,
                       Contraction lerp) -> Profile& {
    candidates.push_back({name, profile});
    candidates.back().profile.texture_unit = unit;
    candidates.back().profile.bilinear_weights = weights;
    candidates.back().profile.lerp = lerp;
    return candidates.back().profile;
  };
  using enum Contraction;
  add("plain, 8-bit weights, unfused", TextureUnit::standard, BilinearWeights::fixed_8, unfused);
  add("plain, 8-bit weights, fused", TextureUnit::standard, BilinearWeights::fixed_8, fused);
  add("plain, in integers", TextureUnit::standard, BilinearWeights::fixed_8, unfused)
      .bilinear_filter = BilinearFilter::integers;
  add("plain, float weights, unfused", TextureUnit::standard, BilinearWeights::binary32, unfused);
  add("plain, float weights, fused", TextureUnit::standard, BilinearWeights::binary32, fused);
  add("llvmpipe, unfused", TextureUnit::llvmpipe, BilinearWeights::binary32, unfused);
  add("llvmpipe, fused", TextureUnit::llvmpipe, BilinearWeights::binary32, fused);
  add("softpipe, unfused", TextureUnit::softpipe, BilinearWeights::binary32, unfused);
  add("SwiftShader, unfused", TextureUnit::swiftshader, BilinearWeights::binary32, unfused);
  return candidates;
}

std::vector<ProfileCandidate> coverage_candidates(const Profile& profile) {
  std::vector<ProfileCandidate> candidates;
  for (const int bits : {8, 7, 6, 5, 4}) {
    for (const FillRule rule : {FillRule::upper_left, FillRule::lower_left}) {
      candidates.push_back({std::to_string(bits) + " subpixel bits, " +
                                (rule == FillRule::upper_left ? "upper-left" : "lower-left"),
                            profile});
      candidates.back().profile.subpixel_bits = bits;
      candidates.back().profile.fill_rule = rule;
    }
  }
  candidates.push_back({"scanlines", profile});
  candidates.back().profile.coverage = Coverage::scanlines;
  candidates.back().profile.attributes = AttributeSetup::planes_by_quad;
  return candidates;
}

std::vector<ProfileCandidate> attribute_candidates(const Profile& profile) {
  if (profile.coverage == Coverage::scanlines) return {{"planes by quad", profile}};
  std::vector<ProfileCandidate> candidates;
  for (const Contraction viewport : {Contraction::unfused, Contraction::fused}) {
    const auto add = [&](const std::string& name, AttributeSetup setup, Contraction interpolation) {
      const char* window = viewport == Contraction::fused ? ", fused viewport" : "";
      candidates.push_back({name + window, profile});
      candidates.back().profile.viewport = viewport;
      candidates.back().profile.attributes = setup;
      candidates.back().profile.interpolation = interpolation;
    };
    add("exact barycentric", AttributeSetup::exact_barycentric, Contraction::unfused);
    add("planes from the origin", AttributeSetup::planes_from_origin, Contraction::unfused);
    add("fused planes from the origin", AttributeSetup::planes_from_origin, Contraction::fused);
  }
  return candidates;
}

std::vector<ProfileCandidate> clipping_candidates(const Profile& profile) {
  std::vector<ProfileCandidate> candidates;
  for (const Clipping clipping : {Clipping::standard, Clipping::mesa}) {
    for (const float guard_band : {1.0f, 2.0f, 4.0f, 8.0f, 16.0f}) {
      candidates.push_back({std::string(clipping == Clipping::standard ? "plain" : "as Mesa") +
                                ", guard band " + std::to_string(static_cast<int>(guard_band)),
                            profile});
      candidates.back().profile.clipping = clipping;
      candidates.back().profile.guard_band = guard_band;
    }
  }
  return candidates;
}

// The driver's a * b + c at every texel.
Image multiply_add_on_gl(ProbedDriver& driver, const std::array<Image, 3>& operands, bool precise) {
  const GlProgram program = link_program(driver.gl, driver.shaders, "fullscreen.vert",
                                         "arithmetic.frag", precise ? "#define PRECISE\n" : "");
  static constexpr std::array<const char*, 3> kNames{"first", "second", "third"};
  std::array<GlTexture, 3> textures;
  for (std::size_t i = 0; i < 3; ++i) {
    textures[i] = upload(operands[i]);
    set_texture(program, kNames[i], static_cast<int>(i), textures[i]);
  }
  const GlTarget target =
      make_target(std::array{Format::rgba32f}, operands[0].width, operands[0].height, false);
  draw_fullscreen(target, program);
  return read_colour(target, 0);
}

std::array<Image, 3> random_operands() {
  RandomNumbers random{11};
  std::array<Image, 3> operands;
  for (Image& image : operands) {
    image = make_image(Format::rgba32f, 64, 64);
    for (int y = 0; y < 64; ++y) {
      for (float& value : row<float>(image, y)) value = random.between(-8.0f, 8.0f);
    }
  }
  return operands;
}

ProbeFinding contraction_of_shaders(ProbedDriver& driver, bool precise) {
  const std::array<Image, 3> operands = random_operands();
  const Image result = multiply_add_on_gl(driver, operands, precise);
  int unlike_fused = 0, unlike_unfused = 0, values = 0;
  for (int y = 0; y < 64; ++y) {
    const auto a = row<float>(operands[0], y), b = row<float>(operands[1], y),
               c = row<float>(operands[2], y), sum = row<float>(result, y);
    for (std::size_t i = 0; i < a.size(); ++i, ++values) {
      unlike_fused += sum[i] != multiply_add(a[i], b[i], c[i], Contraction::fused) ? 1 : 0;
      unlike_unfused += sum[i] != multiply_add(a[i], b[i], c[i], Contraction::unfused) ? 1 : 0;
    }
  }
  const std::string of = " of " + std::to_string(values);
  return {std::string("a * b + c in a shader") + (precise ? ", precise" : ""),
          unlike_unfused == 0 ? "rounded twice"
          : unlike_fused == 0 ? "fused"
                              : "neither rounded twice nor fused throughout",
          "differing values: rounded twice " + std::to_string(unlike_unfused) + of + ", fused " +
              std::to_string(unlike_fused) + of};
}

Image constant(glm::vec4 value) {
  Image image = make_image(Format::rgba32f, 1, 1);
  store_texel(image, 0, 0, value, {});
  return image;
}

// 2^-100 * 2^-30, which is subnormal, and a subnormal operand times 2^30.
ProbeFinding denormals_of_shaders(ProbedDriver& driver, Profile& profile) {
  const Image result =
      multiply_add_on_gl(driver,
                         {constant({0x1p-100f, 0x1p-130f, 1.0f, 1.0f}),
                          constant({0x1p-30f, 0x1p30f, 1.0f, 1.0f}), constant(glm::vec4{0.0f})},
                         true);
  const glm::vec4 texel = load_texel(result, 0, 0);
  const bool flushed_result = texel.x == 0.0f;
  const bool flushed_operand = texel.y == 0.0f;
  profile.denormals = flushed_result || flushed_operand ? Denormals::flush : Denormals::keep;
  return {"binary32 subnormals in shaders",
          profile.denormals == Denormals::flush ? "flush" : "keep",
          std::string("2^-100 * 2^-30 is ") + (flushed_result ? "0" : "kept") +
              ", 2^-130 * 2^30 is " + (flushed_operand ? "0" : "kept")};
}

// Between the centres of a black and a white texel: the weight at 256 steps of 1/256, and
// how many different weights 16 times as many positions give.
ProbeFinding weight_table(ProbedDriver& driver) {
  constexpr int kSteps = 256;
  constexpr int kFine = 16;
  Image texels = make_image(Format::rgba16f, 2, 1);
  store_texel(texels, 1, 0, glm::vec4{1.0f}, {});
  Image places = make_image(Format::rgba32f, kSteps, kFine);
  for (int y = 0; y < kFine; ++y) {
    for (int x = 0; x < kSteps; ++x) {
      const float step = static_cast<float>(x * kFine + y) / static_cast<float>(kFine * kSteps);
      store_texel(places, x, y, {0.25f + step * 0.5f, 0.5f, 0.0f, 0.0f}, {});
    }
  }
  const Sampler sampler{Filter::bilinear, Wrap::clamp_to_edge, Wrap::clamp_to_edge};
  const GlTexture picture = upload(make_texture(texels), sampler);
  const GlTexture coordinates = upload(places);
  const GlProgram program =
      link_program(driver.gl, driver.shaders, "fullscreen.vert", "sample.frag");
  const GlTarget target = make_target(std::array{Format::rgba32f}, kSteps, kFine, false);
  set_texture(program, "picture", 0, picture);
  set_texture(program, "coordinates", 1, coordinates);
  draw_fullscreen(target, program);

  const Image result = read_colour(target, 0);
  std::set<float> different;
  std::string others;
  int exact = 0;
  for (int x = 0; x < kSteps; ++x) {
    const float weight = load_texel(result, x, 0).x * static_cast<float>(kSteps);
    if (weight == static_cast<float>(x)) {
      ++exact;
    } else {
      others += ' ' + std::to_string(x) + ':' + short_number(static_cast<double>(weight));
    }
    for (int y = 0; y < kFine; ++y) different.insert(load_texel(result, x, y).x);
  }
  return {"bilinear weights between two texels of a half texture",
          std::to_string(different.size()) + " different ones at 4096 positions",
          std::to_string(exact) + " of the 256 steps of 1/256 exact" +
              (others.empty() ? "" : ", the others in 256ths:" + others)};
}

// "NVIDIA H200/PCIe/SSE2" -> "nvidia-h200-pcie-sse2"
std::string profile_name(const std::string& renderer) {
  std::string name;
  for (const char c : renderer) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) != 0) {
      name += static_cast<char>(std::tolower(letter));
    } else if (!name.empty() && name.back() != '-') {
      name += '-';
    }
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name;
}

}  // namespace

// A browser's one driver is open already.
#ifndef SOFTFOCUS_WEBGL
Probe probe_driver(const Driver& driver) {
  const GlContext gl{driver};
  ThreadPool pool{hardware_threads()};
  const bool is_named = is_software(driver) || driver.is_emulated;
  return probe_context(gl, is_named ? std::string(driver.name) + "-probed" : "", pool);
}
#endif

Probe probe_context(const GlContext& gl, const std::string& name, ThreadPool& pool) {
  ProbedDriver driver{gl, {}, pool};
  Probe probe;
  probe.renderer = gl.renderer() + ", OpenGL " + gl.version();
  Profile& profile = probe.profile.profile;
  const auto ask = [&](const std::string& question, const std::vector<std::string>& cases,
                       const std::vector<ProfileCandidate>& candidates) {
    probe.findings.push_back(choose(driver, question, cases, candidates, profile));
  };
  using P = Profile;

  probe.findings.push_back(denormals_of_shaders(driver, profile));
  probe.findings.push_back(contraction_of_shaders(driver, false));
  probe.findings.push_back(contraction_of_shaders(driver, true));
  ask("floats stored as halves", {"store/rgba16f-around-every-half"},
      variants(profile, &P::half_store,
               {{HalfRounding::nearest_even, "nearest even"},
                {HalfRounding::toward_zero, "toward zero"},
                {HalfRounding::swiftshader, "as SwiftShader"}}));
  ask("floats stored as bytes", {"store/rgba8-around-every-byte", "store/rgba8-random"},
      variants(
          profile, &P::unorm_store,
          {{UnormRounding::half_up, "half up"}, {UnormRounding::nearest_even, "nearest even"}}));
  probe.findings.push_back(weight_table(driver));
  ask("texture filtering",
      {"bilinear-rgba16f/64x32-repeat", "bilinear-rgba16f/37x19-clamp",
       "bilinear-rgba8/64x32-repeat", "bilinear-rgba8/37x19-clamp"},
      texture_candidates(profile));

  // Positions are compared before clipping can matter, attributes before guard bands.
  profile.guard_band = 1.0f;
  ask("coverage", {"coverage/inside-20000", "coverage/centre-aligned-20000"},
      coverage_candidates(profile));
  // At an odd size a fused viewport transform differs from an unfused one.
  ask("attributes", {"attributes/inside-odd-size"}, attribute_candidates(profile));
  ask("clipping", {"coverage/across-edges-4000", "attributes/across-edges"},
      clipping_candidates(profile));

  probe.profile.name = name.empty() ? profile_name(gl.renderer()) : name;
  probe.profile.summary = probe.renderer;
  return probe;
}

}  // namespace softfocus
