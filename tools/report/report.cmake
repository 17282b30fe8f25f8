# Makes a C++ file that holds a page as one literal, with its style sheet and script:
#   cmake -D OUTPUT=FILE -D FILES=FOLDER/report -D NAME=kReportTemplate -P report.cmake
cmake_minimum_required(VERSION 3.22)  # so that ${} in a script is text
foreach(ending html css js)
  file(READ ${FILES}.${ending} ${ending})
endforeach()
get_filename_component(stem ${FILES} NAME)
string(REPLACE "<link rel=\"stylesheet\" href=\"${stem}.css\">" "<style>\n${css}</style>" html "${html}")
string(REPLACE "<script src=\"${stem}.js\"></script>" "<script>\n${js}</script>" html "${html}")
file(WRITE ${OUTPUT} "#include <string_view>

namespace softfocus {
extern const std::string_view ${NAME};
const std::string_view ${NAME} = R\"page(${html})page\";
}  // namespace softfocus
")
