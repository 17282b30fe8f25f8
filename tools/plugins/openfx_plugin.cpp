// Depth of field for OpenFX hosts: Natron, Resolve, Nuke, Fusion. Clips: Source the colour, Depth,
// Output. A host may ask for tiles: each is filtered from the whole picture, with the bits of the
// whole.

#include "tools/plugins/openfx.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/plugins/plugin_refocus.h"

using namespace softfocus;
using namespace softfocus::openfx;

namespace {

/// The host and its suites: a plug-in is given them once, for all that it makes.
struct Suites {
  const Host* host = nullptr;
  const PropertySuite* properties = nullptr;
  const EffectSuite* effects = nullptr;
  const ParameterSuite* parameters = nullptr;
  const MessageSuite* messages = nullptr;  ///< or null
} suites;

constexpr const char* kSource = "Source";
constexpr const char* kDepth = "Depth";
constexpr const char* kOutput = "Output";
constexpr const char* kMendEdges = "mend_edges";

struct Box {
  int x1 = 0, y1 = 0, x2 = 0, y2 = 0;
  int width() const { return x2 - x1; }
  int height() const { return y2 - y1; }
};

/// A frame of a clip; rows run from the bottom up. Given back at the end.
class Frame {
 public:
  Frame(Clip* clip, double time) {
    if (suites.effects->get_image(clip, time, nullptr, &image_) != kOk) {
      image_ = nullptr;
      return;
    }
    const PropertySuite& get = *suites.properties;
    void* data = nullptr;
    get.get_pointer(image_, "OfxImagePropData", 0, &data);
    get.get_ints(image_, "OfxImagePropBounds", 4, &box_.x1);
    get.get_int(image_, "OfxImagePropRowBytes", 0, &row_bytes_);
    first_ = static_cast<std::byte*>(data);
    channels_ = text("OfxImageEffectPropComponents") == "OfxImageComponentAlpha" ? 1 : 4;
    is_straight_ = text("OfxImageEffectPropPreMultiplication") == "OfxImageAlphaUnPremultiplied";
  }
  ~Frame() {
    if (image_ != nullptr) suites.effects->release_image(image_);
  }
  Frame(const Frame&) = delete;
  Frame& operator=(const Frame&) = delete;

  bool is_there() const { return first_ != nullptr && box_.width() > 0 && box_.height() > 0; }
  const Box& box() const { return box_; }
  bool is_straight() const { return is_straight_; }
  float* at(int x, int y) const {
    return reinterpret_cast<float*>(first_ + std::ptrdiff_t{y - box_.y1} * row_bytes_) +
           std::ptrdiff_t{x - box_.x1} * channels_;
  }

 private:
  std::string_view text(const char* name) const {
    char* found = nullptr;
    suites.properties->get_string(image_, name, 0, &found);
    return found != nullptr ? found : "";
  }

