# Makes a C++ file that holds the page of reports as one literal, with its style sheet and script:
#   cmake -D OUTPUT=FILE -D FILES=FOLDER/report -P report.cmake
foreach(ending html css js)
  file(READ ${FILES}.${ending} ${ending})
endforeach()
string(REPLACE "<link rel=\"stylesheet\" href=\"report.css\">" "<style>\n${css}</style>" html "${html}")
string(REPLACE "<script src=\"report.js\"></script>" "<script>\n${js}</script>" html "${html}")
file(WRITE ${OUTPUT} "#include <string_view>

namespace softfocus {
extern const std::string_view kReportTemplate;
const std::string_view kReportTemplate = R\"page(${html})page\";
}  // namespace softfocus
")
