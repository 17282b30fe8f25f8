// The plug-in for OpenFX against the program, in a host that is no more than the plug-in asks for.

#include <doctest/doctest.h>

#include "tests/support/run_program.h"
#include "tests/support/skip.h"
#include "tools/pictures/picture_file.h"
#include "tools/plugins/openfx.h"

using namespace softfocus;

#ifdef SOFTFOCUS_OPENFX_PLUGIN
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <map>
#include <string>
#include <variant>
#include <vector>

// The host's side of the handles.
namespace softfocus::openfx {
struct PropertySet {
  using Value = std::variant<int, double, void*, std::string>;
  std::map<std::string, std::vector<Value>> values;

  template <class T>
  Status set(const char* name, int index, T value) {
    std::vector<Value>& all = values[name];
    all.resize(std::max(all.size(), static_cast<std::size_t>(index) + 1));
    all[static_cast<std::size_t>(index)] = value;
    return kOk;
  }
  template <class T>
  T* find(const char* name, int index = 0) {
    const auto found = values.find(name);
    if (found == values.end() || static_cast<std::size_t>(index) >= found->second.size()) {
      return nullptr;
    }
    return std::get_if<T>(&found->second[static_cast<std::size_t>(index)]);
  }
  template <class T>
  Status get(const char* name, int count, T* to) {
    for (int i = 0; i < count; ++i) {
      const T* const value = find<T>(name, i);
      if (value == nullptr) return kUnknown;
      to[i] = *value;
    }
    return kOk;
  }
};
struct ParameterHandle {
  std::string type;
  PropertySet properties;
};
struct ParameterSet {
  std::map<std::string, ParameterHandle> all;
};
struct Clip {
  PropertySet properties, image;
  Rectangle region{};
};
struct Effect {
  PropertySet properties;
  ParameterSet parameters;
  std::map<std::string, Clip> clips;
  int images_out = 0;
};
}  // namespace softfocus::openfx

using namespace softfocus::openfx;

