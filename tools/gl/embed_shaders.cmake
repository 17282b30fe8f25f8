# Makes a C++ file that holds the GLSL files as string literals:
#   cmake -D OUTPUT=FILE -D SHADERS=FILE;... -P embed_shaders.cmake
set(entries "")
foreach(path IN LISTS SHADERS)
  get_filename_component(name ${path} NAME)
  file(READ ${path} source)
  string(APPEND entries "    {\"${name}\", R\"glsl(${source})glsl\"},\n")
endforeach()
file(WRITE ${OUTPUT}
"#include \"tools/gl/shaders.h\"

const std::vector<softfocus::Shader>& softfocus::built_in_shaders() {
  static const std::vector<Shader> kShaders{
${entries}  };
  return kShaders;
}
")
