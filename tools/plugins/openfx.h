#pragma once
// The part of OpenFX's binary interface (1.4) that our plug-in uses, after its specification
// (openfx.readthedocs.io): layouts of structs, and names. Debian has no package of its headers.

namespace softfocus::openfx {

using Status = int;
inline constexpr Status kOk = 0, kFailed = 1, kUnknown = 3, kMissingHostFeature = 4, kNoMemory = 8,
                        kBadIndex = 10, kReplyDefault = 14;

// The host's, never looked into.
struct PropertySet;
struct Effect;
struct Clip;
struct ParameterSet;
struct ParameterHandle;

struct Rectangle {
  double x1, y1, x2, y2;
};

struct Host {
  PropertySet* properties;
  const void* (*fetch_suite)(PropertySet* host, const char* name, int version);
};

struct Plugin {
  const char* api;
  int api_version;
  const char* identifier;
  unsigned version_major, version_minor;
  void (*set_host)(Host* host);
  Status (*main_entry)(const char* action, const void* handle, PropertySet* in, PropertySet* out);
};

/// "OfxPropertySuite", version 1.
struct PropertySuite {
  Status (*set_pointer)(PropertySet* set, const char* name, int index, void* value);
  Status (*set_string)(PropertySet* set, const char* name, int index, const char* value);
  Status (*set_double)(PropertySet* set, const char* name, int index, double value);
  Status (*set_int)(PropertySet* set, const char* name, int index, int value);
  Status (*set_pointers)(PropertySet* set, const char* name, int count, void* const* values);
  Status (*set_strings)(PropertySet* set, const char* name, int count, const char* const* values);
  Status (*set_doubles)(PropertySet* set, const char* name, int count, const double* values);
  Status (*set_ints)(PropertySet* set, const char* name, int count, const int* values);
  Status (*get_pointer)(PropertySet* set, const char* name, int index, void** value);
  Status (*get_string)(PropertySet* set, const char* name, int index, char** value);
  Status (*get_double)(PropertySet* set, const char* name, int index, double* value);
  Status (*get_int)(PropertySet* set, const char* name, int index, int* value);
  Status (*get_pointers)(PropertySet* set, const char* name, int count, void** values);
  Status (*get_strings)(PropertySet* set, const char* name, int count, char** values);
  Status (*get_doubles)(PropertySet* set, const char* name, int count, double* values);
  Status (*get_ints)(PropertySet* set, const char* name, int count, int* values);
  Status (*reset)(PropertySet* set, const char* name);
  Status (*get_dimension)(PropertySet* set, const char* name, int* count);
};

/// "OfxImageEffectSuite", version 1, but for its last functions, on memory.
struct EffectSuite {
  Status (*get_properties)(Effect* effect, PropertySet** set);
  Status (*get_parameters)(Effect* effect, ParameterSet** set);
  Status (*define_clip)(Effect* effect, const char* name, PropertySet** set);
  Status (*get_clip)(Effect* effect, const char* name, Clip** clip, PropertySet** set);
  Status (*get_clip_properties)(Clip* clip, PropertySet** set);
  Status (*get_image)(Clip* clip, double time, const Rectangle* region, PropertySet** image);
  Status (*release_image)(PropertySet* image);
  Status (*get_clip_region)(Clip* clip, double time, Rectangle* region);
  int (*abort)(Effect* effect);
};

/// "OfxParameterSuite", version 1, but for its last functions, on derivatives and keys.
struct ParameterSuite {
  Status (*define)(ParameterSet* set, const char* type, const char* name, PropertySet** properties);
  Status (*get)(ParameterSet* set, const char* name, ParameterHandle** parameter,
                PropertySet** properties);
  Status (*get_set_properties)(ParameterSet* set, PropertySet** properties);
  Status (*get_properties)(ParameterHandle* parameter, PropertySet** properties);
  Status (*get_value)(ParameterHandle* parameter, ...);
  Status (*get_value_at)(ParameterHandle* parameter, double time, ...);
};

/// "OfxMessageSuite", version 1.
struct MessageSuite {
  Status (*message)(void* handle, const char* type, const char* id, const char* format, ...);
};

}  // namespace softfocus::openfx