namespace {

Effect* current = nullptr;  // whose images are counted
std::string said;

template <class T>
Status get_one(PropertySet* set, const char* name, int index, T* value) {
  const T* const found = set->find<T>(name, index);
  if (found == nullptr) return kUnknown;
  *value = *found;
  return kOk;
}

const PropertySuite kProperties{
    .set_pointer = [](auto* set, auto* name, int i,
                      void* value) { return set->set(name, i, value); },
    .set_string = [](auto* set, auto* name, int i,
                     const char* value) { return set->set(name, i, std::string{value}); },
    .set_double = [](auto* set, auto* name, int i,
                     double value) { return set->set(name, i, value); },
    .set_int = [](auto* set, auto* name, int i, int value) { return set->set(name, i, value); },
    .set_pointers = nullptr,
    .set_strings = nullptr,
    .set_doubles =
        [](auto* set, auto* name, int count, const double* values) {
          for (int i = 0; i < count; ++i) set->set(name, i, values[i]);
          return kOk;
        },
    .set_ints = nullptr,
    .get_pointer = get_one<void*>,
    .get_string =
        [](auto* set, auto* name, int i, char** value) {
          std::string* const found = set->template find<std::string>(name, i);
          if (found == nullptr) return kUnknown;
          *value = found->data();
          return kOk;
        },
    .get_double = get_one<double>,
    .get_int = get_one<int>,
    .get_pointers = nullptr,
    .get_strings = nullptr,
    .get_doubles = [](auto* set, auto* name, int count,
                      double* values) { return set->get(name, count, values); },
    .get_ints = [](auto* set, auto* name, int count,
                   int* values) { return set->get(name, count, values); },
    .reset = nullptr,
    .get_dimension = nullptr};

const EffectSuite kEffects{
    .get_properties =
        [](Effect* effect, PropertySet** set) {
          *set = &effect->properties;
          return kOk;
        },
    .get_parameters =
        [](Effect* effect, ParameterSet** set) {
          *set = &effect->parameters;
          return kOk;
        },
    .define_clip =
        [](Effect* effect, const char* name, PropertySet** set) {
          *set = &effect->clips[name].properties;
          return kOk;
        },
    .get_clip =
        [](Effect* effect, const char* name, Clip** clip, PropertySet** set) {
          *clip = &effect->clips.at(name);
          if (set != nullptr) *set = &(*clip)->properties;
          return kOk;
        },
    .get_clip_properties =
        [](Clip* clip, PropertySet** set) {
          *set = &clip->properties;
          return kOk;
        },
    .get_image =
        [](Clip* clip, double, const Rectangle*, PropertySet** image) {
          if (clip->image.values.empty()) return kFailed;
          ++current->images_out;
          *image = &clip->image;
          return kOk;
        },
    .release_image =
        [](PropertySet*) {
          --current->images_out;
          return kOk;
        },
    .get_clip_region =
        [](Clip* clip, double, Rectangle* region) {
          *region = clip->region;
          return kOk;
        },
    .abort = nullptr};

Status value_at(ParameterHandle* parameter, double time, ...) {
  va_list to;
  va_start(to, time);
  if (parameter->type == "OfxParamTypeDouble") {
    parameter->properties.get("OfxParamPropDefault", 1, va_arg(to, double*));
  } else {
    parameter->properties.get("OfxParamPropDefault", 1, va_arg(to, int*));
  }
  va_end(to);
  return kOk;
}

const ParameterSuite kParameters{
    .define =
        [](ParameterSet* set, const char* type, const char* name, PropertySet** properties) {
          set->all[name].type = type;
          *properties = &set->all[name].properties;
          return kOk;
        },
    .get =
        [](ParameterSet* set, const char* name, ParameterHandle** parameter, PropertySet**) {
          *parameter = &set->all.at(name);
          return kOk;
        },
    .get_set_properties = nullptr,
    .get_properties = nullptr,
    .get_value = nullptr,
    .get_value_at = value_at};

Status message(void*, const char*, const char*, const char* format, ...) {
  va_list words;
  va_start(words, format);
  said = va_arg(words, const char*);
  va_end(words);
  return kOk;
}
const MessageSuite kMessages{message};

const void* fetch_suite(PropertySet*, const char* name, int version) {
  const std::string wanted = name;
  if (version != 1) return nullptr;
  if (wanted == "OfxPropertySuite") return &kProperties;
  if (wanted == "OfxImageEffectSuite") return &kEffects;
  if (wanted == "OfxParameterSuite") return &kParameters;
  return wanted == "OfxMessageSuite" ? &kMessages : nullptr;
}

constexpr int kWidth = 40, kHeight = 30;

/// The plug-in with an instance, a picture and its depth. Images lie at (7, 5), as of a cropped
/// clip.
class OpenFx {
 public:
  OpenFx() : library_(::dlopen(SOFTFOCUS_OPENFX_PLUGIN, RTLD_NOW | RTLD_LOCAL)) {
    REQUIRE(library_ != nullptr);
    REQUIRE(reinterpret_cast<int (*)()>(::dlsym(library_, "OfxGetNumberOfPlugins"))() == 1);
    plugin_ = reinterpret_cast<Plugin* (*)(int)>(::dlsym(library_, "OfxGetPlugin"))(0);
    REQUIRE(std::string{plugin_->api} == "OfxImageEffectPluginAPI");
    plugin_->set_host(&host_);
    CHECK(act("OfxActionLoad") == kOk);
    CHECK(act("OfxActionDescribe") == kOk);
    CHECK(*effect_.properties.find<std::string>("OfxImageEffectPropSupportedPixelDepths") ==
          "OfxBitDepthFloat");
    CHECK(act("OfxImageEffectActionDescribeInContext") == kOk);
    std::uint32_t state = 1;
    for (float& value : colour_) {
      value = static_cast<float>((state = state * 1664525 + 1013904223) >> 8) / 16777216.0f;
    }
    for (std::size_t i = 3; i < colour_.size(); i += 4) colour_[i] = 1.0f;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        depth_[static_cast<std::size_t>(y * kWidth + x)] =
            x < y ? 1.5f : 2.0f + 0.1f * static_cast<float>(y);
      }
    }
    connect("Source", colour_.data(), 4);
    connect("Depth", depth_.data(), 1);
    connect("Output", result_.data(), 4);
    choose("depth_encoding", "metres");
  }
  ~OpenFx() { ::dlclose(library_); }
  OpenFx(const OpenFx&) = delete;
  OpenFx& operator=(const OpenFx&) = delete;

  Status act(const char* action) {
    current = &effect_;
    out = {};
    return plugin_->main_entry(action, &effect_, &in_, &out);
  }

  void set(const char* name, double value) {
    effect_.parameters.all.at(name).properties.set("OfxParamPropDefault", 0, value);
  }
  void choose(const char* name, const std::string& word) {
    PropertySet& choice = effect_.parameters.all.at(name).properties;
    int index = 0;
    while (*choice.find<std::string>("OfxParamPropChoiceOption", index) != word) ++index;
    choice.set("OfxParamPropDefault", 0, index);
  }
  void connect(const char* name, float* first, int channels) {
    Clip& clip = effect_.clips.at(name);
    clip.properties.set("OfxImageClipPropConnected", 0, first != nullptr ? 1 : 0);
    clip.image = {};
    if (first == nullptr) return;
    clip.region = {7.0, 5.0, 7.0 + kWidth, 5.0 + kHeight};
    clip.image.set("OfxImagePropData", 0, static_cast<void*>(first));
    const std::array<int, 4> bounds{7, 5, 7 + kWidth, 5 + kHeight};
    for (int i = 0; i < 4; ++i) {
      clip.image.set("OfxImagePropBounds", i, bounds[static_cast<std::size_t>(i)]);
    }
    clip.image.set("OfxImagePropRowBytes", 0, static_cast<int>(sizeof(float)) * channels * kWidth);
    clip.image.set("OfxImageEffectPropComponents", 0,
                   std::string{channels == 1 ? "OfxImageComponentAlpha" : "OfxImageComponentRGBA"});
  }

  Status render(int x1 = 7, int y1 = 5, int x2 = 7 + kWidth, int y2 = 5 + kHeight) {
    const std::array<int, 4> window{x1, y1, x2, y2};
    for (int i = 0; i < 4; ++i) {
      in_.set("OfxImageEffectPropRenderWindow", i, window[static_cast<std::size_t>(i)]);
    }
    in_.set("OfxPropTime", 0, 1.0);
    const Status status = act("OfxImageEffectActionRender");
    CHECK(effect_.images_out == 0);
    return status;
  }

  /// Red, green and blue from the top row down.
  std::vector<float> result() const { return colours_of(result_); }
  std::vector<float> sharp() const { return colours_of(colour_); }
  void forget_result() { std::fill(result_.begin(), result_.end(), -1.0f); }

  std::vector<float> by_program(const std::vector<std::string>& options) const {
    const TemporaryDirectory folder;
    write_pfm(folder.file("c.pfm"), "PF", sharp_rows());
    write_pfm(folder.file("d.pfm"), "Pf", depth_);
    std::vector<std::string> words{"refocus",
                                   "-q",
                                   folder.file("c.pfm"),
                                   folder.file("d.pfm"),
                                   "-o",
                                   folder.file("o.npy"),
                                   "--depth-encoding",
                                   "metres"};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramRun run = run_program(words);
    CHECK(run.err == "");
    const PictureFile file = open_picture_file(folder.file("o.npy"));
    constexpr std::array<std::size_t, 3> kColours{0, 1, 2};
    const std::vector<PlaneValues> planes = read_planes(file, kColours, 0.0f);
    std::vector<float> colours;
    for (std::size_t i = 0; i < planes[0].size(); ++i) {
      for (const PlaneValues& plane : planes) colours.push_back(plane[i]);
    }
    return colours;
  }

  PropertySet out;

 private:
  using Rgba = std::vector<float>;

  static std::vector<float> colours_of(const Rgba& rgba) {
    std::vector<float> colours;
    for (int y = kHeight - 1; y >= 0; --y) {
      for (int x = 0; x < kWidth; ++x) {
        const auto pixel = rgba.begin() + 4 * (y * kWidth + x);
        colours.insert(colours.end(), pixel, pixel + 3);
      }
    }
    return colours;
  }
  /// From the bottom row up, as PFM has them too.
  std::vector<float> sharp_rows() const {
    std::vector<float> rows;
    for (std::size_t i = 0; i < colour_.size(); ++i) {
      if (i % 4 != 3) rows.push_back(colour_[i]);
    }
    return rows;
  }
  static void write_pfm(const std::string& name, const std::string& kind,
                        const std::vector<float>& values) {
    std::string bytes =
        kind + '\n' + std::to_string(kWidth) + ' ' + std::to_string(kHeight) + "\n-1.0\n";
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    write_file(name, bytes);
  }

  void* library_;
  Plugin* plugin_ = nullptr;
  PropertySet host_properties_, in_;
  Host host_{&host_properties_, fetch_suite};
  Effect effect_;
  Rgba colour_ = Rgba(4 * kWidth * kHeight), result_ = Rgba(4 * kWidth * kHeight, -1.0f);
  std::vector<float> depth_ = std::vector<float>(kWidth * kHeight);
};

}  // namespace
#endif

