# Makes the C++ file that shaders.h declares, each `#include` of GLSL replaced by the file:
#   cmake -D OUTPUT=FILE -D SHADERS=FILE;... -P shader_text.cmake
set(entries "")
foreach(path IN LISTS SHADERS)
  get_filename_component(name ${path} NAME)
  file(READ ${path} text)
  foreach(included IN LISTS SHADERS)
    get_filename_component(include_name ${included} NAME)
    file(READ ${included} included_text)
    string(REPLACE "#include \"${include_name}\"\n" "${included_text}" text "${text}")
  endforeach()
  string(APPEND entries "  if (name == \"${name}\") {\n    return R\"glsl(${text})glsl\";\n  }\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"dof/shaders.h\"

std::string_view softfocus::shader_text(std::string_view name) {
${entries}  return {};
}
")
