// Apart from the readers of files, for plug-ins, which have none.

#include "tools/pictures/picture_file.h"

namespace softfocus {

std::string_view name_of(NumberType type) {
  switch (type) {
    case NumberType::unsigned8: return "8 bits";
    case NumberType::unsigned16: return "16 bits";
    case NumberType::unsigned32: return "32 bits";
    case NumberType::half: return "half";
    case NumberType::single: return "float";
    case NumberType::double_precision: return "double";
  }
  return "";
}

double full_scale(NumberType type) {
  switch (type) {
    case NumberType::unsigned8: return 255.0;
    case NumberType::unsigned16: return 65535.0;
    case NumberType::unsigned32: return 4294967295.0;
    default: return 1.0;
  }
}

}  // namespace softfocus