TEST_CASE("OpenFX: the plug-in gives what the program writes, to the bit, and in tiles") {
#ifdef SOFTFOCUS_OPENFX_PLUGIN
  OpenFx host;
  CHECK(host.render() == kOk);
  CHECK(host.result() == host.by_program({}));
  host.set("focus", 2.5);
  host.set("blur_at_infinity", 9.0);
  for (const char* method : {"disc-layers", "scatter"}) {  // scatter makes no more rows
    CAPTURE(method);
    host.choose("method", method);
    CHECK(host.render() == kOk);
    const std::vector<float> whole =
        host.by_program({"--method", method, "--focus", "2.5", "--blur-at-infinity", "9"});
    CHECK(host.result() == whole);
    host.forget_result();
    for (int y = 5; y < 5 + kHeight; y += 10) {
      for (int x = 7; x < 7 + kWidth; x += 8) CHECK(host.render(x, y, x + 8, y + 10) == kOk);
    }
    CHECK(host.result() == whole);
  }
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("OpenFX: the plug-in needs the whole picture, and without a depth is the source") {
#ifdef SOFTFOCUS_OPENFX_PLUGIN
  OpenFx host;
  for (const char* property : {"OfxImageClipPropRoI_Source", "OfxImageClipPropRoI_Depth"}) {
    REQUIRE(host.act("OfxImageEffectActionGetRegionsOfInterest") == kOk);
    REQUIRE(host.out.find<double>(property, 3) != nullptr);
    CHECK(*host.out.find<double>(property, 0) == 7.0);
    CHECK(*host.out.find<double>(property, 3) == 5.0 + kHeight);
  }
  CHECK(host.act("OfxImageEffectActionGetRegionOfDefinition") == kOk);
  CHECK(*host.out.find<double>("OfxImageEffectPropRegionOfDefinition", 2) == 7.0 + kWidth);
  CHECK(host.act("OfxImageEffectActionIsIdentity") == kReplyDefault);
  CHECK(host.act("OfxActionCreateInstance") == kReplyDefault);
  host.connect("Depth", nullptr, 1);
  CHECK(host.act("OfxImageEffectActionIsIdentity") == kOk);
  CHECK(*host.out.find<std::string>("OfxPropName") == "Source");
  CHECK(host.render() == kOk);
  CHECK(host.result() == host.sharp());
  host.connect("Source", nullptr, 4);
  CHECK(host.render() == kOk);
  CHECK(host.result() == std::vector<float>(3 * kWidth * kHeight));
#else
  skip("", "a build without the shared library");
#endif
}

TEST_CASE("OpenFX: a setting that cannot be is a message, and the picture stays") {
#ifdef SOFTFOCUS_OPENFX_PLUGIN
  OpenFx host;
  host.set("near", 30.0);
  CHECK(host.render() == kFailed);
  CHECK(said == "near must be less than far");
  CHECK(host.result() == host.sharp());
  host.set("near", std::nan(""));
  CHECK(host.render() == kFailed);
  CHECK(said == "a setting is not a number");
#else
  skip("", "a build without the shared library");
#endif
}
