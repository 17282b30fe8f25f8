#pragma once
// A compiled shader on its way from the page's compiler to its module: two WebAssembly modules.

#include "scenes/load/shader_file.h"
#include "tools/files/json.h"

namespace softfocus {

/// `words`, `convention`, `text`, `warnings`, and `parameters` with `name` and `value`.
Json compiled_json(const CompiledGlsl& compiled);

/// The way back. Throws JsonError for what is no such thing.
OpenedShader compiled_shader(const Json& json);

}  // namespace softfocus
