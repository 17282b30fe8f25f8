#include "tools/files/profile_file.h"

#include <array>
#include <span>
#include <sstream>
#include <string_view>

#include "scenes/files/file_bytes.h"
#include "scenes/files/scene_error.h"
#include "scenes/load/toml_reading.h"

namespace softfocus {
namespace {

using Words = std::span<const std::string_view>;

// A key whose value is one of some words, in the order of its enumerators.
template <class Choice>
struct ChoiceKey {
  std::string_view key;
  Choice Profile::*member;
  Words words;
  std::string_view meaning;
};

constexpr std::array<std::string_view, 3> kHalfWords{"nearest-even", "toward-zero", "swiftshader"};
constexpr std::array<std::string_view, 2> kUnormWords{"half-up", "nearest-even"};
constexpr std::array<std::string_view, 2> kDenormalWords{"keep", "flush"};
constexpr std::array<std::string_view, 4> kTextureWords{"plain", "llvmpipe", "softpipe",
                                                        "swiftshader"};
constexpr std::array<std::string_view, 2> kWeightWords{"binary32", "fixed-8"};
constexpr std::array<std::string_view, 2> kFilterWords{"floats", "integers"};
constexpr std::array<std::string_view, 2> kFusedWords{"unfused", "fused"};
constexpr std::array<std::string_view, 2> kClippingWords{"plain", "mesa"};
constexpr std::array<std::string_view, 2> kCoverageWords{"edge-functions", "scanlines"};
constexpr std::array<std::string_view, 2> kFillWords{"upper-left", "lower-left"};
constexpr std::array<std::string_view, 3> kAttributeWords{"exact-barycentric", "planes-from-origin",
                                                          "planes-by-quad"};

// Calls visit(key) for each ChoiceKey, in the file's order.
template <class Visit>
void for_each_choice(const Visit& visit) {
  using P = Profile;
  visit(ChoiceKey<HalfRounding>{"half_store", &P::half_store, kHalfWords,
                                "how a float is stored as a half"});
  visit(ChoiceKey<UnormRounding>{"unorm_store", &P::unorm_store, kUnormWords,
                                 "how a float is stored as a byte"});
  visit(ChoiceKey<Denormals>{"denormals", &P::denormals, kDenormalWords,
                             "binary32 subnormals in shaders"});
  visit(ChoiceKey<TextureUnit>{"texture_unit", &P::texture_unit, kTextureWords,
                               "the arithmetic of texture addresses and filters"});
  visit(ChoiceKey<BilinearWeights>{"bilinear_weights", &P::bilinear_weights, kWeightWords,
                                   "precision of filter weights, in a plain texture unit"});
  visit(ChoiceKey<BilinearFilter>{"bilinear_filter", &P::bilinear_filter, kFilterWords,
                                  "of bytes and halves, in a plain texture unit"});
  visit(ChoiceKey<Contraction>{"lerp", &P::lerp, kFusedWords, "a + t (b - a) in filters"});
  visit(ChoiceKey<Contraction>{"viewport", &P::viewport, kFusedWords, "ndc * scale + translate"});
  visit(ChoiceKey<Clipping>{"clipping", &P::clipping, kClippingWords,
                            "what happens across the clip planes"});
  visit(ChoiceKey<Coverage>{"coverage", &P::coverage, kCoverageWords,
                            "which pixels a triangle covers"});
  visit(ChoiceKey<FillRule>{"fill_rule", &P::fill_rule, kFillWords,
                            "which edges own the pixel centres on them, row 0 on top"});
  visit(ChoiceKey<AttributeSetup>{"attributes", &P::attributes, kAttributeWords,
                                  "how attributes run over a triangle"});
  visit(ChoiceKey<Contraction>{"interpolation", &P::interpolation, kFusedWords,
                               "the products of planes-from-origin"});
}

std::string joined(Words words) {
  std::string list;
  for (const std::string_view word : words) {
    list += (list.empty() ? "" : " | ") + std::string(word);
  }
  return list;
}

// A TOML basic string: probed names may hold anything.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char letter : printable(text)) {
    if (letter == '"' || letter == '\\') result += '\\';
    result += letter;
  }
  return result + '"';
}

}  // namespace

std::string profile_text(const ChosenProfile& chosen, const std::string& heading) {
  const Profile& profile = chosen.profile;
  std::ostringstream text;
  std::istringstream lines{heading};
  for (std::string line; std::getline(lines, line);) text << "# " << printable(line) << '\n';
  text << "name = " << quoted(chosen.name) << "\nsummary = " << quoted(chosen.summary) << "\n\n";
  for_each_choice([&](const auto& choice) {
    const auto value = static_cast<std::size_t>(profile.*choice.member);
    std::string line{choice.key};
    line += " = ";
    line += quoted(std::string(choice.words[value]));
    line.resize(std::max<std::size_t>(line.size(), 40), ' ');
    text << line << "  # " << choice.meaning << ": " << joined(choice.words) << '\n';
  });
  text << "subpixel_bits = " << profile.subpixel_bits
       << "                         # of positions, with edge-functions: 4 to 8\n"
       << "guard_band = " << profile.guard_band
       << "                            # clip planes stand at |x| = guard_band w: 1 to 16\n";
  return text.str();
}

ChosenProfile load_profile(const std::filesystem::path& file) {
  constexpr std::size_t kMaxFileBytes = 65536;
  const std::string text = read_file_bytes(file, kMaxFileBytes);
  const toml::table table = parse_toml(text, file.string(), "docs/specification.md");
  Section section{&table, file.string(), "", {}};

  ChosenProfile chosen;
  chosen.name = read_text(section, "name", "");
  if (chosen.name.empty())
    fail_at(section, "name", "is missing; a name for the profile would be right");
  chosen.summary = read_text(section, "summary", "");
  Profile& profile = chosen.profile;
  for_each_choice([&](const auto& choice) {
    using Choice = std::remove_reference_t<decltype(profile.*choice.member)>;
    const auto fallback = static_cast<std::size_t>(profile.*choice.member);
    profile.*choice.member =
        static_cast<Choice>(read_choice(section, choice.key, fallback, choice.words));
  });
  profile.subpixel_bits = read_whole_number(section, "subpixel_bits", profile.subpixel_bits, 4, 8);
  profile.guard_band = static_cast<float>(
      read_number(section, "guard_band", static_cast<double>(profile.guard_band), {1.0, 16.0}));
  finish_section(section);
  if ((profile.coverage == Coverage::scanlines) !=
      (profile.attributes == AttributeSetup::planes_by_quad)) {
    fail_at(section, "coverage",
            "and attributes do not fit together; scanlines with planes-by-quad, or "
            "edge-functions with another, would be right");
  }
  return chosen;
}

}  // namespace softfocus
