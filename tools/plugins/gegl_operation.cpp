// softfocus:refocus for GEGL and GIMP. Pads: `input` the colour, `aux` the depth, `output`.
//
// The result is made of the whole picture, and kept: circles of any size reach in from outside of a
// region, and the largest of the picture sets the filter. So a region has the bits of the whole.

#include <gegl-plugin.h>

#include <cctype>
#include <cmath>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "tools/plugins/plugin_refocus.h"

using namespace softfocus;

namespace {

/// An instance, which GObject allocates and frees.
struct Operation {
  GeglOperationComposer parent;
  PluginSettings* settings;
};

PluginSettings& settings_of(void* instance) { return *static_cast<Operation*>(instance)->settings; }

/// The class of GEGL's that ours is made of.
GeglOperationClass* parent_class(GeglOperation* operation) {
  return GEGL_OPERATION_CLASS(g_type_class_peek_parent(GEGL_OPERATION_GET_CLASS(operation)));
}

// Properties, in the order in which GIMP shows them.
constexpr guint kMethodId = 1, kEncodingId = 2, kFirstNumberId = 3, kHolesId = 101,
                kMendEdgesId = 102;

/// "F-number", "Focal length, mm".
std::string label_of(std::string_view name, std::string_view unit = {}) {
  std::string label{name};
  label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
  for (char& letter : label) letter = letter == '-' ? ' ' : letter;
  if (name == "f-number") label = "F-number";
  return unit.empty() ? label : label.append(", ").append(unit);
}

constexpr auto kFlags =
    static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_CONSTRUCT | GEGL_PARAM_PAD_INPUT);

void install_number(GObjectClass* object_class, guint id, const PluginNumber& number) {
  const Parameter& parameter = number.parameter;
  const std::string name{parameter.name}, label = label_of(parameter.name, parameter.unit),
                                          text{parameter.summary};
  const bool has_wide_range = number.shown_most > 10.0;
  GParamSpec* const spec =
      parameter.step == 1
          ? gegl_param_spec_int(
                name.c_str(), label.c_str(), text.c_str(), static_cast<int>(parameter.least),
                static_cast<int>(parameter.most), static_cast<int>(parameter.preset),
                static_cast<int>(parameter.least), static_cast<int>(number.shown_most), 1.0, kFlags)
          : gegl_param_spec_double(name.c_str(), label.c_str(), text.c_str(), parameter.least,
                                   parameter.most, parameter.preset, parameter.least,
                                   number.shown_most, has_wide_range ? 2.0 : 1.0, kFlags);
  if (name.starts_with("focus-")) {  // GIMP then offers to pick the point in the picture
    gegl_param_spec_set_property_key(spec, "unit", "relative-coordinate");
    gegl_param_spec_set_property_key(spec, "axis", name == "focus-x" ? "x" : "y");
  }
  g_object_class_install_property(object_class, id, spec);
}

void install_choice(GObjectClass* object_class, guint id, const PluginChoice& choice) {
  // GObject keeps the words for as long as the process lives.
  auto* const values = new std::vector<GEnumValue>;
  for (const std::string_view word : choice.words) {
    const char* const text = g_intern_string(std::string{word}.c_str());
    values->push_back({static_cast<int>(values->size()), text, text});
  }
  values->push_back({0, nullptr, nullptr});
  const std::string name{choice.name}, text{choice.summary};
  const GType type = g_enum_register_static(("softfocus-" + name).c_str(), values->data());
  g_object_class_install_property(
      object_class, id,
      gegl_param_spec_enum(name.c_str(), label_of(name).c_str(), text.c_str(), type,
                           static_cast<int>(choice.preset), kFlags));
}

std::size_t* choice_at(PluginSettings& settings, guint id) {
  switch (id) {
    case kMethodId: return &settings.method;
    case kEncodingId: return &settings.encoding;
    case kHolesId: return &settings.holes;
    default: return nullptr;
  }
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  PluginSettings& settings = settings_of(object);
  if (std::size_t* const choice = choice_at(settings, id)) {
    *choice = static_cast<std::size_t>(g_value_get_enum(value));
  } else if (id == kMendEdgesId) {
    settings.mend_edges = g_value_get_boolean(value) != FALSE;
  } else {
    double& number = settings.numbers[id - kFirstNumberId];
    number = G_VALUE_HOLDS_INT(value) ? g_value_get_int(value) : g_value_get_double(value);
  }
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  PluginSettings& settings = settings_of(object);
  if (const std::size_t* const choice = choice_at(settings, id)) {
    g_value_set_enum(value, static_cast<int>(*choice));
  } else if (id == kMendEdgesId) {
    g_value_set_boolean(value, settings.mend_edges ? TRUE : FALSE);
  } else if (G_VALUE_HOLDS_INT(value)) {
    g_value_set_int(value, static_cast<int>(settings.numbers[id - kFirstNumberId]));
  } else {
    g_value_set_double(value, settings.numbers[id - kFirstNumberId]);
  }
}