  PropertySet* image_ = nullptr;
  std::byte* first_ = nullptr;
  Box box_;
  int row_bytes_ = 0, channels_ = 4;
  bool is_straight_ = false;
};

/// OpenFX's names are those of variables.
std::string script_name(std::string_view name) {
  std::string script{name};
  std::replace(script.begin(), script.end(), '-', '_');
  return script;
}

// Every choice in the settings, and its place.
struct OfChoice {
  const PluginChoice& (*choice)();
  std::size_t PluginSettings::*place;
};
constexpr std::array kChoices{OfChoice{plugin_methods, &PluginSettings::method},
                              OfChoice{plugin_encodings, &PluginSettings::encoding},
                              OfChoice{plugin_holes, &PluginSettings::holes}};

void describe(Effect* effect) {
  PropertySet* own = nullptr;
  suites.effects->get_properties(effect, &own);
  const PropertySuite& set = *suites.properties;
  set.set_string(own, "OfxPropLabel", 0, "Depth of field (softfocus)");
  set.set_string(own, "OfxImageEffectPluginPropGrouping", 0, "Filter");
  set.set_string(own, "OfxImageEffectPropSupportedContexts", 0, "OfxImageEffectContextGeneral");
  set.set_string(own, "OfxImageEffectPropSupportedContexts", 1, "OfxImageEffectContextFilter");
  set.set_string(own, "OfxImageEffectPropSupportedPixelDepths", 0, "OfxBitDepthFloat");
  set.set_string(own, "OfxImageEffectPluginRenderThreadSafety", 0, "OfxImageEffectRenderFullySafe");
  set.set_int(own, "OfxImageEffectPluginPropHostFrameThreading", 0, 0);  // it has its own threads
  set.set_int(own, "OfxImageEffectPropSupportsTiles", 0, 1);
  set.set_int(own, "OfxImageEffectPropSupportsMultiResolution", 0, 1);
}

PropertySet* defined(ParameterSet* all, const char* type, std::string_view name,
                     std::string_view summary) {
  PropertySet* own = nullptr;
  suites.parameters->define(all, type, script_name(name).c_str(), &own);
  suites.properties->set_string(own, "OfxPropLabel", 0, std::string{name}.c_str());
  suites.properties->set_string(own, "OfxParamPropHint", 0, std::string{summary}.c_str());
  return own;
}

void define_number(ParameterSet* all, const PluginNumber& number) {
  const Parameter& parameter = number.parameter;
  const std::pair<const char*, double> values[] = {{"OfxParamPropDefault", parameter.preset},
                                                   {"OfxParamPropMin", parameter.least},
                                                   {"OfxParamPropMax", parameter.most},
                                                   {"OfxParamPropDisplayMin", parameter.least},
                                                   {"OfxParamPropDisplayMax", number.shown_most}};
  const bool is_whole = parameter.step == 1;
  std::string text{parameter.summary};
  if (!parameter.unit.empty()) text.append(" (").append(parameter.unit).append(")");
  PropertySet* const own =
      defined(all, is_whole ? "OfxParamTypeInteger" : "OfxParamTypeDouble", parameter.name, text);
  for (const auto& [property, value] : values) {
    is_whole ? suites.properties->set_int(own, property, 0, static_cast<int>(value))
             : suites.properties->set_double(own, property, 0, value);
  }
}

void define_choice(ParameterSet* all, const PluginChoice& choice) {
  PropertySet* const own = defined(all, "OfxParamTypeChoice", choice.name, choice.summary);
  int index = 0;
  for (const std::string_view word : choice.words) {
    suites.properties->set_string(own, "OfxParamPropChoiceOption", index++,
                                  std::string{word}.c_str());
  }
  suites.properties->set_int(own, "OfxParamPropDefault", 0, static_cast<int>(choice.preset));
}

void describe_in_context(Effect* effect) {
  const PropertySuite& set = *suites.properties;
  for (const char* name : {kSource, kDepth, kOutput}) {
    PropertySet* clip = nullptr;
    suites.effects->define_clip(effect, name, &clip);
    set.set_string(clip, "OfxImageEffectPropSupportedComponents", 0, "OfxImageComponentRGBA");
    if (name != kDepth) continue;
    set.set_string(clip, "OfxImageEffectPropSupportedComponents", 1, "OfxImageComponentAlpha");
    set.set_int(clip, "OfxImageClipPropOptional", 0, 1);
  }
  ParameterSet* all = nullptr;
  suites.effects->get_parameters(effect, &all);
  for (const OfChoice& of : kChoices) define_choice(all, of.choice());
  for (const PluginNumber& number : plugin_numbers()) define_number(all, number);
  set.set_int(defined(all, "OfxParamTypeBoolean", kMendEdges, plugin_mend_edges()),
              "OfxParamPropDefault", 0, 0);
}

/// An instance's values at a time. Lengths in pixels are given for the whole size; `scale` is the
/// part of it that is drawn.
PluginSettings settings_at(Effect* effect, double time, double scale) {
  ParameterSet* all = nullptr;
  suites.effects->get_parameters(effect, &all);
  const auto read = [&](std::string_view name, auto* value) {
    ParameterHandle* parameter = nullptr;
    if (suites.parameters->get(all, script_name(name).c_str(), &parameter, nullptr) == kOk) {
      suites.parameters->get_value_at(parameter, time, value);
    }
  };
  PluginSettings settings;
  for (const OfChoice& of : kChoices) {
    int index = static_cast<int>(settings.*of.place);
    read(of.choice().name, &index);
    const int last = static_cast<int>(of.choice().words.size()) - 1;
    settings.*of.place = static_cast<std::size_t>(std::clamp(index, 0, last));
  }
  std::size_t i = 0;
  for (const auto& [parameter, shown_most] : plugin_numbers()) {
    double& number = settings.numbers[i++];
    int whole = static_cast<int>(number);
    parameter.step == 1 ? read(parameter.name, &whole) : read(parameter.name, &number);
    if (parameter.step == 1) number = whole;
    number = std::clamp(number, parameter.least, parameter.most);
    if (parameter.unit == "px") number *= scale;
  }
  int mends = 0;
  read(kMendEdges, &mends);
  settings.mend_edges = mends != 0;
  return settings;
}

Clip* clip_of(Effect* effect, const char* name) {
  Clip* clip = nullptr;
  suites.effects->get_clip(effect, name, &clip, nullptr);
  return clip;
}

bool is_connected(Effect* effect, const char* name) {
  PropertySet* own = nullptr;
  int connected = 0;
  suites.effects->get_clip_properties(clip_of(effect, name), &own);
  suites.properties->get_int(own, "OfxImageClipPropConnected", 0, &connected);
  return connected != 0;
}

Rectangle region_of(Effect* effect, const char* name, double time) {
  Rectangle region{};
  suites.effects->get_clip_region(clip_of(effect, name), time, &region);
  return region;
}

/// A picture's colours, multiplied by alpha, and the depth; beside the depth its border repeats.
void read_frames(const Frame& source, const Frame& depth, std::vector<float>& rgba,
                 PluginFrame& frame) {
  const Box &box = source.box(), &known = depth.box();
  rgba.clear();
  for (int y = box.y2 - 1; y >= box.y1; --y) {
    for (int x = box.x1; x < box.x2; ++x) {
      const float* const pixel = source.at(x, y);
      const float by = source.is_straight() ? pixel[3] : 1.0f;
      rgba.insert(rgba.end(), {by * pixel[0], by * pixel[1], by * pixel[2], pixel[3]});
      frame.codes.push_back(
          *depth.at(std::clamp(x, known.x1, known.x2 - 1), std::clamp(y, known.y1, known.y2 - 1)));
    }
  }
  frame.width = box.width();
  frame.height = box.height();
  frame.rgba = rgba;
}

/// The pixels of a window, which lies in both.
void write(const std::vector<float>& rgba, const Box& box, const Box& window, const Frame& output) {
  for (int y = window.y1; y < window.y2; ++y) {
    const float* from =
        rgba.data() + 4 * (std::ptrdiff_t{box.y2 - 1 - y} * box.width() + (window.x1 - box.x1));
    for (int x = window.x1; x < window.x2; ++x, from += 4) {
      float* const to = output.at(x, y);
      const float by = output.is_straight() && from[3] > 0.0f ? 1.0f / from[3] : 1.0f;
      for (int c = 0; c < 3; ++c) to[c] = by * from[c];
      to[3] = from[3];
    }
  }
}

Box common(const Box& a, const Box& b) {
  return {std::max(a.x1, b.x1), std::max(a.y1, b.y1), std::min(a.x2, b.x2), std::min(a.y2, b.y2)};
}

Status render(Effect* effect, PropertySet* in) {
  const PropertySuite& get = *suites.properties;
  double time = 0.0, scale[2] = {1.0, 1.0};
  Box window;
  get.get_double(in, "OfxPropTime", 0, &time);
  get.get_doubles(in, "OfxImageEffectPropRenderScale", 2, scale);
  get.get_ints(in, "OfxImageEffectPropRenderWindow", 4, &window.x1);
  const Frame source{clip_of(effect, kSource), time}, output{clip_of(effect, kOutput), time};
  if (!output.is_there()) return kFailed;
  window = common(window, output.box());
  // Nothing is beside the source, and everywhere without one.
  for (int y = window.y1; y < window.y2; ++y) {
    if (window.width() > 0) std::fill_n(output.at(window.x1, y), 4 * window.width(), 0.0f);
  }
  if (!source.is_there()) return kOk;
  const Box& box = source.box();
  window = common(window, box);
  if (window.width() <= 0 || window.height() <= 0) return kOk;
  const Frame depth{clip_of(effect, kDepth), time};
  PluginFrame frame;
  std::vector<float> rgba;
  read_frames(source, depth.is_there() ? depth : source, rgba, frame);
  frame.kept = {window.x1 - box.x1, box.y2 - window.y2, window.width(), window.height()};
  const std::string error =
      depth.is_there() ? refocus_in_plugin(settings_at(effect, time, scale[1]), std::move(frame))
                       : std::string{};
  write(rgba, box, window, output);
  if (error.empty()) return kOk;
  if (suites.messages != nullptr) {
    suites.messages->message(effect, "OfxMessageError", "softfocus", "%s", error.c_str());
  }
  return kFailed;
}

Status load() {
  const auto fetch = [](const char* name) {
    return suites.host->fetch_suite(suites.host->properties, name, 1);
  };
  suites.properties = static_cast<const PropertySuite*>(fetch("OfxPropertySuite"));
  suites.effects = static_cast<const EffectSuite*>(fetch("OfxImageEffectSuite"));
  suites.parameters = static_cast<const ParameterSuite*>(fetch("OfxParameterSuite"));
  suites.messages = static_cast<const MessageSuite*>(fetch("OfxMessageSuite"));
  const bool has_all =
      suites.properties != nullptr && suites.effects != nullptr && suites.parameters != nullptr;
  return has_all ? kOk : kMissingHostFeature;
}

Status main_entry(const char* name, const void* handle, PropertySet* in, PropertySet* out) try {
  const std::string_view action{name};
  if (action == "OfxActionLoad") return load();
  auto* const effect = static_cast<Effect*>(const_cast<void*>(handle));
  double time = 0.0;
  if (in != nullptr) suites.properties->get_double(in, "OfxPropTime", 0, &time);
  if (action == "OfxActionDescribe") {
    describe(effect);
    return kOk;
  }
  if (action == "OfxImageEffectActionDescribeInContext") {
    describe_in_context(effect);
    return kOk;
  }
  if (action == "OfxImageEffectActionGetRegionOfDefinition") {
    const Rectangle region = region_of(effect, kSource, time);
    return suites.properties->set_doubles(out, "OfxImageEffectPropRegionOfDefinition", 4,
                                          &region.x1);
  }
  if (action == "OfxImageEffectActionGetRegionsOfInterest") {
    for (const char* clip : {kSource, kDepth}) {
      if (!is_connected(effect, clip)) continue;
      const Rectangle region = region_of(effect, clip, time);
      const std::string property = std::string{"OfxImageClipPropRoI_"} + clip;
      suites.properties->set_doubles(out, property.c_str(), 4, &region.x1);
    }
    return kOk;
  }
  if (action == "OfxImageEffectActionIsIdentity") {
    if (is_connected(effect, kDepth)) return kReplyDefault;
    suites.properties->set_string(out, "OfxPropName", 0, kSource);
    suites.properties->set_double(out, "OfxPropTime", 0, time);
    return kOk;
  }
  if (action == "OfxImageEffectActionRender") return render(effect, in);
  return kReplyDefault;
} catch (const std::bad_alloc&) {
  return kNoMemory;
} catch (const std::exception&) {
  return kFailed;
}

}  // namespace

extern "C" {

// OpenFX's names.
// NOLINTBEGIN(readability-identifier-naming)
__attribute__((visibility("default"))) int OfxGetNumberOfPlugins() { return 1; }

__attribute__((visibility("default"))) Plugin* OfxGetPlugin(int index) {
  static Plugin plugin{"OfxImageEffectPluginAPI",
                       1,
                       "softfocus.refocus",
                       SOFTFOCUS_VERSION_MAJOR,
                       SOFTFOCUS_VERSION_MINOR,
                       [](Host* host) { suites.host = host; },
                       main_entry};
  return index == 0 ? &plugin : nullptr;
}
// NOLINTEND(readability-identifier-naming)

}  // extern "C"