GeglRectangle extent(GeglOperation* operation, const char* pad) {
  const GeglRectangle* const found = gegl_operation_source_get_bounding_box(operation, pad);
  return found != nullptr ? *found : GeglRectangle{0, 0, 0, 0};
}

/// Whether there is anything to refocus: nothing is in a plane without an end, or an empty one.
bool is_picture(const GeglRectangle& box) {
  return box.width > 0 && box.height > 0 && !gegl_rectangle_is_infinite_plane(&box);
}

/// Linear light, multiplied by alpha, as colours spread.
const Babl* colour_format(GeglOperation* operation) {
  return babl_format_with_space("RaGaBaA float",
                                gegl_operation_get_source_space(operation, "input"));
}

void prepare(GeglOperation* operation) {
  gegl_operation_set_format(operation, "input", colour_format(operation));
  gegl_operation_set_format(operation, "output", colour_format(operation));
}

GeglRectangle get_bounding_box(GeglOperation* operation) { return extent(operation, "input"); }

GeglRectangle get_required_for_output(GeglOperation* operation, const char* pad,
                                      const GeglRectangle* wanted) {
  const GeglRectangle picture = extent(operation, "input"), own = extent(operation, pad);
  if (!is_picture(picture)) return *wanted;
  return is_picture(own) ? own : picture;
}

GeglRectangle get_invalidated_by_change(GeglOperation* operation, const char*,
                                        const GeglRectangle* changed) {
  const GeglRectangle picture = extent(operation, "input");
  return is_picture(picture) ? picture : *changed;
}

GeglRectangle get_cached_region(GeglOperation* operation, const GeglRectangle* wanted) {
  const GeglRectangle picture = extent(operation, "input");
  return is_picture(picture) ? picture : *wanted;
}

NumberType number_type(const Babl* format) {
  const Babl* const type = format != nullptr ? babl_format_get_type(format, 0) : nullptr;
  if (type == babl_type("u8")) return NumberType::unsigned8;
  if (type == babl_type("u16")) return NumberType::unsigned16;
  if (type == babl_type("u32")) return NumberType::unsigned32;
  return NumberType::single;
}

/// The depth as its numbers are stored: neither along another curve nor, if whole, as parts of 1.
/// Beside it its border repeats. What is transparent is not known.
void read_codes(GeglBuffer* aux, const GeglRectangle& box, PluginFrame& frame) {
  const Babl* const format = gegl_buffer_get_format(aux);
  const BablModelFlag flags = babl_get_model_flags(format);
  const char* const as_stored = (flags & BABL_MODEL_FLAG_NONLINEAR) != 0    ? "R'G'B'A float"
                                : (flags & BABL_MODEL_FLAG_PERCEPTUAL) != 0 ? "R~G~B~A float"
                                                                            : "RGBA float";
  std::vector<float> pixels(4 * frame.codes.size());
  gegl_buffer_get(aux, &box, 1.0, babl_format_with_space(as_stored, babl_format_get_space(format)),
                  pixels.data(), GEGL_AUTO_ROWSTRIDE, GEGL_ABYSS_CLAMP);
  frame.type = number_type(format);
  const double scale = full_scale(frame.type);
  const bool has_alpha = babl_format_has_alpha(format) != 0;
  if (has_alpha) frame.is_known.resize(frame.codes.size());
  for (std::size_t i = 0; i < frame.codes.size(); ++i) {
    const float red = pixels[4 * i];
    frame.codes[i] = scale == 1.0 ? red : static_cast<float>(std::floor(red * scale + 0.5));
    if (has_alpha) frame.is_known[i] = pixels[4 * i + 3];
  }
}

/// Without a depth the picture passes as it is: so GIMP's dialogue begins.
gboolean process(GeglOperation* operation, GeglOperationContext* context, const char* output,
                 const GeglRectangle* wanted, int level) {
  GObject* const input = gegl_operation_context_get_object(context, "input");
  if (input != nullptr && (gegl_operation_context_get_object(context, "aux") == nullptr ||
                           !is_picture(extent(operation, "input")))) {
    gegl_operation_context_take_object(context, output, G_OBJECT(g_object_ref(input)));
    return TRUE;
  }
  return parent_class(operation)->process(operation, context, output, wanted, level);
}

gboolean process_both(GeglOperation* operation, GeglBuffer* input, GeglBuffer* aux,
                      GeglBuffer* output, const GeglRectangle* wanted, int) try {
  const GeglRectangle box = extent(operation, "input");
  if (input == nullptr || aux == nullptr || !is_picture(box)) return TRUE;
  const std::size_t pixels =
      static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
  std::vector<float> rgba(4 * pixels);
  const Babl* const format = colour_format(operation);
  gegl_buffer_get(input, &box, 1.0, format, rgba.data(), GEGL_AUTO_ROWSTRIDE, GEGL_ABYSS_NONE);
  PluginFrame frame{.width = box.width, .height = box.height, .rgba = rgba};
  frame.codes.resize(pixels);
  read_codes(aux, box, frame);
  const std::string error = refocus_in_plugin(settings_of(operation), std::move(frame));
  if (!error.empty()) g_warning("softfocus:refocus: %s", error.c_str());
  const std::size_t first =
      static_cast<std::size_t>(wanted->y - box.y) * static_cast<std::size_t>(box.width) +
      static_cast<std::size_t>(wanted->x - box.x);
  gegl_buffer_set(output, wanted, 0, format, rgba.data() + 4 * first,
                  static_cast<int>(4 * sizeof(float)) * box.width);
  return TRUE;
} catch (const std::exception&) {  // bad_alloc, or the length_error of a vector
  g_warning("softfocus:refocus: there is not enough memory");
  return FALSE;
}

void finalize(GObject* object) {
  delete &settings_of(object);
  auto* const parent = g_type_class_peek_parent(G_OBJECT_GET_CLASS(object));
  G_OBJECT_CLASS(parent)->finalize(object);
}

void init_class(gpointer own, gpointer) {
  auto* const object_class = G_OBJECT_CLASS(own);
  object_class->set_property = set_property;
  object_class->get_property = get_property;
  object_class->finalize = finalize;
  install_choice(object_class, kMethodId, plugin_methods());
  install_choice(object_class, kEncodingId, plugin_encodings());
  guint id = kFirstNumberId;
  for (const PluginNumber& number : plugin_numbers()) install_number(object_class, id++, number);
  install_choice(object_class, kHolesId, plugin_holes());
  const std::string mends{plugin_mend_edges()};
  g_object_class_install_property(
      object_class, kMendEdgesId,
      g_param_spec_boolean("mend-edges", "Mend edges", mends.c_str(), FALSE, kFlags));

  auto* const operation_class = GEGL_OPERATION_CLASS(own);
  operation_class->prepare = prepare;
  operation_class->process = process;
  operation_class->get_bounding_box = get_bounding_box;
  operation_class->get_required_for_output = get_required_for_output;
  operation_class->get_invalidated_by_change = get_invalidated_by_change;
  operation_class->get_cached_region = get_cached_region;
  operation_class->threaded = FALSE;  // it has its own threads
  auto* const composer_class = GEGL_OPERATION_COMPOSER_CLASS(own);
  composer_class->process = process_both;
  composer_class->aux_label = "Depth";
  composer_class->aux_description = "The depth of each pixel; depth-encoding says how";
  gegl_operation_class_set_keys(operation_class, "name", "softfocus:refocus", "title",
                                "Depth of Field", "categories", "blur", "description",
                                "Gives a picture with depth the depth of field of a lens", nullptr);
}

void init_instance(GTypeInstance* instance, gpointer) {
  reinterpret_cast<Operation*>(instance)->settings = new PluginSettings;
}

}  // namespace

extern "C" {

// GEGL's names.
// NOLINTNEXTLINE(readability-identifier-naming)
G_MODULE_EXPORT const GeglModuleInfo* gegl_module_query(GTypeModule*) {
  static constexpr GeglModuleInfo kInfo{GEGL_MODULE_ABI_VERSION};
  return &kInfo;
}

G_MODULE_EXPORT gboolean gegl_module_register(GTypeModule* module) {
  GTypeInfo info{};
  info.class_size = sizeof(GeglOperationComposerClass);
  info.class_init = init_class;
  info.instance_size = sizeof(Operation);
  info.instance_init = init_instance;
  gegl_module_register_type(module, GEGL_TYPE_OPERATION_COMPOSER, "softfocus-refocus", &info,
                            static_cast<GTypeFlags>(0));
  return TRUE;
}

}  // extern "C"
